//! Writing a rig dataset, frame by frame: whatever happens, what is listed in `frames.jsonl` is whole.

use super::{FRAMES_FILE, RIG_FILE};
use nalgebra::Isometry3;
use roadwatch_core::{RigCamera, Timestamp};
use serde::Serialize;
use std::{
    fmt::Write as _,
    fs::{self, File, OpenOptions},
    io::{self, Write as _},
    path::{Path, PathBuf},
};

/// One moment of a rig, to be written.
#[derive(Debug)]
pub struct NewFrame {
    /// Of each camera, in the rig's order, when it captured and its JPEG file's bytes; `None` where it has no image.
    pub images: Vec<Option<(Timestamp, Vec<u8>)>>,
    /// Where base_link was in the world, and when; `None` where nobody knows.
    pub ego: Option<(Timestamp, Isometry3<f64>)>,
}

/// A rig dataset in the making.
#[derive(Debug)]
pub struct DatasetWriter {
    folder: PathBuf,
    names: Vec<String>,
    frames: File,
    next: u64,
    bytes: u64,
}

impl DatasetWriter {
    /// Begins a dataset of these cameras in `folder`, which must be empty or not exist.
    ///
    /// # Errors
    /// When the folder holds something, or cannot be written to.
    pub fn create(folder: &Path, cameras: &[RigCamera]) -> io::Result<Self> {
        fs::create_dir_all(folder)?;
        if fs::read_dir(folder)?.next().is_some() {
            let what = "the folder is not empty: a dataset begins in an empty one";
            return Err(io::Error::new(io::ErrorKind::AlreadyExists, what));
        }
        let rig = rig_file(cameras);
        fs::write(folder.join(RIG_FILE), &rig)?;
        for camera in cameras {
            fs::create_dir(folder.join(camera.name.as_str()))?;
        }
        let frames = OpenOptions::new()
            .create_new(true)
            .append(true)
            .open(folder.join(FRAMES_FILE))?;
        let names = cameras.iter().map(|camera| camera.name.as_str().to_owned());
        Ok(Self {
            folder: folder.to_owned(),
            names: names.collect(),
            frames,
            next: 0,
            bytes: rig.len() as u64,
        })
    }

    /// Writes a frame's images and then its line; gives its number.
    ///
    /// # Errors
    /// When it cannot be written: then none of it stays, and the frames before do.
    pub fn push(&mut self, frame: &NewFrame) -> io::Result<u64> {
        let number = self.next;
        let line = frame_line(number, &self.names, frame);
        let written = self.write_images(number, frame).and_then(|bytes| {
            self.write_line(&line)?;
            Ok(bytes + line.len() as u64)
        });
        match written {
            Ok(bytes) => {
                self.next += 1;
                self.bytes += bytes;
                Ok(number)
            }
            Err(error) => {
                for name in &self.names {
                    // What was not written is not there.
                    let _absent = fs::remove_file(self.image(name, number));
                }
                Err(error)
            }
        }
    }

    /// How many frames there are.
    #[must_use]
    pub fn frames(&self) -> u64 {
        self.next
    }

    /// How much has been written.
    #[must_use]
    pub fn bytes(&self) -> u64 {
        self.bytes
    }

    fn image(&self, camera: &str, number: u64) -> PathBuf {
        self.folder.join(camera).join(format!("{number:04}.jpg"))
    }

    fn write_images(&self, number: u64, frame: &NewFrame) -> io::Result<u64> {
        let mut bytes = 0;
        for (name, image) in self.names.iter().zip(&frame.images) {
            if let Some((_, file)) = image {
                fs::write(self.image(name, number), file)?;
                bytes += file.len() as u64;
            }
        }
        Ok(bytes)
    }

    /// A line that is cut short by a full disk is taken back: half of one would spoil the file.
    fn write_line(&mut self, line: &str) -> io::Result<()> {
        let before = self.frames.metadata()?.len();
        let written = self.frames.write_all(line.as_bytes());
        if written.is_err() {
            self.frames.set_len(before)?;
        }
        written
    }
}

/// Stamps as text: numbers of 64 bits would lose nanoseconds.
fn frame_line(number: u64, names: &[String], frame: &NewFrame) -> String {
    let captured = names.iter().zip(&frame.images);
    let stamps = captured.filter_map(|(name, image)| Some((name, image.as_ref()?.0)));
    let stamps: Vec<String> = stamps
        .map(|(name, at)| format!("\"{name}\": {at}"))
        .collect();
    let mut line = format!(
        "{{\"frame\": {number}, \"stamp\": {{{}}}",
        stamps.join(", ")
    );
    if let Some((at, pose)) = &frame.ego {
        let place = pose.translation.vector;
        let turn = pose.rotation.quaternion();
        write!(
            line,
            ", \"ego_stamp\": {at}, \"ego_position_world_m\": [{:?}, {:?}, {:?}], \
             \"ego_orientation_world_wxyz\": [{:?}, {:?}, {:?}, {:?}]",
            place.x, place.y, place.z, turn.w, turn.i, turn.j, turn.k
        )
        .expect("text grows");
    }
    line.push_str("}\n");
    line
}

#[derive(Serialize)]
struct RigFile {
    camera: Vec<Camera>,
}

#[derive(Serialize)]
struct Camera {
    name: String,
    width: u32,
    height: u32,
    fx: f64,
    fy: f64,
    cx: f64,
    cy: f64,
    position_m: [f64; 3],
    orientation_wxyz: [f64; 4],
    distortion_model: &'static str,
    distortion: Vec<f64>,
}

