//! Requests and answers as the bytes that they are, whatever their type.

use ros2_client::Message;
use serde::{
    Deserialize, Deserializer, Serialize, Serializer,
    de::{SeqAccess, Visitor},
    ser::SerializeTuple as _,
};
use std::fmt;

/// The bytes of a CDR sample behind its encapsulation header.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(super) struct Raw(pub(super) Vec<u8>);

impl Message for Raw {}

impl Serialize for Raw {
    /// Byte by byte without a length in front: a tuple, which CDR does not mark.
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut tuple = serializer.serialize_tuple(self.0.len())?;
        for byte in &self.0 {
            tuple.serialize_element(byte)?;
        }
        tuple.end()
    }
}

impl<'de> Deserialize<'de> for Raw {
    /// Takes what is there: CDR does not say how long a tuple is, so the end of the bytes ends it.
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_tuple(usize::MAX, All)
    }
}

struct All;

impl<'de> Visitor<'de> for All {
    type Value = Raw;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("bytes")
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut bytes: A) -> Result<Raw, A::Error> {
        let mut all = Vec::new();
        while let Ok(Some(byte)) = bytes.next_element() {
            all.push(byte);
        }
        Ok(Raw(all))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use byteorder::LittleEndian;

    #[test]
    fn bytes_stay_what_they_are() {
        for bytes in [vec![], vec![7], (0..=255).collect::<Vec<u8>>()] {
            let raw = Raw(bytes.clone());
            let written = cdr_encoding::to_vec::<_, LittleEndian>(&raw).expect("written");
            assert_eq!(written, bytes);
            let (read, used) = cdr_encoding::from_bytes::<Raw, LittleEndian>(&bytes).expect("read");
            assert_eq!((read, used), (raw, bytes.len()));
        }
    }
}
