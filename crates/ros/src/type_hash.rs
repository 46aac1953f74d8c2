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
/// Added to the number of a string that has a bound.
const BOUNDED_STRING: u8 = 4;
/// Added to the number for a fixed number of values, for a bounded one, or for any.
const ARRAY: u8 = 48;
const BOUNDED_SEQUENCE: u8 = 96;
const SEQUENCE: u8 = 144;
/// What `rosidl` puts into a message without fields, as C has no empty structures.
const PLACEHOLDER: &str = "uint8 structure_needs_at_least_one_member";

/// Gives the text of `package/Type`.
type Lookup = fn(&str) -> Option<&'static str>;

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
    hash_by(ros_type, definitions::definition)
}

fn hash_by(ros_type: &str, definition: Lookup) -> Option<String> {
    let mut referenced = BTreeMap::new();
    let whole = Whole {
        type_description: described(ros_type, definition, &mut referenced)?,
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
    definition: Lookup,
    referenced: &mut BTreeMap<String, Description>,
) -> Option<Description> {
    let mut fields = definitions::fields(definition(ros_type)?);
    if fields.is_empty() {
        fields = definitions::fields(PLACEHOLDER);
    }
    for field in fields.iter().filter(|field| field.is_message()) {
        let name = long(&field.base);
        if !referenced.contains_key(&name) {
            let inner = described(&field.base, definition, referenced)?;
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
        Count::UpTo(most) => (BOUNDED_SEQUENCE, most),
        Count::Any => (SEQUENCE, 0),
    };
    let (element, nested_type_name) = match field.is_message() {
        true => (NESTED, long(&field.base)),
        false => (primitive(field)?, String::new()),
    };
    Some(FieldDescription {
        name: field.name.clone(),
        r#type: FieldType {
            type_id: element + offset,
            capacity,
            string_capacity: field.longest_string,
            nested_type_name,
        },
    })
}

fn primitive(field: &Field) -> Option<u8> {
    let mut known = PRIMITIVES.iter();
    let (_, number) = known.find(|(name, _)| *name == field.base)?;
    Some(match field.longest_string {
        0 => *number,
        _ => number + BOUNDED_STRING,
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

    /// Hashes as published, each behind its type.
    ///
    /// Jazzy's packages (`common_interfaces` 5.3.6, `rcl_interfaces` 2.0.3) install them as
    /// `share/<package>/msg/<Type>.json`, and `ros2 topic info --verbose` shows them. That of `TFMessage` is in bags of
    /// Jazzy, those of `vision_msgs` in the C sources that `rosidl_generator_c` makes of version 4.
    const PUBLISHED: &str = "\
        builtin_interfaces/Duration e8d009f659816f758b75334ee1a9ca5b5c0b859843261f14c7f937349599d93b
        builtin_interfaces/Time b106235e25a4c5ed35098aa0a61a3ee9c9b18d197f398b0e4206cea9acf9c197
        diagnostic_msgs/DiagnosticArray 5a8a36efb05fb25070fa0fb3810290c0e6cd4862b54a8fb975a1ee8dc55a333e
        geometry_msgs/Point 6963084842a9b04494d6b2941d11444708d892da2f4b09843b9c43f42a7f6881
        geometry_msgs/Polygon 3782f9f0bf044964d692d6c017d705e37611afb1f0bf6a9dee248a7dda0f784a
        geometry_msgs/PoseWithCovariance 9a7c0fd234b7f45c6098745ecccd773ca1085670e64107135397aee31c02e1bb
        geometry_msgs/Quaternion 8a765f66778c8ff7c8ab94afcc590a2ed5325a1d9a076ffff38fbce36f458684
        geometry_msgs/TransformStamped 0a241f87d04668d94099cbb5ba11691d5ad32c2f29682e4eb5653424bd275206
        geometry_msgs/TwistWithCovariance 49f574f033f095d8b6cd1beaca5ca7925e296e84af1716d16c89d38b059c8c18
        geometry_msgs/Vector3 cc12fe83e4c02719f1ce8070bfd14aecd40f75a96696a67a2a1f37f7dbb0765d
        lifecycle_msgs/TransitionEvent d5f8873a2f0146498f812d7885c7327ce27e463d36811d8792f35ee38c0d6c38
        nav_msgs/Odometry 3cc97dc7fb7502f8714462c526d369e35b603cfc34d946e3f2eda2766dfec6e0
        rosgraph_msgs/Clock 692f7a66e93a3c83e71765d033b60349ba68023a8c689a79e48078bcb5c58564
        sensor_msgs/CameraInfo b3dfd68ff46c9d56c80fd3bd4ed22c7a4ddce8c8348f2f59c299e73118e7e275
        sensor_msgs/CompressedImage 15640771531571185e2efc8a100baf923961a4d15d5569652e6cb6691e8e371a
        sensor_msgs/Image d31d41a9a4c4bc8eae9be757b0beed306564f7526c88ea6a4588fb9582527d47
        std_msgs/ColorRGBA 77a7a5b9ae477306097665106e0413ba74440245b1f3d0c6d6405fe5c7813fe8
        std_msgs/Header f49fb3ae2cf070f793645ff749683ac6b06203e41c891e17701b1cb597ce6a01
        tf2_msgs/TFMessage e369d0f05a23ae52508854b66f6aa0437f3449d652e8cbf22d5abe85d020f087
        vision_msgs/Detection2DArray 214274120007f4a683866481336b70310268cfa107aebe9d594a6acf75bda968
        vision_msgs/Detection3DArray 793f5eab9595ac1c0da07873cc859db42eae51f0ee76056db8562515d830e018
        visualization_msgs/MarkerArray 86cb8800b6fb05b5eff1abd7a56f62a5641d3ae9a1c29e78e67e704f1d067dcf";

    #[test]
    fn standard_types_have_their_published_hashes() {
        for line in PUBLISHED.lines() {
            let (ros_type, hash) = line.trim().split_once(' ').expect("two words");
            assert_eq!(
                type_hash(ros_type),
                Some(format!("RIHS01_{hash}")),
                "{ros_type}"
            );
        }
    }

    /// Standard types with what no embedded definition has: no fields, bounded strings, bounded sequences.
    fn rare(ros_type: &str) -> Option<&'static str> {
        Some(match ros_type {
            "std_msgs/Empty" => "# Nothing.\n",
            "test_msgs/Strings" => {
                "string string_value
                string string_value_default1 \"Hello world!\"
                string string_value_default2 \"Hello'world!\"
                string string_value_default3 'Hello\"world!'
                string string_value_default4 'Hello\\'world!'
                string string_value_default5 \"Hello\\\"world!\"
                string STRING_CONST=\"Hello world!\"
                string<=22 bounded_string_value
                string<=22 bounded_string_value_default1 \"Hello world!\"
                string<=22 bounded_string_value_default2 \"Hello'world!\"
                string<=22 bounded_string_value_default3 'Hello\"world!'
                string<=22 bounded_string_value_default4 'Hello\\'world!'
                string<=22 bounded_string_value_default5 \"Hello\\\"world!\""
            }
            "rcl_interfaces/ParameterDescriptor" => {
                "string name
                uint8 type
                string description
                string additional_constraints
                bool read_only false
                bool dynamic_typing false
                rcl_interfaces/FloatingPointRange[<=1] floating_point_range
                rcl_interfaces/IntegerRange[<=1] integer_range"
            }
            "rcl_interfaces/FloatingPointRange" => {
                "float64 from_value\nfloat64 to_value\nfloat64 step"
            }
            "rcl_interfaces/IntegerRange" => "int64 from_value\nint64 to_value\nuint64 step",
            _ => return None,
        })
    }

    #[test]
    fn so_have_those_without_fields_and_those_with_bounds() {
        for (ros_type, hash) in [
            (
                "std_msgs/Empty",
                "20b625256f32d5dbc0d04fee44f43c41e51c70d3502f84b4a08e7a9c26a96312",
            ),
            (
                "test_msgs/Strings",
                "eee55533636293ac7c94c62432eedb5777eb849847d2a17b4dcead8c4a20ab32",
            ),
            (
                "rcl_interfaces/ParameterDescriptor",
                "52175dbfda6c51153101d33d2a9da05743f66f02d5ab2ca9ec4709b46b73d704",
            ),
        ] {
            let expected = Some(format!("RIHS01_{hash}"));
            assert_eq!(hash_by(ros_type, rare), expected, "{ros_type}");
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
