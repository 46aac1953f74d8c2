//! Camera names, which become ROS topic and frame names.

use std::fmt;

/// A camera's name: a legal ROS 2 name token (`[A-Za-z][A-Za-z0-9_]*`, no double underscore).
#[derive(Clone, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct CameraName(String);

/// Topics of the fused scene have this name where a camera's have the camera's.
const RESERVED: &str = "scene";

/// A name that ROS 2 would refuse as a topic token, or that is taken.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error(
    "`{0}` cannot name a camera: use letters, digits and single underscores, beginning with a letter; \
     `scene` is taken by the fused scene's topics"
)]
pub struct InvalidName(String);

impl CameraName {
    /// Checks a name once; every later holder of the type may rely on it.
    ///
    /// # Errors
    /// When the text is not a legal ROS 2 name token.
    pub fn new(text: &str) -> Result<Self, InvalidName> {
        let legal = text.starts_with(|c: char| c.is_ascii_alphabetic())
            && text.chars().all(|c| c.is_ascii_alphanumeric() || c == '_')
            && !text.contains("__")
            && text != RESERVED;
        if legal {
            Ok(Self(text.to_owned()))
        } else {
            Err(InvalidName(text.to_owned()))
        }
    }

    /// The name as text.
    #[must_use]
    pub fn as_str(&self) -> &str {
        &self.0
    }

    /// The name of this camera's optical frame in tf: `<camera>_optical_frame`.
    #[must_use]
    pub fn optical_frame(&self) -> String {
        format!("{}_optical_frame", self.0)
    }
}

impl fmt::Display for CameraName {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_that_ros_refuses_are_refused() {
        for bad in [
            "",
            "1st",
            "front left",
            "front/left",
            "_x",
            "a__b",
            "größe",
            "scene",
        ] {
            assert!(CameraName::new(bad).is_err(), "{bad}");
        }
        assert!(CameraName::new("front_left2").is_ok());
    }
}
