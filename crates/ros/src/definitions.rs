//! The `.msg` definitions of every type published: the single source of field order and type.
//!
//! Those of `roadwatch_msgs` are the files of the ament package itself; the others restate the fields
//! of ROS 2 Jazzy's packages (`vision_msgs` 4), which Humble shares. Bags carry them as schemas.

/// Text of each definition by `package/Type`, in alphabetical order.
const DEFINITIONS: &[(&str, &str)] = &[
    (
        "autoware_perception_msgs/DetectedObject",
        include_str!("../msg/autoware_perception_msgs/DetectedObject.msg"),
    ),
    (
        "autoware_perception_msgs/DetectedObjectKinematics",
        include_str!("../msg/autoware_perception_msgs/DetectedObjectKinematics.msg"),
    ),
    (
        "autoware_perception_msgs/DetectedObjects",
        include_str!("../msg/autoware_perception_msgs/DetectedObjects.msg"),
    ),
    (
        "autoware_perception_msgs/ObjectClassification",
        include_str!("../msg/autoware_perception_msgs/ObjectClassification.msg"),
    ),
    (
        "autoware_perception_msgs/Shape",
        include_str!("../msg/autoware_perception_msgs/Shape.msg"),
    ),
    (
        "builtin_interfaces/Duration",
        include_str!("../msg/builtin_interfaces/Duration.msg"),
    ),
    (
        "builtin_interfaces/Time",
        include_str!("../msg/builtin_interfaces/Time.msg"),
    ),
    (
        "diagnostic_msgs/DiagnosticArray",
        include_str!("../msg/diagnostic_msgs/DiagnosticArray.msg"),
    ),
    (
        "diagnostic_msgs/DiagnosticStatus",
        include_str!("../msg/diagnostic_msgs/DiagnosticStatus.msg"),
    ),
    (
        "diagnostic_msgs/KeyValue",
        include_str!("../msg/diagnostic_msgs/KeyValue.msg"),
    ),
    (
        "geometry_msgs/Point",
        include_str!("../msg/geometry_msgs/Point.msg"),
    ),
    (
        "geometry_msgs/Point32",
        include_str!("../msg/geometry_msgs/Point32.msg"),
    ),
    (
        "geometry_msgs/Polygon",
        include_str!("../msg/geometry_msgs/Polygon.msg"),
    ),
    (
        "geometry_msgs/Pose",
        include_str!("../msg/geometry_msgs/Pose.msg"),
    ),
    (
        "geometry_msgs/PoseWithCovariance",
        include_str!("../msg/geometry_msgs/PoseWithCovariance.msg"),
    ),
    (
        "geometry_msgs/Quaternion",
        include_str!("../msg/geometry_msgs/Quaternion.msg"),
    ),
    (
        "geometry_msgs/Transform",
        include_str!("../msg/geometry_msgs/Transform.msg"),
    ),
    (
        "geometry_msgs/TransformStamped",
        include_str!("../msg/geometry_msgs/TransformStamped.msg"),
    ),
    (
        "geometry_msgs/Twist",
        include_str!("../msg/geometry_msgs/Twist.msg"),
    ),
    (
        "geometry_msgs/TwistWithCovariance",
        include_str!("../msg/geometry_msgs/TwistWithCovariance.msg"),
    ),
    (
        "geometry_msgs/Vector3",
        include_str!("../msg/geometry_msgs/Vector3.msg"),
    ),
    (
        "lifecycle_msgs/State",
        include_str!("../msg/lifecycle_msgs/State.msg"),
    ),
    (
        "lifecycle_msgs/Transition",
        include_str!("../msg/lifecycle_msgs/Transition.msg"),
    ),
    (
        "lifecycle_msgs/TransitionEvent",
        include_str!("../msg/lifecycle_msgs/TransitionEvent.msg"),
    ),
    (
        "roadwatch_msgs/KeyComponent",
        include_str!("../../../msgs/roadwatch_msgs/msg/KeyComponent.msg"),
    ),
    (
        "roadwatch_msgs/Object",
        include_str!("../../../msgs/roadwatch_msgs/msg/Object.msg"),
    ),
    (
        "roadwatch_msgs/ObjectArray",
        include_str!("../../../msgs/roadwatch_msgs/msg/ObjectArray.msg"),
    ),
    (
        "rosgraph_msgs/Clock",
        include_str!("../msg/rosgraph_msgs/Clock.msg"),
    ),
    (
        "sensor_msgs/CameraInfo",
        include_str!("../msg/sensor_msgs/CameraInfo.msg"),
    ),
    (
        "sensor_msgs/CompressedImage",
        include_str!("../msg/sensor_msgs/CompressedImage.msg"),
    ),
    (
        "sensor_msgs/Image",
        include_str!("../msg/sensor_msgs/Image.msg"),
    ),
    (
        "sensor_msgs/RegionOfInterest",
        include_str!("../msg/sensor_msgs/RegionOfInterest.msg"),
    ),
    (
        "std_msgs/ColorRGBA",
        include_str!("../msg/std_msgs/ColorRGBA.msg"),
    ),
    (
        "std_msgs/Header",
        include_str!("../msg/std_msgs/Header.msg"),
    ),
    (
        "tf2_msgs/TFMessage",
        include_str!("../msg/tf2_msgs/TFMessage.msg"),
    ),
    (
        "vision_msgs/BoundingBox2D",
        include_str!("../msg/vision_msgs/BoundingBox2D.msg"),
    ),
    (
        "vision_msgs/BoundingBox3D",
        include_str!("../msg/vision_msgs/BoundingBox3D.msg"),
    ),
    (
        "vision_msgs/Detection2D",
        include_str!("../msg/vision_msgs/Detection2D.msg"),
    ),
    (
        "vision_msgs/Detection2DArray",
        include_str!("../msg/vision_msgs/Detection2DArray.msg"),
    ),
    (
        "vision_msgs/Detection3D",
        include_str!("../msg/vision_msgs/Detection3D.msg"),
    ),
    (
        "vision_msgs/Detection3DArray",
        include_str!("../msg/vision_msgs/Detection3DArray.msg"),
    ),
    (
        "vision_msgs/ObjectHypothesis",
        include_str!("../msg/vision_msgs/ObjectHypothesis.msg"),
    ),
    (
        "vision_msgs/ObjectHypothesisWithPose",
        include_str!("../msg/vision_msgs/ObjectHypothesisWithPose.msg"),
    ),
    (
        "vision_msgs/Point2D",
        include_str!("../msg/vision_msgs/Point2D.msg"),
    ),
    (
        "vision_msgs/Pose2D",
        include_str!("../msg/vision_msgs/Pose2D.msg"),
    ),
    (
        "visualization_msgs/Marker",
        include_str!("../msg/visualization_msgs/Marker.msg"),
    ),
    (
        "visualization_msgs/MarkerArray",
        include_str!("../msg/visualization_msgs/MarkerArray.msg"),
    ),
    (
        "visualization_msgs/MeshFile",
        include_str!("../msg/visualization_msgs/MeshFile.msg"),
    ),
    (
        "visualization_msgs/UVCoordinate",
        include_str!("../msg/visualization_msgs/UVCoordinate.msg"),
    ),
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
                "roadwatch_msgs/Object",
                "builtin_interfaces/Time",
                "geometry_msgs/Point",
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
