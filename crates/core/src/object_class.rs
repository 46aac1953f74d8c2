//! Object classes by name, the way detectors, truth and messages spell them.

use std::{fmt, sync::Arc};

/// A class of objects, by its COCO-style name (`car`, `person`, `traffic light`).
///
/// Cloning shares the text.
#[derive(Clone, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct ObjectClass(Arc<str>);

impl ObjectClass {
    /// A class from its name.
    #[must_use]
    pub fn new(name: &str) -> Self {
        Self(name.into())
    }

    /// The name.
    #[must_use]
    pub fn as_str(&self) -> &str {
        &self.0
    }
}

impl fmt::Display for ObjectClass {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.0)
    }
}
