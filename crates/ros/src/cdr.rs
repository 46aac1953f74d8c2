//! Messages as bytes: CDR, little endian, behind the four-byte header that names the encoding.

use crate::convert::Message;
use byteorder::{BigEndian, LittleEndian};
use serde::de::DeserializeOwned;

/// `CDR_LE` and no options, as every ROS 2 middleware begins a sample.
const ENCAPSULATION: [u8; 4] = [0x00, 0x01, 0x00, 0x00];

/// A message that cannot be expressed in CDR.
#[derive(Debug, thiserror::Error)]
#[error("message not encoded")]
pub struct EncodeError(#[from] cdr_encoding::Error);

/// The message as DDS carries it and bags store it.
///
/// # Errors
/// When the message holds something that CDR has no form for; the types of this crate never do.
pub fn encode(message: &Message) -> Result<Vec<u8>, EncodeError> {
    let mut bytes = ENCAPSULATION.to_vec();
    // Alignment counts from behind the header, so the body is written on its own.
    bytes.extend(cdr_encoding::to_vec::<Message, LittleEndian>(message)?);
    Ok(bytes)
}

/// Bytes that are no such message.
#[derive(Debug, thiserror::Error)]
pub enum DecodeError {
    /// Not in CDR, or with options that ROS does not use.
    #[error("the message is not in plain CDR")]
    Encapsulation,
    /// Cut short, or of another type.
    #[error("the message is damaged: {0}")]
    Damaged(#[from] cdr_encoding::Error),
}

/// A message from the form in which DDS carries it and bags store it, in either order of bytes.
///
/// # Errors
/// When the bytes are not such a message.
pub fn decode<M: DeserializeOwned>(bytes: &[u8]) -> Result<M, DecodeError> {
    let (header, body) = bytes
        .split_at_checked(ENCAPSULATION.len())
        .ok_or(DecodeError::Encapsulation)?;
    let (message, _) = match header[..2] {
        [0, 0] => cdr_encoding::from_bytes::<M, BigEndian>(body)?,
        [0, 1] => cdr_encoding::from_bytes::<M, LittleEndian>(body)?,
        _ => return Err(DecodeError::Encapsulation),
    };
    Ok(message)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::msg::{
        builtin_interfaces::Time,
        geometry_msgs::Point,
        roadwatch_msgs::ObjectArray,
        std_msgs::Header,
        visualization_msgs::{Marker, MarkerArray},
    };

    fn header() -> Header {
        Header {
            stamp: Time {
                sec: 1_557_539_956,
                nanosec: 439_383_000,
            },
            frame_id: "base".to_owned(),
        }
    }

    #[test]
    fn a_header_begins_with_the_encoding_and_is_aligned_behind_it() {
        let bytes = encode(&Message::Objects(ObjectArray {
            header: header(),
            ..ObjectArray::default()
        }))
        .expect("encoded");
        let expected = [
            &[0x00, 0x01, 0x00, 0x00][..], // little-endian CDR, no options
            &[0x74, 0x2c, 0xd6, 0x5c],     // sec
            &[0xd8, 0x73, 0x30, 0x1a],     // nanosec
            &[5, 0, 0, 0],                 // frame_id: five bytes with the final zero
            b"base\0",
            &[0, 0, 0],       // to the next multiple of four
            &[1, 0, 0, 0, 0], // camera: the empty text is one zero
            &[0, 0, 0],
            &[1, 0, 0, 0, 0],                // ego_motion, too
            &[0; 7],                         // numbers of 64 bits stand at multiples of eight
            &[0; 6 * 8],                     // ego_pose: a place, x, y and z of no turn
            &[0, 0, 0, 0, 0, 0, 0xf0, 0x3f], // and its w, one
            &[0, 0, 0, 0],                   // no objects
        ]
        .concat();
        assert_eq!(bytes, expected);
    }

    #[test]
    fn points_are_counted_and_aligned_to_eight_behind_the_encoding() {
        let point = Point {
            x: 1.0,
            y: -2.0,
            z: 0.5,
        };
        let points = cdr_encoding::to_vec::<_, LittleEndian>(&vec![point; 2]).expect("encoded");
        let one = [
            [0, 0, 0, 0, 0, 0, 0xf0, 0x3f],
            [0, 0, 0, 0, 0, 0, 0x00, 0xc0],
            [0, 0, 0, 0, 0, 0, 0xe0, 0x3f],
        ]
        .concat();
        let expected = [&[2, 0, 0, 0, 0, 0, 0, 0][..], &one, &one].concat();
        assert_eq!(points, expected);
    }

    #[test]
    fn a_message_reads_back_as_it_was() {
        let array = MarkerArray {
            markers: vec![Marker {
                header: header(),
                text: "car 1 19.2 m".to_owned(),
                ..Marker::default()
            }],
        };
        let bytes = encode(&Message::Markers(array.clone())).expect("encoded");
        let body = &bytes[ENCAPSULATION.len()..];
        let (back, used) =
            cdr_encoding::from_bytes::<MarkerArray, LittleEndian>(body).expect("read");
        assert_eq!(back, array);
        assert_eq!(used, body.len());
    }
}
