//! File names in the order people number them: `2.jpg` before `10.jpg`.

use std::cmp::Ordering;

/// Compares runs of digits by their value and everything else byte by byte; equal names of different
/// zero padding fall back to plain order, so that the order is total.
pub(crate) fn natural_order(a: &str, b: &str) -> Ordering {
    let (mut left, mut right) = (a.as_bytes(), b.as_bytes());
    while let (Some(&x), Some(&y)) = (left.first(), right.first()) {
        let order = if x.is_ascii_digit() && y.is_ascii_digit() {
            number_order(take_number(&mut left), take_number(&mut right))
        } else {
            (left, right) = (&left[1..], &right[1..]);
            x.cmp(&y)
        };
        if order.is_ne() {
            return order;
        }
    }
    left.len().cmp(&right.len()).then_with(|| a.cmp(b))
}

/// Cuts the leading digits off; returns them without leading zeros.
fn take_number<'a>(text: &mut &'a [u8]) -> &'a [u8] {
    let end = text
        .iter()
        .position(|byte| !byte.is_ascii_digit())
        .unwrap_or(text.len());
    let (digits, rest) = text.split_at(end);
    *text = rest;
    let zeros = digits.iter().take_while(|&&digit| digit == b'0').count();
    &digits[zeros..]
}

/// A longer number without leading zeros is a greater one, whatever its size.
fn number_order(a: &[u8], b: &[u8]) -> Ordering {
    a.len().cmp(&b.len()).then_with(|| a.cmp(b))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_sort_by_value() {
        let sorted = [
            "0001.jpg",
            "2.jpg",
            "10.jpg",
            "99999999999999999999999.jpg",
            "a1b2.png",
            "a1b10.png",
            "a02.png",
            "b.png",
        ];
        let mut shuffled = sorted;
        shuffled.reverse();
        shuffled.sort_by(|a, b| natural_order(a, b));
        assert_eq!(shuffled, sorted);
    }

    #[test]
    fn names_that_differ_only_in_padding_are_not_equal() {
        assert_eq!(natural_order("01", "1"), Ordering::Less);
        assert_eq!(natural_order("7", "7"), Ordering::Equal);
    }
}
