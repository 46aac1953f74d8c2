//! `rig.toml`: which cameras the rig has, how they see and where they sit.

use super::{
    error::{DatasetError, RigProblem},
    read_text,
};
use nalgebra::{Isometry3, Quaternion, Translation3, UnitQuaternion};
use roadwatch_core::{
    CameraModel, CameraName, Distortion, ImageSize, Intrinsics, RigCamera,
    distortion::UnknownDistortion, space::Transform,
};
use serde::Deserialize;
use std::path::Path;
use toml::Spanned;

/// More columns or rows than any camera sensor has; larger numbers are typing mistakes and would exhaust memory.
const MAX_SIDE_PX: u32 = 16_384;
/// Rounding each component to three decimals moves the length by less than this.
const UNIT_TOLERANCE: f64 = 1e-3;
/// A [`roadwatch_core::CameraId`] counts no further.
const MAX_CAMERAS: usize = 255;

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct RigFile {
    #[serde(default)]
    camera: Vec<Spanned<Camera>>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Camera {
    name: Spanned<String>,
    width: u32,
    height: u32,
    fx: f64,
    fy: f64,
    cx: f64,
    cy: f64,
    position_m: [f64; 3],
    orientation_wxyz: Spanned<[f64; 4]>,
    #[serde(default)]
    distortion_model: String,
    #[serde(default)]
    distortion: Vec<f64>,
}

/// The cameras of a `rig.toml`, in its order; at least one, names legal and unique, orientations unit length.
///
/// # Errors
/// When the file cannot be read or has a mistake; the first is reported, with its line.
pub fn read_rig_file(file: &Path) -> Result<Vec<RigCamera>, DatasetError> {
    let text = read_text(file)?;
    parse(&text).map_err(|(offset, problem)| DatasetError::Rig {
        file: file.to_owned(),
        line: line_at(&text, offset),
        problem,
    })
}

/// A problem and the byte of the file where it is.
type Misplaced = (usize, RigProblem);

fn parse(text: &str) -> Result<Vec<RigCamera>, Misplaced> {
    let rig: RigFile = toml::from_str(text).map_err(|error| {
        let offset = error.span().map_or(0, |span| span.start);
        (offset, RigProblem::Toml(error.message().to_owned()))
    })?;
    if rig.camera.is_empty() || rig.camera.len() > MAX_CAMERAS {
        return Err((0, RigProblem::CameraCount(rig.camera.len())));
    }
    let mut cameras: Vec<RigCamera> = Vec::with_capacity(rig.camera.len());
    for section in rig.camera {
        let offset = section.span().start;
        let name_offset = section.get_ref().name.span().start;
        let camera = check_camera(section.into_inner(), offset)?;
        if cameras.iter().any(|other| other.name == camera.name) {
            return Err((name_offset, RigProblem::SameName(camera.name)));
        }
        cameras.push(camera);
    }
    Ok(cameras)
}

fn check_camera(camera: Camera, offset: usize) -> Result<RigCamera, Misplaced> {
    let name = CameraName::new(camera.name.get_ref())
        .map_err(|error| (camera.name.span().start, RigProblem::Name(error)))?;
    let here = |problem| (offset, problem);
    let size = check_size(&name, camera.width, camera.height).map_err(here)?;
    check_numbers(&name, &camera).map_err(here)?;
    let distortion = check_distortion(&camera).map_err(|cause| {
        here(RigProblem::Distortion {
            camera: name.clone(),
            cause,
        })
    })?;
    let rotation = unit_quaternion(*camera.orientation_wxyz.get_ref()).map_err(|length| {
        let problem = RigProblem::Orientation {
            camera: name.clone(),
            length,
        };
        (camera.orientation_wxyz.span().start, problem)
    })?;
    Ok(RigCamera {
        name,
        model: CameraModel {
            size,
            intrinsics: Intrinsics {
                fx: camera.fx,
                fy: camera.fy,
                cx: camera.cx,
                cy: camera.cy,
            },
            distortion,
        },
        base_from_optical: Transform::new(Isometry3::from_parts(
            Translation3::from(camera.position_m),
            rotation,
        )),
        measured_focal: None,
    })
}

fn check_size(camera: &CameraName, width: u32, height: u32) -> Result<ImageSize, RigProblem> {
    let possible = 1..=MAX_SIDE_PX;
    if possible.contains(&width) && possible.contains(&height) {
        return Ok(ImageSize {
            width_px: width,
            height_px: height,
        });
    }
    Err(RigProblem::Size {
        camera: camera.clone(),
        width,
        height,
        max: MAX_SIDE_PX,
    })
}

fn check_numbers(name: &CameraName, camera: &Camera) -> Result<(), RigProblem> {
    let wrong = |key, value, expected| RigProblem::Number {
        camera: name.clone(),
        key,
        value,
        expected,
    };
    for (key, value) in [("fx", camera.fx), ("fy", camera.fy)] {
        if !(value.is_finite() && value > 0.0) {
            return Err(wrong(key, value, "a focal length above 0, in pixels"));
        }
    }
    let [x, y, z] = camera.position_m.map(|value| ("position_m", value));
    let coefficients = camera.distortion.iter().map(|&value| ("distortion", value));
    let finite = [("cx", camera.cx), ("cy", camera.cy), x, y, z];
    match finite
        .into_iter()
        .chain(coefficients)
        .find(|(_, value)| !value.is_finite())
    {
        Some((key, value)) => Err(wrong(key, value, "a finite number")),
        None => Ok(()),
    }
}

/// Coefficients without a model are refused here: [`Distortion::from_ros`] would not look at them.
fn check_distortion(camera: &Camera) -> Result<Distortion, UnknownDistortion> {
    let model = camera.distortion_model.as_str();
    if matches!(model, "" | "none") && !camera.distortion.is_empty() {
        return Err(UnknownDistortion {
            model: model.to_owned(),
            count: camera.distortion.len(),
        });
    }
    Distortion::from_ros(model, &camera.distortion)
}

/// The rotation of a quaternion in w x y z order.
///
/// # Errors
/// Its length, when that is not 1 within 0.001 (or not a number).
pub(super) fn unit_quaternion([w, x, y, z]: [f64; 4]) -> Result<UnitQuaternion<f64>, f64> {
    let quaternion = Quaternion::new(w, x, y, z);
    let length = quaternion.norm();
    if (length - 1.0).abs() <= UNIT_TOLERANCE {
        Ok(UnitQuaternion::from_quaternion(quaternion))
    } else {
        Err(length)
    }
}

fn line_at(text: &str, offset: usize) -> usize {
    let before = &text.as_bytes()[..offset.min(text.len())];
    before.iter().filter(|&&byte| byte == b'\n').count() + 1
}

#[cfg(test)]
mod tests {
    use super::*;

    const CAMERA: &str = r#"
[[camera]]
name = "front"
width = 960
height = 540
fx = 985.0
fy = 985
cx = 485.0
cy = 241.6
position_m = [0.8472, -0.0008, 2.1771]
orientation_wxyz = [0.497176, -0.504950, 0.493357, -0.504421]
"#;

    /// The file with one line replaced, and what a user reads about it.
    fn complaint(line: &str, replacement: &str) -> String {
        let text = CAMERA.replace(line, replacement);
        let (offset, problem) = parse(&text).expect_err(replacement);
        format!("{}: {problem}", line_at(&text, offset))
    }

    #[test]
    fn a_camera_is_where_and_what_the_file_says() {
        let cameras = parse(CAMERA).expect("a rig");
        let [camera] = cameras.as_slice() else {
            panic!("{cameras:?}");
        };
        assert_eq!(camera.model.distortion, Distortion::None);
        let ahead = camera.base_from_optical.rotate(nalgebra::Vector3::z());
        assert!(ahead.x > 0.99, "{ahead}");
        assert!((camera.base_from_optical.origin().z() - 2.1771).abs() < 1e-12);
    }

    #[test]
    fn a_lens_may_be_given() {
        let lens =
            "cy = 241.6\ndistortion_model = \"plumb_bob\"\ndistortion = [0.1, 0.0, 0, 0.0, 0.0]";
        let cameras = parse(&CAMERA.replace("cy = 241.6", lens)).expect("a rig");
        assert!(matches!(
            cameras[0].model.distortion,
            Distortion::BrownConrady(_)
        ));
    }

    #[test]
    fn each_mistake_is_said_with_its_line() {
        for (line, replacement, expected) in [
            ("fx = 985.0", "focal = 985.0", "6: unknown field `focal`"),
            (
                "fx = 985.0",
                "fx = \"wide\"",
                "6: invalid type: string \"wide\", expected f64",
            ),
            ("fx = 985.0", "fx = ", "6: "),
            (
                "fx = 985.0",
                "fx = -1",
                "2: camera `front`: fx is -1: expected a focal length",
            ),
            (
                "cx = 485.0",
                "cx = nan",
                "2: camera `front`: cx is NaN: expected a finite number",
            ),
            ("cx = 485.0", "", "2: missing field `cx`"),
            (
                "width = 960",
                "width = 0",
                "2: camera `front`: an image of 0x540 pixels",
            ),
            (
                "\"front\"",
                "\"front left\"",
                "3: `front left` cannot name a camera",
            ),
            (
                "0.497176",
                "0.9",
                "11: camera `front`: orientation_wxyz has length 1.2",
            ),
            (
                "0.497176",
                "nan",
                "11: camera `front`: orientation_wxyz has length NaN",
            ),
            (
                "cx = 485.0",
                "cx = 485.0\ndistortion = [0.1]",
                "2: camera `front`: distortion model ``",
            ),
            (
                "-0.504421]",
                "-0.504421]\ndistortion_model = \"barrel\"",
                "2: camera `front`: distortion model `barrel`",
            ),
        ] {
            let complaint = complaint(line, replacement);
            assert!(complaint.starts_with(expected), "{complaint}");
        }
    }

    #[test]
    fn two_cameras_of_one_name_are_refused_at_the_second() {
        let text = CAMERA.repeat(2);
        let (offset, problem) = parse(&text).expect_err("twice");
        assert!(matches!(problem, RigProblem::SameName(_)));
        assert_eq!(line_at(&text, offset), 14);
    }

    #[test]
    fn a_rig_without_cameras_is_refused() {
        let (_, problem) = parse("").expect_err("empty");
        assert!(problem.to_string().contains("[[camera]]"), "{problem}");
    }
}
