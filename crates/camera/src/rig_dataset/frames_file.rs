//! `frames.jsonl`: when each camera captured each frame, and where the vehicle was.

use super::{
    DatasetFrame,
    error::{DatasetError, FramesProblem},
    rig_file::unit_quaternion,
};
use nalgebra::{Isometry3, Translation3};
use roadwatch_core::{RigCamera, Timestamp};
use serde::Deserialize;
use serde_json::value::RawValue;
use std::{collections::BTreeMap, path::Path};

/// Stamps stay text, because a number read as `f64` loses nanoseconds. Keys that are not listed are other
/// programs' business.
#[derive(Deserialize)]
struct Line {
    frame: u64,
    stamp: BTreeMap<String, Box<RawValue>>,
    ego_stamp: Option<Box<RawValue>>,
    ego_position_world_m: Option<[f64; 3]>,
    ego_orientation_world_wxyz: Option<[f64; 4]>,
}

/// The frames of the file's `text`; at least one, numbers and each camera's stamps rising. Blank lines are skipped.
pub(super) fn parse(
    text: &str,
    file: &Path,
    cameras: &[RigCamera],
) -> Result<Vec<DatasetFrame>, DatasetError> {
    let wrong = |line, problem| DatasetError::Frames {
        file: file.to_owned(),
        line,
        problem,
    };
    let mut order = Order::new(cameras);
    let mut frames = Vec::new();
    for (line, json) in (1..).zip(text.lines()) {
        if json.trim().is_empty() {
            continue;
        }
        let frame = parse_line(json, cameras).map_err(|problem| wrong(line, problem))?;
        order
            .check(&frame)
            .map_err(|problem| wrong(line, problem))?;
        frames.push(frame);
    }
    if frames.is_empty() {
        return Err(wrong(1, FramesProblem::Empty));
    }
    Ok(frames)
}

fn parse_line(json: &str, cameras: &[RigCamera]) -> Result<DatasetFrame, FramesProblem> {
    let line: Line = serde_json::from_str(json).map_err(|error| FramesProblem::Json {
        column: error.column(),
        message: without_position(&error),
    })?;
    let mut stamps = vec![None; cameras.len()];
    for (camera, digits) in line.stamp {
        let index = find(&camera, cameras)?;
        let stamp = digits.get().parse();
        stamps[index] = Some(stamp.map_err(|cause| FramesProblem::Stamp { camera, cause })?);
    }
    let ego_at = match line.ego_stamp {
        Some(digits) => digits.get().parse().map_err(FramesProblem::EgoStamp)?,
        None => middle(&stamps),
    };
    Ok(DatasetFrame {
        number: line.frame,
        stamps,
        ego_at,
        world_from_base: pose(line.ego_position_world_m, line.ego_orientation_world_wxyz)?,
    })
}

/// Half way between the first and the last of a frame's captures.
fn middle(stamps: &[Option<Timestamp>]) -> Timestamp {
    let captured = || stamps.iter().flatten().copied();
    let first = captured().min().unwrap_or_default();
    let span = captured().max().unwrap_or_default().saturating_since(first);
    first.saturating_add(span / 2)
}

fn find(name: &str, cameras: &[RigCamera]) -> Result<usize, FramesProblem> {
    let found = cameras
        .iter()
        .position(|camera| camera.name.as_str() == name);
    found.ok_or_else(|| {
        let known: Vec<_> = cameras.iter().map(|camera| camera.name.as_str()).collect();
        FramesProblem::UnknownCamera {
            camera: name.to_owned(),
            known: known.join(", "),
        }
    })
}

fn pose(
    position_m: Option<[f64; 3]>,
    orientation_wxyz: Option<[f64; 4]>,
) -> Result<Option<Isometry3<f64>>, FramesProblem> {
    match (position_m, orientation_wxyz) {
        (None, None) => Ok(None),
        (Some(position_m), Some(wxyz)) => {
            let rotation =
                unit_quaternion(wxyz).map_err(|length| FramesProblem::Orientation { length })?;
            let translation = Translation3::from(position_m);
            Ok(Some(Isometry3::from_parts(translation, rotation)))
        }
        _ => Err(FramesProblem::HalfPose),
    }
}

/// The parser counts lines within one line; only its message is of use.
fn without_position(error: &serde_json::Error) -> String {
    let message = error.to_string();
    match message.rsplit_once(" at line ") {
        Some((what, _)) => what.to_owned(),
        None => message,
    }
}

/// What the lines so far demand of the next.
struct Order<'a> {
    cameras: &'a [RigCamera],
    number: Option<u64>,
    stamps: Vec<Option<Timestamp>>,
}

impl<'a> Order<'a> {
    fn new(cameras: &'a [RigCamera]) -> Self {
        Self {
            cameras,
            number: None,
            stamps: vec![None; cameras.len()],
        }
    }

