//! What the node looks like from outside: its name, its namespace, its frames.

use crate::ros_args::{Renamed, RosArgs};

/// Depth of the per-frame topics' history unless configured otherwise, messages.
pub const DEFAULT_QUEUE_DEPTH: usize = 5;

/// Name, namespace and frame of the node, and how many messages its topics keep.
///
/// Shared by the node and the bag, so that both carry the same topics.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Surface {
    /// Name of the node: one legal ROS 2 name token.
    pub node_name: String,
    /// Namespace of the node, `/` for none: legal tokens joined and led by slashes.
    pub namespace: String,
    /// tf frame of the vehicle that positions are given in.
    pub base_frame: String,
    /// tf frame that the scene is published in instead, fixed to the ground; `None` publishes it in `base_frame`.
    pub scene_in_odom: Option<String>,
    /// Messages that a per-frame topic keeps for slow readers; at least 1.
    pub queue_depth: usize,
    /// Whether the scene is published as Autoware's messages, too.
    pub autoware: bool,
    /// Other names of topics, both absolute; none by default.
    pub remapped: Vec<(String, String)>,
}

impl Default for Surface {
    /// `/roadwatch`, positions in `base_link`, five messages kept.
    fn default() -> Self {
        Self {
            node_name: "roadwatch".to_owned(),
            namespace: "/".to_owned(),
            base_frame: "base_link".to_owned(),
            scene_in_odom: None,
            queue_depth: DEFAULT_QUEUE_DEPTH,
            autoware: false,
            remapped: Vec::new(),
        }
    }
}

/// A name, frame or depth that ROS 2 would refuse.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum InvalidSurface {
    /// The node's name is not a token.
    #[error(
        "`{0}` cannot name a node: use letters, digits and single underscores, not beginning with a digit"
    )]
    NodeName(String),
    /// The namespace is not a path of tokens.
    #[error(
        "`{0}` is not a namespace: expected `/`, or names led by slashes like `/vehicle/front`"
    )]
    Namespace(String),
    /// The frame's name is empty or absolute.
    #[error(
        "`{0}` cannot name a tf frame: it must not be empty, begin with a slash or hold blanks"
    )]
    BaseFrame(String),
    /// A topic must keep at least one message.
    #[error("a queue depth of 0 keeps no message: use 1 or more")]
    QueueDepth,
}

impl Surface {
    /// Checks what was configured.
    ///
    /// # Errors
    /// The first entry that ROS 2 would refuse.
    pub fn check(&self) -> Result<(), InvalidSurface> {
        if !is_token(&self.node_name) {
            return Err(InvalidSurface::NodeName(self.node_name.clone()));
        }
        if !is_namespace(&self.namespace) {
            return Err(InvalidSurface::Namespace(self.namespace.clone()));
        }
        for frame in std::iter::once(&self.base_frame).chain(&self.scene_in_odom) {
            if frame.is_empty() || frame.starts_with('/') || frame.contains(char::is_whitespace) {
                return Err(InvalidSurface::BaseFrame(frame.clone()));
            }
        }
        if self.queue_depth == 0 {
            return Err(InvalidSurface::QueueDepth);
        }
        Ok(())
    }

    /// The same under the names that somebody asked for at start.
    #[must_use]
    pub fn renamed(&self, args: &RosArgs) -> Self {
        let other = |what: Renamed| args.renamed(&self.node_name, |of| *of == what);
        let named = |what, before: &str| other(what).unwrap_or(before).to_owned();
        let mut renamed = Self {
            node_name: named(Renamed::Node, &self.node_name),
            namespace: named(Renamed::Namespace, &self.namespace),
            ..self.clone()
        };
        for rule in &args.rules {
            let is_ours = rule
                .node
                .as_ref()
                .is_none_or(|node| *node == self.node_name);
            if let (Renamed::Topic(from), true) = (&rule.what, is_ours) {
                let both = (renamed.absolute(from), renamed.absolute(&rule.to));
                renamed.remapped.push(both);
            }
        }
        renamed
    }

