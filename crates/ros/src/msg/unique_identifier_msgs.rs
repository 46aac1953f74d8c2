//! `unique_identifier_msgs`: names that nothing else has.

use serde::{Deserialize, Serialize};

/// A universally unique identifier.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct UUID {
    /// Its bytes, the most significant first; all zero for nobody.
    pub uuid: [u8; 16],
}
