//! Protobuf's wire format, as much of it as a graph is copied with.

/// Kinds of values; the others are not used by ONNX.
const VARINT: u64 = 0;
const FIXED_64: u64 = 1;
const DELIMITED: u64 = 2;
const FIXED_32: u64 = 5;

/// One field of a message.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Field<'a> {
    pub(crate) number: u64,
    /// What a delimited field holds; empty for numbers.
    pub(crate) content: &'a [u8],
    /// The field with its tag, as it stands in the message.
    pub(crate) whole: &'a [u8],
}

/// The fields of a message in their order; ends with an error where the bytes are no message.
pub(crate) fn fields(mut rest: &[u8]) -> impl Iterator<Item = Result<Field<'_>, Malformed>> {
    std::iter::from_fn(move || {
        if rest.is_empty() {
            return None;
        }
        let field = next(rest).ok_or(Malformed);
        rest = field
            .as_ref()
            .map_or(&[], |field| &rest[field.whole.len()..]);
        Some(field)
    })
}

/// Bytes that are no protobuf message.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Malformed;

fn next(message: &[u8]) -> Option<Field<'_>> {
    let mut at = 0;
    let tag = varint(message, &mut at)?;
    let content = match tag & 7 {
        VARINT => {
            varint(message, &mut at)?;
            at..at
        }
        FIXED_64 => at + 8..at + 8,
        FIXED_32 => at + 4..at + 4,
        DELIMITED => {
            let length = usize::try_from(varint(message, &mut at)?).ok()?;
            at..at.checked_add(length)?
        }
        _ => return None,
    };
    Some(Field {
        number: tag >> 3,
        whole: message.get(..content.end)?,
        content: message.get(content)?,
    })
}

fn varint(message: &[u8], at: &mut usize) -> Option<u64> {
    let mut value = 0;
    for shift in (0..64).step_by(7) {
        let byte = *message.get(*at)?;
        *at += 1;
        value |= u64::from(byte & 0x7f) << shift;
        if byte & 0x80 == 0 {
            return Some(value);
        }
    }
    None
}

/// Appends a delimited field.
pub(crate) fn put(message: &mut Vec<u8>, number: u64, content: &[u8]) {
    put_varint(message, number << 3 | DELIMITED);
    put_varint(message, content.len() as u64);
    message.extend_from_slice(content);
}

/// Appends a field that is a number.
pub(crate) fn put_number(message: &mut Vec<u8>, number: u64, value: u64) {
    put_varint(message, number << 3 | VARINT);
    put_varint(message, value);
}

fn put_varint(message: &mut Vec<u8>, mut value: u64) {
    while value >= 0x80 {
        message.push((value & 0x7f) as u8 | 0x80);
        value >>= 7;
    }
    message.push(value as u8);
}
