//! `[ego]`: who tells where the vehicle itself is.

use super::reader::Reader;
use std::{fmt, path::PathBuf};

/// Who tells where the vehicle is.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub enum EgoConfig {
    /// The dataset that is played, where it says so; else nobody.
    #[default]
    Dataset,
    /// It never moves: a mast, a parked car.
    Still,
    /// Odometry or transforms, of a topic or of a bag.
    Ros {
        /// The bag; `None` for a topic.
        bag: Option<PathBuf>,
        /// What is listened to.
        topic: EgoTopic,
    },
}

/// A topic that tells where the vehicle is.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum EgoTopic {
    /// `nav_msgs/Odometry` of that name.
    Odometry(String),
    /// `/tf`, from that frame to the base frame.
    Tf(String),
}

impl fmt::Display for EgoTopic {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Odometry(name) => write!(f, "the topic {name}"),
            Self::Tf(odom_frame) => write!(f, "the topic /tf, in the frame {odom_frame}"),
        }
    }
}

impl EgoConfig {
    /// Who tells where the vehicle is, in a few words; a dataset only where it `knows`.
    #[must_use]
    pub fn told_by(&self, knows: bool) -> Option<String> {
        match self {
            Self::Dataset => knows.then(|| "the dataset".to_owned()),
            Self::Still => Some("the configuration, which says that it is still".to_owned()),
            Self::Ros {
                bag: Some(bag),
                topic,
            } => Some(format!("{topic} in {}", bag.display())),
            Self::Ros { bag: None, topic } => Some(topic.to_string()),
        }
    }

    /// Whether a topic tells, which may fall silent.
    #[must_use]
    pub fn is_live(&self) -> bool {
        matches!(self, Self::Ros { bag: None, .. })
    }
}

pub(super) fn read(ego: &Reader<'_, '_>) -> EgoConfig {
    let still = ego.flag("still").unwrap_or_default();
    let bag = ego.path("bag");
    let odometry = ego.text("odometry");
    let tf = ego.text("tf_frame");
    let told = [still, odometry.is_some(), tf.is_some()];
    if told.into_iter().filter(|one| *one).count() > 1 {
        ego.note(
            if tf.is_some() { "tf_frame" } else { "odometry" },
            "only one can tell where the vehicle is: keep one of `still`, `odometry` and `tf_frame`",
        );
    }
    if odometry.is_some_and(str::is_empty) {
        ego.note("odometry", "empty: expected the name of a topic");
    }
    let is_frame = |name: &str| {
        !name.is_empty() && !name.starts_with('/') && !name.contains(char::is_whitespace)
    };
    if tf.is_some_and(|frame| !is_frame(frame)) {
        ego.note(
            "tf_frame",
            "cannot name a tf frame: it must not be empty, begin with a slash or hold blanks",
        );
    }
    let topic = match (odometry, tf) {
        (Some(topic), _) => Some(EgoTopic::Odometry(topic.to_owned())),
        (None, Some(frame)) => Some(EgoTopic::Tf(frame.to_owned())),
        (None, None) => None,
    };
    match topic {
        Some(topic) => EgoConfig::Ros { bag, topic },
        None => {
            if bag.is_some() {
                ego.note("bag", "of which topic? add `odometry` or `tf_frame`");
            }
            if still {
                EgoConfig::Still
            } else {
                EgoConfig::Dataset
            }
        }
    }
}
