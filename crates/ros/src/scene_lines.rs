//! The scene as JSON lines: the messages that ROS 2 gets, key by key. `docs/scene-stream.md` is for readers.

use crate::msg::{geometry_msgs::Transform, roadwatch_msgs::ObjectArray, sensor_msgs::CameraInfo};
use serde::Serialize;

/// What the first line says it is.
pub const SCHEMA: &str = "roadwatch_scene";
/// Rises when a key goes away or changes its meaning.
pub const VERSION: u32 = 1;

/// The rig as the first line has it.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct LineRig {
    /// The vehicle's frame. Positions of scenes whose header names another are in odom.
    pub base_frame: String,
    /// Every camera.
    pub cameras: Vec<LineCamera>,
}

/// A camera as the first line has it.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct LineCamera {
    /// Its name.
    pub name: String,
    /// Takes points of its optical frame to base_link.
    pub base_from_optical: Transform,
    /// Its calibration.
    pub camera_info: CameraInfo,
}

#[derive(Serialize)]
#[serde(tag = "type", rename_all = "snake_case")]
enum Line<'a> {
    Rig {
        schema: &'static str,
        version: u32,
        #[serde(flatten)]
        rig: &'a LineRig,
    },
    Scene {
        seq: u64,
        scene: &'a ObjectArray,
    },
}

/// The first line, with its line feed.
#[must_use]
pub fn rig_line(rig: &LineRig) -> String {
    line(&Line::Rig {
        schema: SCHEMA,
        version: VERSION,
        rig,
    })
}

/// The line of one scene, with its line feed.
#[must_use]
pub fn scene_line(seq: u64, scene: &ObjectArray) -> String {
    line(&Line::Scene { seq, scene })
}

fn line(line: &Line<'_>) -> String {
    let mut text = serde_json::to_string(line).expect("messages are plain data");
    text.push('\n');
    text
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::msg::{
        geometry_msgs::Point,
        roadwatch_msgs::{KeyComponent, Object},
    };
    use serde_json::{Value, json};

    fn parsed(line: &str) -> Value {
        assert_eq!(line.matches('\n').count(), 1, "one line");
        assert!(line.ends_with('\n'));
        serde_json::from_str(line).expect("JSON")
    }

    #[test]
    fn the_first_line_says_what_it_is_and_where_the_cameras_are() {
        let camera = LineCamera {
            name: "front".to_owned(),
            ..LineCamera::default()
        };
        let rig = LineRig {
            base_frame: "base_link".to_owned(),
            cameras: vec![camera],
        };
        let line = parsed(&rig_line(&rig));
        assert_eq!(line["base_frame"], "base_link");
        assert_eq!(line["type"], "rig");
        assert_eq!(line["schema"], "roadwatch_scene");
        assert_eq!(line["version"], 1);
        assert_eq!(line["cameras"][0]["name"], "front");
        assert_eq!(line["cameras"][0]["camera_info"]["k"][8], 0.0);
        assert_eq!(
            line["cameras"][0]["base_from_optical"]["rotation"]["w"],
            1.0
        );
    }

    #[test]
    fn a_scene_is_the_message_and_reads_back_as_it() {
        let object = Object {
            track_id: 7,
            score: 0.46,
            position: Point {
                x: 12.345_678_901,
                y: -3.0,
                z: 0.8,
            },
            components: vec![KeyComponent {
                name: "plate_rear".to_owned(),
                x_px: 1.0 / 3.0,
                y_px: 2.0,
                score: 0.9,
            }],
            ..Object::default()
        };
        let scene = ObjectArray {
            ego_motion: "none".to_owned(),
            objects: vec![object],
            ..ObjectArray::default()
        };
        let line = parsed(&scene_line(41, &scene));
        assert_eq!(line["type"], "scene");
        assert_eq!(line["seq"], 41);
        assert_eq!(
            line["scene"]["ego_pose"]["position"],
            json!({"x": 0.0, "y": 0.0, "z": 0.0})
        );
        let back: ObjectArray = serde_json::from_value(line["scene"].clone()).expect("the message");
        assert_eq!(back, scene, "every number holds, those of 32 bits too");
    }
}
