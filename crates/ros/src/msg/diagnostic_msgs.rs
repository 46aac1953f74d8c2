//! `diagnostic_msgs`: how parts of a system are.

use super::std_msgs::Header;
use serde::{Deserialize, Serialize};

/// One thing that is known of a part.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct KeyValue {
    /// What it is.
    pub key: String,
    /// Its value, as text.
    pub value: String,
}

/// How one part is.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct DiagnosticStatus {
    /// One of the constants.
    pub level: u8,
    /// The part, led by the node.
    pub name: String,
    /// How it is, in words.
    pub message: String,
    /// The device it is about.
    pub hardware_id: String,
    /// What is known of it.
    pub values: Vec<KeyValue>,
}

impl DiagnosticStatus {
    /// All is well.
    pub const OK: u8 = 0;
    /// Something is not as it should be.
    pub const WARN: u8 = 1;
    /// It does not work.
    pub const ERROR: u8 = 2;
    /// Nothing is heard of it any more.
    pub const STALE: u8 = 3;
}

/// How all parts are.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct DiagnosticArray {
    /// When.
    pub header: Header,
    /// One per part.
    pub status: Vec<DiagnosticStatus>,
}
