//! `visualization_msgs/MarkerArray`: box, heading, label and trail of each object.

use super::{
    pose::{UncertainPose, extents},
    seen::{Seen, SeenTogether},
};
use crate::msg::{
    builtin_interfaces::Duration,
    geometry_msgs::{Pose, Vector3},
    std_msgs::{ColorRGBA, Header},
    visualization_msgs::{Marker, MarkerArray},
};
use roadwatch_core::{Phase, Timestamp};

/// How long a shape outlives the last message: longer than the slowest camera's interval, short enough
/// that a viewer does not go on showing objects of a node that is gone.
pub const MARKER_LIFETIME: Duration = Duration { sec: 1, nanosec: 0 };

/// Height of a label's capital letters, metres.
const LABEL_HEIGHT_M: f64 = 0.6;
/// Gap between the top of a box and its label, metres.
const LABEL_GAP_M: f64 = 0.5;
/// Thickness of an arrow's shaft, metres.
const ARROW_THICKNESS_M: f64 = 0.2;
/// Width of a trail, metres.
const TRAIL_WIDTH_M: f64 = 0.15;
/// Opacity of a trail.
const TRAIL_OPACITY: f32 = 0.8;
/// Opacity of a box measured in this frame.
const FRESH_OPACITY: f32 = 0.6;
/// Opacity of a box that is predicted, or kept from an earlier frame.
const PREDICTED_OPACITY: f32 = 0.25;

/// First a marker that clears the topic, then the shapes of each object.
///
/// A shape is called `<camera>/<shape>` and the number of its track, so that it keeps its name while
/// the track lives, and cameras that count their tracks alike do not overwrite each other's shapes.
pub(crate) fn markers(seen: &SeenTogether) -> MarkerArray {
    let clear = clear(seen.header());
    let shapes = seen.objects.iter().flat_map(|one| shapes(seen, one));
    MarkerArray {
        markers: std::iter::once(clear).chain(shapes).collect(),
    }
}

/// Only the marker that clears the topic.
pub(crate) fn none(base_frame: &str, stamp: Timestamp) -> MarkerArray {
    MarkerArray {
        markers: vec![clear(Header::new(stamp, base_frame))],
    }
}

fn clear(header: Header) -> Marker {
    Marker {
        header,
        action: Marker::DELETE_ALL,
        ..Marker::default()
    }
}

fn shapes(together: &SeenTogether, seen: &Seen) -> Vec<Marker> {
    let mut shapes = vec![cube(together, seen)];
    if seen.placed.heading.is_some() {
        shapes.push(arrow(together, seen));
    }
    if seen.trail.len() > 1 {
        shapes.push(trail(together, seen));
    }
    shapes.push(label(together, seen));
    shapes
}

fn cube(together: &SeenTogether, seen: &Seen) -> Marker {
    let opacity = if seen.is_predicted() {
        PREDICTED_OPACITY
    } else {
        FRESH_OPACITY
    };
    Marker {
        kind: Marker::CUBE,
        pose: pose_of(seen),
        scale: extents(seen.track.size()),
        color: color_of(seen, opacity),
        ..shape(together, seen, "box")
    }
}

fn arrow(together: &SeenTogether, seen: &Seen) -> Marker {
    Marker {
        kind: Marker::ARROW,
        pose: pose_of(seen),
        // From the middle of the box to as far again beyond its nose.
        scale: Vector3 {
            x: seen.track.size().length_m,
            y: ARROW_THICKNESS_M,
            z: ARROW_THICKNESS_M,
        },
        color: color_of(seen, 1.0),
        ..shape(together, seen, "heading")
    }
}

/// A line through the places where it was.
fn trail(together: &SeenTogether, seen: &Seen) -> Marker {
    Marker {
        kind: Marker::LINE_STRIP,
        scale: Vector3 {
            x: TRAIL_WIDTH_M,
            ..Vector3::default()
        },
        color: color_of(seen, TRAIL_OPACITY),
        points: seen.trail.iter().map(|&point| point.into()).collect(),
        ..shape(together, seen, "trail")
    }
}

fn label(together: &SeenTogether, seen: &Seen) -> Marker {
    let mut pose = Pose {
        position: seen.placed.position.into(),
        ..Pose::default()
    };
    pose.position.z += seen.track.size().height_m / 2.0 + LABEL_GAP_M;
    let (_, range_m) = seen.depth_range_m;
    let moving = seen
        .track
        .motion
        .as_ref()
        .filter(|m| m.phase != Phase::Tentative);
    let speed = moving.map_or_else(String::new, |motion| {
        format!(" {:.1} m/s", motion.speed_m_s())
    });
    Marker {
        kind: Marker::TEXT_VIEW_FACING,
        pose,
        scale: Vector3 {
            z: LABEL_HEIGHT_M,
            ..Vector3::default()
        },
        color: WHITE,
        text: format!(
            "{} {} {range_m:.1} m{speed}",
            seen.track.class(),
            seen.track.id.0
        ),
        ..shape(together, seen, "label")
    }
}

fn shape(together: &SeenTogether, seen: &Seen, name: &str) -> Marker {
    // The identity of a tracked object is its own, whoever sees it; others are numbered camera by camera.
    let camera = match seen.track.motion {
        Some(_) => together.camera,
        None => seen.seen_by.first().copied().unwrap_or_default(),
    };
    let owner = if camera.is_empty() { "scene" } else { camera };
    Marker {
        header: together.header_of(seen),
        ns: format!("{owner}/{name}"),
        id: marker_id(seen.track.id.0),
        action: Marker::ADD,
        lifetime: MARKER_LIFETIME,
        ..Marker::default()
    }
}

/// The track's number within the 31 bits a marker has; two billion tracks pass before one repeats.
fn marker_id(track_id: u64) -> i32 {
    (track_id & u64::from(i32::MAX as u32)) as i32
}

fn pose_of(seen: &Seen) -> Pose {
    (&UncertainPose::of(&seen.placed).isometry).into()
}

const WHITE: ColorRGBA = rgba(1.0, 1.0, 1.0, 1.0);

const fn rgba(r: f32, g: f32, b: f32, a: f32) -> ColorRGBA {
    ColorRGBA { r, g, b, a }
}

/// The palette of Okabe and Ito (2008), whose colours the colour-blind can tell apart, without black.
const PALETTE: [(f32, f32, f32); 7] = [
    (0.0, 0.45, 0.7),
    (0.9, 0.6, 0.0),
    (0.0, 0.62, 0.45),
    (0.8, 0.47, 0.65),
    (0.34, 0.71, 0.91),
    (0.84, 0.37, 0.0),
    (0.94, 0.89, 0.26),
];

/// A colour per identity.
fn color_of(seen: &Seen, opacity: f32) -> ColorRGBA {
    let (r, g, b) = PALETTE[(seen.track.id.0 % PALETTE.len() as u64) as usize];
    rgba(r, g, b, opacity)
}
