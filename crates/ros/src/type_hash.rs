//! Type hashes (REP-2016, `RIHS01`): whether two sides mean the same by the name of a type.
//!
//! The hash is the SHA-256 of the type's description and of those of all types in it, as JSON in the form that
//! `rosidl_generator_type_description` gives it.

use crate::definitions::{self, Count, Field};
use serde::Serialize;
use sha2::{Digest as _, Sha256};
use std::{
    collections::BTreeMap,
    fmt::Write as _,
    io::{self, Write},
};

/// Numbers of the primitives (`type_description_interfaces/FieldType`).
const PRIMITIVES: [(&str, u8); 15] = [
    ("int8", 2),
    ("uint8", 3),
    ("char", 3),
    ("int16", 4),
    ("uint16", 5),
    ("int32", 6),
    ("uint32", 7),
    ("int64", 8),
    ("uint64", 9),
    ("float32", 10),
    ("float64", 11),
    ("bool", 15),
    ("byte", 16),
    ("string", 17),
    ("wstring", 18),
];
const NESTED: u8 = 1;
/// Added to the number for a fixed number of values, or for any number.
const ARRAY: u8 = 48;
const SEQUENCE: u8 = 144;

/// Fields stand in the order in which they are hashed.
#[derive(Serialize)]
struct Description {
    type_name: String,
    fields: Vec<FieldDescription>,
}

#[derive(Serialize)]
struct FieldDescription {
    name: String,
    r#type: FieldType,
}

#[derive(Serialize)]
struct FieldType {
    type_id: u8,
    capacity: usize,
    string_capacity: usize,
    nested_type_name: String,
}

#[derive(Serialize)]
struct Whole {
    type_description: Description,
    referenced_type_descriptions: Vec<Description>,
}

/// The hash of a type, `RIHS01_…`; `None` when its definition, or one in it, is not embedded.
#[must_use]
pub fn type_hash(ros_type: &str) -> Option<String> {
    let mut referenced = BTreeMap::new();
    let whole = Whole {
        type_description: described(ros_type, &mut referenced)?,
        referenced_type_descriptions: referenced.into_values().collect(),
    };
    let mut hasher = Hasher(Sha256::new());
    let mut json = serde_json::Serializer::with_formatter(&mut hasher, Spaced);
    whole.serialize(&mut json).ok()?;
    let digest = hasher.0.finalize();
    let mut text = "RIHS01_".to_owned();
    for byte in digest {
        write!(text, "{byte:02x}").ok()?;
    }
    Some(text)
}

/// Describes a type, and puts those in it into `referenced`, by their names.
fn described(
    ros_type: &str,
    referenced: &mut BTreeMap<String, Description>,
) -> Option<Description> {
    let fields = definitions::fields(definitions::definition(ros_type)?);
    for field in fields.iter().filter(|field| field.is_message()) {
        let name = long(&field.base);
        if !referenced.contains_key(&name) {
            let inner = described(&field.base, referenced)?;
            referenced.insert(name, inner);
        }
    }
    Some(Description {
        type_name: long(ros_type),
        fields: fields
            .iter()
            .map(field_description)
            .collect::<Option<_>>()?,
    })
}

fn field_description(field: &Field) -> Option<FieldDescription> {
    let (offset, capacity) = match field.count {
        Count::One => (0, 0),
        Count::Fixed(number) => (ARRAY, number),
        Count::Any => (SEQUENCE, 0),
    };
    let mut known = PRIMITIVES.iter();
    let (type_id, nested_type_name) = match field.is_message() {
        true => (NESTED, long(&field.base)),
        false => (
            known.find(|(name, _)| *name == field.base)?.1,
            String::new(),
        ),
    };
    Some(FieldDescription {
        name: field.name.clone(),
        r#type: FieldType {
            type_id: type_id + offset,
            capacity,
            string_capacity: 0,
            nested_type_name,
        },
    })
}

/// `package/msg/Type` of `package/Type`.
fn long(ros_type: &str) -> String {
    ros_type.replacen('/', "/msg/", 1)
}

struct Hasher(Sha256);

impl Write for Hasher {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.0.update(bytes);
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

/// JSON on one line with a blank behind commas and colons, as Python writes it.
struct Spaced;

impl serde_json::ser::Formatter for Spaced {
    fn begin_array_value<W: Write + ?Sized>(&mut self, to: &mut W, first: bool) -> io::Result<()> {
        to.write_all(if first { b"" } else { b", " })
    }

    fn begin_object_key<W: Write + ?Sized>(&mut self, to: &mut W, first: bool) -> io::Result<()> {
        to.write_all(if first { b"" } else { b", " })
    }

    fn begin_object_value<W: Write + ?Sized>(&mut self, to: &mut W) -> io::Result<()> {
        to.write_all(b": ")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// As ROS 2 Jazzy installs them (`share/<package>/msg/<Type>.json`), and `ros2 topic info --verbose` shows them.
    const PUBLISHED: [(&str, &str); 11] = [
        (
            "builtin_interfaces/Time",
            "b106235e25a4c5ed35098aa0a61a3ee9c9b18d197f398b0e4206cea9acf9c197",
        ),
        (
            "std_msgs/Header",
            "f49fb3ae2cf070f793645ff749683ac6b06203e41c891e17701b1cb597ce6a01",
        ),
        (
            "geometry_msgs/Vector3",
            "cc12fe83e4c02719f1ce8070bfd14aecd40f75a96696a67a2a1f37f7dbb0765d",
        ),
        (
            "sensor_msgs/Image",
            "d31d41a9a4c4bc8eae9be757b0beed306564f7526c88ea6a4588fb9582527d47",
        ),
        (
            "sensor_msgs/CompressedImage",
            "15640771531571185e2efc8a100baf923961a4d15d5569652e6cb6691e8e371a",
        ),
        (
            "sensor_msgs/CameraInfo",
            "b3dfd68ff46c9d56c80fd3bd4ed22c7a4ddce8c8348f2f59c299e73118e7e275",
        ),
        (
            "tf2_msgs/TFMessage",
            "e369d0f05a23ae52508854b66f6aa0437f3449d652e8cbf22d5abe85d020f087",
        ),
        (
            "rosgraph_msgs/Clock",
            "692f7a66e93a3c83e71765d033b60349ba68023a8c689a79e48078bcb5c58564",
        ),
        (
            "visualization_msgs/MarkerArray",
            "86cb8800b6fb05b5eff1abd7a56f62a5641d3ae9a1c29e78e67e704f1d067dcf",
        ),
        (
            "vision_msgs/Detection3DArray",
            "793f5eab9595ac1c0da07873cc859db42eae51f0ee76056db8562515d830e018",
        ),
        (
            "diagnostic_msgs/DiagnosticArray",
            "5a8a36efb05fb25070fa0fb3810290c0e6cd4862b54a8fb975a1ee8dc55a333e",
        ),
    ];

    #[test]
    fn standard_types_have_their_published_hashes() {
        for (ros_type, hash) in PUBLISHED {
            assert_eq!(
                type_hash(ros_type),
                Some(format!("RIHS01_{hash}")),
                "{ros_type}"
            );
        }
    }

    #[test]
    fn every_embedded_type_has_a_hash_and_others_have_none() {
        for ros_type in definitions::names() {
            assert!(type_hash(ros_type).is_some(), "{ros_type}");
        }
        assert_eq!(type_hash("std_msgs/Unheard"), None);
    }
}
