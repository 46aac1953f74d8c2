//! The `.msg` definitions of every type published: the single source of field order and type.
//!
//! Those of `roadwatch_msgs` are the files of the ament package itself; the others restate the fields
//! of ROS 2 Jazzy's packages (`vision_msgs` 4), which Humble shares. Bags carry them as schemas.

/// A definition of another package, as `msg/` restates it.
macro_rules! restated {
    ($name:literal) => {
        ($name, include_str!(concat!("../msg/", $name, ".msg")))
    };
}

/// A definition of `roadwatch_msgs`.
macro_rules! own {
    ($name:literal) => {
        (
            concat!("roadwatch_msgs/", $name),
            include_str!(concat!("../../../msgs/roadwatch_msgs/msg/", $name, ".msg")),
        )
    };
}

/// Text of each definition by `package/Type`, in alphabetical order.
const DEFINITIONS: &[(&str, &str)] = &[
    restated!("autoware_perception_msgs/DetectedObject"),
    restated!("autoware_perception_msgs/DetectedObjectKinematics"),
    restated!("autoware_perception_msgs/DetectedObjects"),
    restated!("autoware_perception_msgs/ObjectClassification"),
    restated!("autoware_perception_msgs/Shape"),
    restated!("autoware_perception_msgs/TrackedObject"),
    restated!("autoware_perception_msgs/TrackedObjectKinematics"),
    restated!("autoware_perception_msgs/TrackedObjects"),
    restated!("builtin_interfaces/Duration"),
    restated!("builtin_interfaces/Time"),
    restated!("diagnostic_msgs/DiagnosticArray"),
    restated!("diagnostic_msgs/DiagnosticStatus"),
    restated!("diagnostic_msgs/KeyValue"),
    restated!("geometry_msgs/Accel"),
    restated!("geometry_msgs/AccelWithCovariance"),
    restated!("geometry_msgs/Point"),
    restated!("geometry_msgs/Point32"),
    restated!("geometry_msgs/Polygon"),
    restated!("geometry_msgs/Pose"),
    restated!("geometry_msgs/PoseWithCovariance"),
    restated!("geometry_msgs/Quaternion"),
    restated!("geometry_msgs/Transform"),
    restated!("geometry_msgs/TransformStamped"),
    restated!("geometry_msgs/Twist"),
    restated!("geometry_msgs/TwistWithCovariance"),
    restated!("geometry_msgs/Vector3"),
    restated!("lifecycle_msgs/State"),
    restated!("lifecycle_msgs/Transition"),
    restated!("lifecycle_msgs/TransitionEvent"),
    restated!("nav_msgs/Odometry"),
    own!("KeyComponent"),
    own!("Object"),
    own!("ObjectArray"),
    restated!("rosgraph_msgs/Clock"),
    restated!("sensor_msgs/CameraInfo"),
    restated!("sensor_msgs/CompressedImage"),
    restated!("sensor_msgs/Image"),
    restated!("sensor_msgs/RegionOfInterest"),
    restated!("std_msgs/ColorRGBA"),
    restated!("std_msgs/Header"),
    restated!("tf2_msgs/TFMessage"),
    restated!("unique_identifier_msgs/UUID"),
    restated!("vision_msgs/BoundingBox2D"),
    restated!("vision_msgs/BoundingBox3D"),
    restated!("vision_msgs/Detection2D"),
    restated!("vision_msgs/Detection2DArray"),
    restated!("vision_msgs/Detection3D"),
    restated!("vision_msgs/Detection3DArray"),
    restated!("vision_msgs/ObjectHypothesis"),
    restated!("vision_msgs/ObjectHypothesisWithPose"),
    restated!("vision_msgs/Point2D"),
    restated!("vision_msgs/Pose2D"),
    restated!("visualization_msgs/Marker"),
    restated!("visualization_msgs/MarkerArray"),
    restated!("visualization_msgs/MeshFile"),
    restated!("visualization_msgs/UVCoordinate"),
];

/// What rosbag2 puts between the definitions of one schema.
const SEPARATOR_LENGTH: usize = 80;

/// Every type that is embedded, `package/Type`.
#[cfg(test)]
pub(crate) fn names() -> impl Iterator<Item = &'static str> {
    DEFINITIONS.iter().map(|(name, _)| *name)
}

/// The text of one definition; `None` when the type is not embedded.
#[must_use]
pub fn definition(ros_type: &str) -> Option<&'static str> {
    let at = DEFINITIONS
        .binary_search_by_key(&ros_type, |(name, _)| name)
        .ok()?;
    Some(DEFINITIONS[at].1)
}