fn rig_file(cameras: &[RigCamera]) -> String {
    let camera = |camera: &RigCamera| {
        let (size, lens) = (camera.model.size, camera.model.intrinsics);
        let pose = &camera.base_from_optical.isometry;
        let turn = pose.rotation.quaternion();
        let (distortion_model, distortion) = camera.model.distortion.to_ros();
        Camera {
            name: camera.name.as_str().to_owned(),
            width: size.width_px,
            height: size.height_px,
            fx: lens.fx,
            fy: lens.fy,
            cx: lens.cx,
            cy: lens.cy,
            position_m: pose.translation.vector.into(),
            orientation_wxyz: [turn.w, turn.i, turn.j, turn.k],
            distortion_model,
            distortion,
        }
    };
    let rig = RigFile {
        camera: cameras.iter().map(camera).collect(),
    };
    toml::to_string(&rig).expect("plain data")
}

#[cfg(test)]
mod tests {
    use super::{super::RigDataset, *};
    use nalgebra::{Translation3, UnitQuaternion};
    use roadwatch_core::{
        CameraModel, CameraName, Distortion, ImageSize, Intrinsics, space::Transform,
    };

    fn camera(name: &str, distortion: Distortion) -> RigCamera {
        RigCamera {
            name: CameraName::new(name).expect("legal"),
            model: CameraModel {
                size: ImageSize {
                    width_px: 64,
                    height_px: 48,
                },
                intrinsics: Intrinsics {
                    fx: 70.125,
                    fy: 71.0,
                    cx: 31.5,
                    cy: 23.5,
                },
                distortion,
            },
            base_from_optical: Transform::new(Isometry3::from_parts(
                Translation3::new(1.5, -0.25, 1.0 / 3.0),
                UnitQuaternion::from_euler_angles(-1.5, 0.02, -1.57),
            )),
            measured_focal: None,
        }
    }

    fn cameras() -> Vec<RigCamera> {
        let fisheye = Distortion::Fisheye([0.1, -0.02, 0.003, 0.0]);
        vec![camera("front", Distortion::None), camera("left", fisheye)]
    }

    fn at(nanos: i64) -> Timestamp {
        Timestamp::from_nanos(1_700_000_000_000_000_000 + nanos)
    }

    fn frame(nanos: i64, both: bool) -> NewFrame {
        let image = |after| Some((at(nanos + after), b"a picture".to_vec()));
        NewFrame {
            images: vec![image(1), if both { image(2) } else { None }],
            ego: Some((
                at(nanos),
                Isometry3::translation(4_000_000.25, 0.1 + 0.2, 0.0),
            )),
        }
    }

    #[test]
    fn what_is_written_is_read_to_the_nanosecond_and_the_last_digit() {
        let folder = tempfile::tempdir().expect("a folder");
        let mut writer = DatasetWriter::create(folder.path(), &cameras()).expect("begun");
        assert_eq!(writer.push(&frame(123_456_789, true)).expect("written"), 0);
        assert_eq!(writer.push(&frame(223_456_789, false)).expect("written"), 1);
        assert_eq!(writer.frames(), 2);
        let read = RigDataset::open(folder.path()).expect("a dataset");
        for (read, written) in read.cameras().iter().zip(cameras()) {
            assert_eq!(read.name, written.name);
            assert_eq!(read.model.intrinsics, written.model.intrinsics);
            let apart =
                read.base_from_optical.isometry.inverse() * written.base_from_optical.isometry;
            assert!(apart.translation.vector.norm() < 1e-12 && apart.rotation.angle() < 1e-9);
        }
        let frames = read.frames();
        assert_eq!(
            frames[0].stamps,
            [Some(at(123_456_790)), Some(at(123_456_791))]
        );
        assert_eq!(frames[1].stamps, [Some(at(223_456_790)), None]);
        assert_eq!(frames[0].ego_at, at(123_456_789));
        let pose = frames[0].world_from_base.expect("known");
        assert_eq!(pose.translation.vector.x, 4_000_000.25);
        assert_eq!(pose.translation.vector.y, 0.1 + 0.2);
    }

    #[test]
    fn a_folder_that_holds_something_is_left_alone() {
        let folder = tempfile::tempdir().expect("a folder");
        fs::write(folder.path().join("notes.txt"), "mine").expect("written");
        let refused = DatasetWriter::create(folder.path(), &cameras()).expect_err("not empty");
        assert!(refused.to_string().contains("not empty"), "{refused}");
        assert_eq!(fs::read_dir(folder.path()).expect("there").count(), 1);
    }

    #[test]
    fn a_frame_that_cannot_be_written_leaves_nothing_of_itself() {
        let folder = tempfile::tempdir().expect("a folder");
        let mut writer = DatasetWriter::create(folder.path(), &cameras()).expect("begun");
        writer.push(&frame(0, true)).expect("written");
        fs::remove_dir_all(folder.path().join("left")).expect("gone");
        writer
            .push(&frame(100, true))
            .expect_err("nowhere to write");
        fs::create_dir(folder.path().join("left")).expect("there again");
        assert!(!folder.path().join("front/0001.jpg").exists());
        assert_eq!(writer.push(&frame(200, true)).expect("written"), 1);
        let read = RigDataset::open(folder.path()).expect("a dataset");
        assert_eq!(read.frames().len(), 2);
    }
}
