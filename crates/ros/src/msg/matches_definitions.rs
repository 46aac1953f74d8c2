//! The Rust types are what the `.msg` files say: names, order, types, counts.

use super::{
    autoware_perception_msgs::{DetectedObjects, TrackedObjects},
    diagnostic_msgs::DiagnosticArray,
    lifecycle_msgs::TransitionEvent,
    nav_msgs::Odometry,
    roadwatch_msgs::ObjectArray,
    rosgraph_msgs::Clock,
    sensor_msgs::CameraInfo,
    sensor_msgs::{CompressedImage, Image},
    tf2_msgs::TFMessage,
    vision_msgs::{Detection2DArray, Detection3DArray},
    visualization_msgs::MarkerArray,
};
use crate::{
    definitions::{self, Count, Field},
    topics::TopicKind,
};
use serde_reflection::{ContainerFormat, Format, Named, Registry, Tracer, TracerConfig};

/// What serde sees of every type published, and of every type inside.
fn traced() -> Registry {
    let mut tracer = Tracer::new(TracerConfig::default());
    tracer.trace_simple_type::<ObjectArray>().expect("objects");
    tracer
        .trace_simple_type::<Detection2DArray>()
        .expect("detections in 2D");
    tracer
        .trace_simple_type::<Detection3DArray>()
        .expect("detections in 3D");
    tracer.trace_simple_type::<MarkerArray>().expect("markers");
    tracer
        .trace_simple_type::<CameraInfo>()
        .expect("camera info");
    tracer.trace_simple_type::<TFMessage>().expect("transforms");
    tracer.trace_simple_type::<Image>().expect("image");
    tracer
        .trace_simple_type::<CompressedImage>()
        .expect("image");
    tracer
        .trace_simple_type::<DetectedObjects>()
        .expect("Autoware's objects");
    tracer
        .trace_simple_type::<TrackedObjects>()
        .expect("Autoware's tracks");
    tracer.trace_simple_type::<Odometry>().expect("odometry");
    tracer.trace_simple_type::<Clock>().expect("clock");
    tracer
        .trace_simple_type::<DiagnosticArray>()
        .expect("diagnostics");
    tracer
        .trace_simple_type::<TransitionEvent>()
        .expect("transition");
    tracer.registry().expect("complete")
}

/// Compares the Rust struct of that name with its definition, and those it uses with theirs.
/// `definition` gives the text of `package/Type`. The error says where they differ.
fn compare(
    rust: &Registry,
    ros_type: &str,
    definition: &dyn Fn(&str) -> Option<String>,
) -> Result<(), String> {
    let short = ros_type.rsplit('/').next().unwrap_or_default();
    let Some(ContainerFormat::Struct(members)) = rust.get(short) else {
        return Err(format!("{ros_type}: no Rust struct"));
    };
    let text = definition(ros_type).ok_or_else(|| format!("{ros_type}: no definition"))?;
    let expected = definitions::fields(&text);
    for (member, field) in members.iter().zip(&expected) {
        compare_field(member, field).map_err(|what| format!("{ros_type}: {what}"))?;
        if field.is_message() {
            compare(rust, &field.base, definition)?;
        }
    }
    if members.len() != expected.len() {
        return Err(format!(
            "{ros_type}: {} fields, not {}",
            members.len(),
            expected.len()
        ));
    }
    Ok(())
}

fn compare_field(member: &Named<Format>, field: &Field) -> Result<(), String> {
    let found = as_ros(&member.value);
    if member.name == field.name && found == Some((ros_name(field), field.count)) {
        return Ok(());
    }
    Err(format!(
        "`{}` is {found:?}, the definition has {field:?}",
        member.name
    ))
}

/// A definition's type without its package, which serde does not see.
fn ros_name(field: &Field) -> String {
    match field.base.as_str() {
        // The same eight bits.
        "byte" => "uint8".to_owned(),
        name => name.rsplit('/').next().unwrap_or_default().to_owned(),
    }
}

/// ROS's name and count of what serde sees; nested fixed arrays count as one flat array.
fn as_ros(format: &Format) -> Option<(String, Count)> {
    let one = |name: &str| Some((name.to_owned(), Count::One));
    match format {
        Format::Bool => one("bool"),
        Format::U8 => one("uint8"),
        Format::I32 => one("int32"),
        Format::U32 => one("uint32"),
        Format::U64 => one("uint64"),
        Format::F32 => one("float32"),
        Format::F64 => one("float64"),
        Format::Str => one("string"),
        Format::TypeName(name) => one(name),
        Format::Bytes => Some(("uint8".to_owned(), Count::Any)),
        Format::Seq(inner) => match as_ros(inner)? {
            (name, Count::One) => Some((name, Count::Any)),
            _ => None,
        },
        Format::TupleArray { content, size } => match as_ros(content)? {
            (name, Count::One) => Some((name, Count::Fixed(*size))),
            (name, Count::Fixed(inner)) => Some((name, Count::Fixed(inner * size))),
            (_, Count::UpTo(_) | Count::Any) => None,
        },
        _ => None,
    }
}

fn embedded(ros_type: &str) -> Option<String> {
    definitions::definition(ros_type).map(str::to_owned)
}

#[test]
fn every_published_type_is_what_its_definition_says() {
    let rust = traced();
    let others = [
        "sensor_msgs/Image",
        "rosgraph_msgs/Clock",
        "diagnostic_msgs/DiagnosticArray",
        "lifecycle_msgs/TransitionEvent",
        "nav_msgs/Odometry",
    ];
    let published = TopicKind::ALL.map(TopicKind::ros_type);
    for ros_type in published.into_iter().chain(others) {
        assert_eq!(compare(&rust, ros_type, &embedded), Ok(()));
    }
}

#[test]
fn a_renamed_reordered_retyped_added_or_removed_field_is_found() {
    let rust = traced();
    let changes = [
        ("float64 depth_m", "float64 depth"),
        ("float64 depth_m", "float32 depth_m"),
        ("float64 yaw_rad", "float64 yaw_rad\nfloat64 pitch_rad"),
        (
            "float64[9] position_covariance",
            "float64[6] position_covariance",
        ),
        (
            "float64[9] position_covariance",
            "float64[] position_covariance",
        ),
        ("float64 depth_m", "# gone"),
        ("string[] seen_by", "# gone"),
        ("bool held", "bool heading_known"),
        ("geometry_msgs/Vector3 size", "geometry_msgs/Point size"),
        ("uint64 track_id", "string class_id"),
    ];
    for (from, to) in changes {
        let changed = |ros_type: &str| {
            let text = embedded(ros_type)?;
            let is_target = ros_type == "roadwatch_msgs/Object";
            Some(if is_target {
                text.replacen(from, to, 1)
            } else {
                text
            })
        };
        let verdict = compare(&rust, "roadwatch_msgs/ObjectArray", &changed);
        assert!(verdict.is_err(), "{from} -> {to}");
    }
}

#[test]
fn a_change_deep_inside_is_found() {
    let swapped = |ros_type: &str| {
        if ros_type == "builtin_interfaces/Time" {
            return Some("uint32 nanosec\nint32 sec\n".to_owned());
        }
        embedded(ros_type)
    };
    let verdict = compare(&traced(), "visualization_msgs/MarkerArray", &swapped);
    assert!(verdict.is_err_and(|what| what.starts_with("builtin_interfaces/Time")));
}