    fn check(&mut self, frame: &DatasetFrame) -> Result<(), FramesProblem> {
        let number = frame.number;
        if let Some(previous) = self.number.replace(number).filter(|&last| last >= number) {
            return Err(FramesProblem::NumberFalls { number, previous });
        }
        for (index, camera) in self.cameras.iter().enumerate() {
            let Some(stamp) = frame.stamps[index] else {
                continue;
            };
            let last = self.stamps[index].replace(stamp);
            if let Some(previous) = last.filter(|&last| last >= stamp) {
                return Err(FramesProblem::StampFalls {
                    camera: camera.name.clone(),
                    stamp,
                    previous,
                });
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::UnitQuaternion;
    use roadwatch_core::{
        CameraModel, CameraName, Distortion, ImageSize, Intrinsics, space::Transform,
    };

    fn camera(name: &str) -> RigCamera {
        RigCamera {
            name: CameraName::new(name).expect("a name"),
            model: CameraModel {
                size: ImageSize {
                    width_px: 64,
                    height_px: 48,
                },
                intrinsics: Intrinsics {
                    fx: 50.0,
                    fy: 50.0,
                    cx: 31.5,
                    cy: 23.5,
                },
                distortion: Distortion::None,
            },
            base_from_optical: Transform::new(Isometry3::identity()),
            measured_focal: None,
        }
    }

    fn parsed(text: &str) -> Result<Vec<DatasetFrame>, String> {
        let cameras = [camera("front"), camera("back")];
        parse(text, Path::new("frames.jsonl"), &cameras).map_err(|error| error.to_string())
    }

    #[test]
    fn stamps_keep_every_digit_and_missing_ones_stay_missing() {
        let text = [
            r#"{"frame": 0, "stamp": {"back": 1557539956.400135, "front": 1557539956.439383}}"#,
            "",
            r#"{"frame": 7, "stamp": {"front": 1557539956.539383123456}, "note": "x",
                "ego_position_world_m": [1, 2.5, 0.0], "ego_orientation_world_wxyz": [1.0, 0, 0, 0]}"#,
        ];
        let text = text.map(|line| line.replace('\n', " ")).join("\n");
        let frames = parsed(&text).expect("frames");
        let nanos = |stamp: Option<Timestamp>| stamp.map(Timestamp::as_nanos);
        assert_eq!(nanos(frames[0].stamps[0]), Some(1_557_539_956_439_383_000));
        assert_eq!(nanos(frames[0].stamps[1]), Some(1_557_539_956_400_135_000));
        assert_eq!(nanos(frames[1].stamps[0]), Some(1_557_539_956_539_383_123));
        assert_eq!(frames[1].stamps[1], None);
        assert_eq!((frames[1].number, frames[0].world_from_base), (7, None));
        let pose =
            Isometry3::from_parts(Translation3::new(1.0, 2.5, 0.0), UnitQuaternion::identity());
        assert_eq!(frames[1].world_from_base, Some(pose));
    }

    #[test]
    fn each_mistake_is_said_with_its_line() {
        let first = r#"{"frame": 1, "stamp": {"front": 10.5}}"#;
        for (second, expected) in [
            ("{\"frame\": 2,", "column 12: EOF while parsing"),
            (r#"{"frame": 2}"#, "column 12: missing field `stamp`"),
            (
                r#"{"frame": 1, "stamp": {}}"#,
                "frame 1 comes after frame 1",
            ),
            (
                r#"{"frame": 2, "stamp": {"side": 11}}"#,
                "camera `side` is not in rig.toml: it has front, back",
            ),
            (
                r#"{"frame": 2, "stamp": {"front": 10.5}}"#,
                "camera `front`: the stamp 10.500000000 is not later",
            ),
            (
                r#"{"frame": 2, "stamp": {"front": 9}}"#,
                "camera `front`: the stamp 9.000000000 is not later",
            ),
            (
                r#"{"frame": 2, "stamp": {"front": 1.1e9}}"#,
                "camera `front`: `1.1e9` is not a stamp",
            ),
            (
                r#"{"frame": 2, "stamp": {"front": null}}"#,
                "camera `front`: `null` is not a stamp",
            ),
            (
                r#"{"frame": 2, "stamp": {}, "ego_position_world_m": [0, 0, 0]}"#,
                "an ego pose needs both",
            ),
            (
                r#"{"frame": 2, "stamp": {}, "ego_position_world_m": [0, 0, 0], "ego_orientation_world_wxyz": [1, 1, 0, 0]}"#,
                "ego_orientation_world_wxyz has length 1.4142",
            ),
        ] {
            let error = parsed(&format!("{first}\n{second}\n")).expect_err(second);
            assert!(
                error.starts_with(&format!("frames.jsonl:2: {expected}")),
                "{error}"
            );
        }
    }

    #[test]
    fn a_file_without_frames_is_refused() {
        assert!(parsed("\n").expect_err("empty").contains("no frame"));
    }
}
