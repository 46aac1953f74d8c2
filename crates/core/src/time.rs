//! Capture time: nanoseconds since the Unix epoch, exact to the last digit of its source.

use std::{fmt, str::FromStr, time::Duration};

const NANOS_PER_SEC: i64 = 1_000_000_000;
/// A nanosecond is the ninth decimal place of a second.
const NANO_DIGITS: usize = 9;

/// Nanoseconds since the Unix epoch, as stamped at capture.
///
/// Decimal stamps are parsed as text: `1557539956.439383` has no exact binary
/// fraction, and a stamp that went through `f64` would be off by up to 119 ns.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct Timestamp(i64);

impl Timestamp {
    /// A stamp from whole nanoseconds since the Unix epoch.
    #[must_use]
    pub const fn from_nanos(nanos: i64) -> Self {
        Self(nanos)
    }

    /// Whole nanoseconds since the Unix epoch.
    #[must_use]
    pub const fn as_nanos(self) -> i64 {
        self.0
    }

    /// Whole seconds, rounded towards the past, as `builtin_interfaces/Time.sec` wants them.
    #[must_use]
    pub const fn secs(self) -> i64 {
        self.0.div_euclid(NANOS_PER_SEC)
    }

    /// Nanoseconds past [`Timestamp::secs`], in `0..1_000_000_000`.
    #[must_use]
    pub const fn subsec_nanos(self) -> u32 {
        // A remainder of 1e9 always fits.
        self.0.rem_euclid(NANOS_PER_SEC) as u32
    }

    /// Time from `earlier` to `self`, zero when `earlier` is the later one.
    #[must_use]
    pub fn saturating_since(self, earlier: Self) -> Duration {
        Duration::from_nanos(u64::try_from(self.0.saturating_sub(earlier.0)).unwrap_or(0))
    }

    /// This stamp moved towards the future by `by`; saturates at the end of time.
    #[must_use]
    pub fn saturating_add(self, by: Duration) -> Self {
        Self(
            self.0
                .saturating_add(i64::try_from(by.as_nanos()).unwrap_or(i64::MAX)),
        )
    }
}

impl fmt::Display for Timestamp {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}.{:09}", self.secs(), self.subsec_nanos())
    }
}

/// A stamp that is not a plain decimal number of seconds that fits 64-bit nanoseconds.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error(
    "`{0}` is not a stamp: expected decimal seconds since the Unix epoch, like 1557539956.439383"
)]
pub struct ParseTimestampError(String);

impl FromStr for Timestamp {
    type Err = ParseTimestampError;

    /// Parses decimal seconds. Digits beyond the ninth decimal place are cut off.
    fn from_str(text: &str) -> Result<Self, Self::Err> {
        parse_decimal_secs(text.trim()).ok_or_else(|| ParseTimestampError(text.to_owned()))
    }
}

fn parse_decimal_secs(text: &str) -> Option<Timestamp> {
    let (whole, fraction) = text.split_once('.').unwrap_or((text, ""));
    let all_digits = |part: &str| part.bytes().all(|b| b.is_ascii_digit());
    if whole.is_empty() || !all_digits(whole) || !all_digits(fraction) {
        return None;
    }
    let secs: i64 = whole.parse().ok()?;
    let kept = &fraction[..fraction.len().min(NANO_DIGITS)];
    let nanos: i64 = format!("{kept:0<NANO_DIGITS$}").parse().ok()?;
    secs.checked_mul(NANOS_PER_SEC)?
        .checked_add(nanos)
        .map(Timestamp)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn decimal_stamps_keep_every_digit() {
        let stamp: Timestamp = "1557539956.439383".parse().expect("a stamp");
        assert_eq!(stamp.as_nanos(), 1_557_539_956_439_383_000);
        assert_eq!(stamp.to_string(), "1557539956.439383000");
    }

    #[test]
    fn what_is_not_decimal_seconds_is_refused() {
        for text in [
            "",
            ".5",
            "1e9",
            "-1.0",
            "1.2.3",
            "nan",
            "99999999999999999999",
        ] {
            assert!(text.parse::<Timestamp>().is_err(), "{text}");
        }
    }

    proptest! {
        #[test]
        fn display_and_parse_are_inverse(nanos in 0..i64::MAX) {
            let stamp = Timestamp::from_nanos(nanos);
            prop_assert_eq!(stamp.to_string().parse::<Timestamp>(), Ok(stamp));
        }
    }
}