    /// The name that a topic goes by: absolute, and another one where it was remapped.
    #[must_use]
    pub fn topic(&self, name: &str) -> String {
        let name = self.absolute(name);
        let mut rules = self.remapped.iter();
        let other = rules.find(|(from, _)| *from == name);
        other.map_or(name, |(_, to)| to.clone())
    }

    fn absolute(&self, name: &str) -> String {
        if let Some(private) = name.strip_prefix("~/") {
            return format!("{}/{private}", self.private_prefix());
        }
        if name.starts_with('/') {
            return name.to_owned();
        }
        format!("{}/{name}", self.namespace.trim_end_matches('/'))
    }

    /// What `~` stands for in a topic's name: `/<namespace>/<node>`.
    #[must_use]
    pub fn private_prefix(&self) -> String {
        let namespace = self.namespace.trim_end_matches('/');
        format!("{namespace}/{}", self.node_name)
    }
}

/// Name of the topic with a camera's annotated images.
#[must_use]
pub fn annotated_topic(surface: &Surface, camera: &str) -> String {
    surface.topic(&format!("~/{camera}/image_annotated/compressed"))
}

pub(crate) fn is_token(text: &str) -> bool {
    let legal = |c: char| c.is_ascii_alphanumeric() || c == '_';
    !text.is_empty()
        && !text.starts_with(|c: char| c.is_ascii_digit())
        && !text.contains("__")
        && text.chars().all(legal)
}

pub(crate) fn is_namespace(text: &str) -> bool {
    text == "/"
        || text
            .strip_prefix('/')
            .is_some_and(|path| path.split('/').all(is_token))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn private_names_hang_below_the_node() {
        let root = Surface::default();
        assert_eq!(root.private_prefix(), "/roadwatch");
        let nested = Surface {
            namespace: "/vehicle/one".to_owned(),
            ..root
        };
        assert_eq!(nested.private_prefix(), "/vehicle/one/roadwatch");
    }

    #[test]
    fn names_asked_for_at_start_hold_for_the_node_and_its_topics() {
        let tokens = "-r __node:=eyes -r __ns:=/one -r ~/front/objects:=objects -r /tf_static:=tf_static \
                      -r roadwatch:~/back/objects:=/all -r other:~/left/objects:=/no";
        let tokens: Vec<String> = tokens.split_whitespace().map(str::to_owned).collect();
        let renamed = Surface::default().renamed(&RosArgs::parse(&tokens).expect("good"));
        assert_eq!(renamed.check(), Ok(()));
        assert_eq!(renamed.private_prefix(), "/one/eyes");
        for (name, expected) in [
            ("~/front/objects", "/one/objects"),
            ("~/back/objects", "/all"),
            ("~/left/objects", "/one/eyes/left/objects"),
            ("/tf_static", "/one/tf_static"),
        ] {
            assert_eq!(renamed.topic(name), expected);
        }
    }

    #[test]
    fn what_ros_refuses_is_refused() {
        let good = Surface::default();
        assert_eq!(good.check(), Ok(()));
        for bad in ["", "a b", "a/b", "9a", "a__b", "größe"] {
            let named = Surface {
                node_name: bad.to_owned(),
                ..good.clone()
            };
            assert_eq!(named.check(), Err(InvalidSurface::NodeName(bad.to_owned())));
        }
        for bad in ["", "vehicle", "/vehicle/", "//a", "/a//b", "/9"] {
            let placed = Surface {
                namespace: bad.to_owned(),
                ..good.clone()
            };
            assert_eq!(
                placed.check(),
                Err(InvalidSurface::Namespace(bad.to_owned()))
            );
        }
        for bad in ["", "/base_link", "base link"] {
            let framed = Surface {
                base_frame: bad.to_owned(),
                ..good.clone()
            };
            assert_eq!(
                framed.check(),
                Err(InvalidSurface::BaseFrame(bad.to_owned()))
            );
        }
        let shallow = Surface {
            queue_depth: 0,
            ..good
        };
        assert_eq!(shallow.check(), Err(InvalidSurface::QueueDepth));
    }
}