/// A type's definition followed by those of all types it uses, as MCAP's `ros2msg` encoding wants
/// them; `None` when one of them is not embedded.
#[must_use]
pub fn schema(ros_type: &str) -> Option<String> {
    let mut names = vec![ros_type.to_owned()];
    let mut text = definition(ros_type)?.to_owned();
    let mut next = 0;
    while next < names.len() {
        for field in fields(definition(&names[next])?) {
            if field.is_message() && !names.contains(&field.base) {
                let used = definition(&field.base)?;
                let rule = "=".repeat(SEPARATOR_LENGTH);
                text.push_str(&format!("{rule}\nMSG: {}\n{used}", field.base));
                names.push(field.base);
            }
        }
        next += 1;
    }
    Some(text)
}

/// How many values a field holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Count {
    /// Exactly one, not an array.
    One,
    /// A fixed number.
    Fixed(usize),
    /// At most so many.
    UpTo(usize),
    /// Any number.
    Any,
}

/// One field of a definition.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Field {
    /// Its name.
    pub(crate) name: String,
    /// Type of its values: a primitive, or `package/Type`.
    pub(crate) base: String,
    /// How many there are.
    pub(crate) count: Count,
    /// The longest that a string may be; 0 when nothing bounds it.
    pub(crate) longest_string: usize,
}

impl Field {
    /// Whether the values are messages, not primitives. Definitions here always name the package.
    pub(crate) fn is_message(&self) -> bool {
        self.base.contains('/')
    }

    /// Reads `type name`, where the type may be `type[n]`, `type[<=n]` or `type[]` and a string `string<=n`; a default
    /// value after it is ignored. `None` for comments, blank lines and constants.
    fn parse(line: &str) -> Option<Self> {
        let code = line.split('#').next().unwrap_or_default().trim();
        let (ros_type, rest) = code.split_once(char::is_whitespace)?;
        if rest.contains('=') {
            return None;
        }
        let (element, count) = match ros_type.strip_suffix(']').and_then(|t| t.split_once('[')) {
            None => (ros_type, Count::One),
            Some((element, "")) => (element, Count::Any),
            Some((element, length)) => match length.strip_prefix("<=") {
                None => (element, Count::Fixed(length.parse().ok()?)),
                Some(most) => (element, Count::UpTo(most.parse().ok()?)),
            },
        };
        let (base, longest_string) = match element.split_once("<=") {
            None => (element, 0),
            Some((base, longest)) => (base, longest.parse().ok()?),
        };
        Some(Self {
            name: rest.split_whitespace().next()?.to_owned(),
            base: base.to_owned(),
            count,
            longest_string,
        })
    }
}

/// The fields of a definition, in order.
pub(crate) fn fields(definition: &str) -> Vec<Field> {
    definition.lines().filter_map(Field::parse).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::topics::TopicKind;

    #[test]
    fn definitions_are_in_order_so_that_the_search_finds_them() {
        assert!(DEFINITIONS.is_sorted_by_key(|(name, _)| name));
    }

    #[test]
    fn every_published_type_has_a_complete_schema() {
        for kind in TopicKind::ALL {
            assert!(schema(kind.ros_type()).is_some(), "{}", kind.ros_type());
        }
        assert_eq!(schema("std_msgs/Unheard"), None);
    }

    #[test]
    fn a_schema_names_each_dependency_once() {
        let text = schema("roadwatch_msgs/ObjectArray").expect("embedded");
        let named: Vec<&str> = text
            .lines()
            .filter_map(|l| l.strip_prefix("MSG: "))
            .collect();
        assert_eq!(
            named,
            [
                "std_msgs/Header",
                "geometry_msgs/Pose",
                "roadwatch_msgs/Object",
                "builtin_interfaces/Time",
                "geometry_msgs/Point",
                "geometry_msgs/Quaternion",
                "unique_identifier_msgs/UUID",
                "geometry_msgs/Vector3",
                "roadwatch_msgs/KeyComponent",
            ]
        );
        assert_eq!(text.matches(&"=".repeat(80)).count(), named.len());
    }

    #[test]
    fn bounds_are_read_and_are_not_mistaken_for_constants() {
        let field = |line| Field::parse(line).map(|f| (f.base, f.count, f.longest_string));
        let text = || "string".to_owned();
        assert_eq!(field("string<=5 a"), Some((text(), Count::One, 5)));
        assert_eq!(field("string<=5[<=3] a"), Some((text(), Count::UpTo(3), 5)));
        assert_eq!(field("string[2] a"), Some((text(), Count::Fixed(2), 0)));
        assert_eq!(field("string A=b"), None);
        assert_eq!(field("string A = b"), None);
    }

    #[test]
    fn every_line_is_a_field_a_constant_a_comment_or_blank() {
        for (name, text) in DEFINITIONS {
            for line in text
                .lines()
                .filter(|l| !l.trim().is_empty() && !l.starts_with('#') && !l.contains('='))
            {
                assert!(Field::parse(line).is_some(), "{name}: {line}");
            }
        }
    }
}
