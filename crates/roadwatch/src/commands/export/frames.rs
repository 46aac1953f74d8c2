//! `roadwatch export frames`.

use super::replacing::Replacing;
use crate::{cli::ExportFramesArgs, commands::progress::Progress, failure::Failure};
use anyhow::{Context as _, anyhow};
use roadwatch_lab::{
    export::{
        DataFrameFile, Field, LOCATIONAL, ROTATIONAL, Value, locational_rows, rotational_rows,
    },
    plots::{Traces, draw_headings, draw_trajectories},
};
use roadwatch_ros::{Recorded, msg::roadwatch_msgs::ObjectArray, scene_lines::LineRig};
use std::{fs, path::Path};

/// Writes both data frames and their pictures.
pub(super) fn run(args: &ExportFramesArgs) -> Result<(), Failure> {
    let recorded = Recorded::open(&args.recording.bag).context("nothing can be exported")?;
    let topics: Vec<&String> = match &args.recording.topic {
        Some(topic) => vec![topic],
        None => recorded.camera_topics().values().collect(),
    };
    let rig = recorded.line_rig().context("the rig cannot be read")?;
    let folder = &args.out;
    fs::create_dir_all(folder).with_context(|| format!("`{}` cannot be made", folder.display()))?;
    let mut frames = Frames {
        locational: TwoFiles::create(folder, "locational", &LOCATIONAL)?,
        rotational: TwoFiles::create(folder, "rotational", &ROTATIONAL)?,
        seen: Seen::default(),
    };
    let total = topics.iter().map(|topic| recorded.count(topic)).sum();
    if total == 0 {
        let what = "nothing can be exported: the recording holds no objects of cameras";
        return Err(anyhow!(what).into());
    }
    let mut progress = Progress::new(total, "frames");
    let mut count = 0;
    for topic in topics {
        for array in recorded.arrays(topic) {
            frames.add(&array.context("the recording ends here")?, &rig)?;
            count += 1;
            progress.set(count);
        }
    }
    progress.finish();
    let rows = frames.finish(folder)?;
    eprintln!(
        "{}: locational and rotational, each .parquet, .csv and .png; {rows} rows of {count} frames",
        folder.display()
    );
    Ok(())
}

struct Frames {
    locational: TwoFiles,
    rotational: TwoFiles,
    seen: Seen,
}

impl Frames {
    fn add(&mut self, array: &ObjectArray, rig: &LineRig) -> Result<(), Failure> {
        let camera = rig
            .cameras
            .iter()
            .find(|camera| camera.name == array.camera);
        let eye = camera.map(|camera| {
            let place = &camera.base_from_optical.translation;
            nalgebra::Vector2::new(place.x, place.y)
        });
        for row in locational_rows(array) {
            self.locational.push(row)?;
        }
        for row in rotational_rows(array, eye) {
            self.rotational.push(row)?;
        }
        self.seen.add(array);
        Ok(())
    }

    fn finish(self, folder: &Path) -> Result<usize, Failure> {
        let rows = self.locational.finish()?;
        self.rotational.finish()?;
        self.seen.draw(folder)?;
        Ok(rows)
    }
}

/// A data frame's Parquet and CSV files.
struct TwoFiles {
    files: DataFrameFile,
    parquet: Replacing,
    csv: Replacing,
}

impl TwoFiles {
    fn create(folder: &Path, name: &str, fields: &'static [Field]) -> Result<Self, Failure> {
        let parquet = Replacing::new(&folder.join(format!("{name}.parquet")));
        let csv = Replacing::new(&folder.join(format!("{name}.csv")));
        let files = DataFrameFile::create(parquet.unfinished(), csv.unfinished(), fields);
        let files = files.with_context(|| parquet.unwritten())?;
        Ok(Self {
            files,
            parquet,
            csv,
        })
    }

    fn push(&mut self, row: Vec<Value>) -> Result<(), Failure> {
        let pushed = self.files.push(row);
        Ok(pushed.with_context(|| self.parquet.unwritten())?)
    }

    fn finish(self) -> Result<usize, Failure> {
        let rows = self
            .files
            .finish()
            .with_context(|| self.parquet.unwritten())?;
        self.parquet.finish()?;
        self.csv.finish()?;
        Ok(rows)
    }
}

/// What is drawn: places over ground where the vehicle's motion is known, else around it; headings in base_link.
#[derive(Default)]
struct Seen {
    knows_ego: bool,
    places: Traces,
    vehicle: Vec<(f64, [f64; 2])>,
    headings: Traces,
}

impl Seen {
    fn add(&mut self, array: &ObjectArray) {
        let stamp = array.header.stamp;
        let time_s = f64::from(stamp.sec) + f64::from(stamp.nanosec) / 1e9;
        let told = array.odom_from_base();
        self.knows_ego |= told.is_some();
        let ego = told.unwrap_or_default();
        let above = |point: nalgebra::Point3<f64>| [point.x, point.y];
        self.vehicle
            .push((time_s, above(ego * nalgebra::Point3::origin())));
        for object in &array.objects {
            let place = object.position;
            let place = ego * nalgebra::Point3::new(place.x, place.y, place.z);
            let id = object.track_id.cast_signed();
            self.places.entry(id).or_default().push(above(place));
            if object.heading_known {
                let heading = [time_s, object.yaw_rad.to_degrees()];
                self.headings.entry(id).or_default().push(heading);
            }
        }
    }

    fn draw(mut self, folder: &Path) -> Result<(), Failure> {
        self.vehicle.sort_by(|a, b| a.0.total_cmp(&b.0));
        let way: Vec<[f64; 2]> = self.vehicle.iter().map(|(_, place)| *place).collect();
        let begin_s = self.vehicle.first().map_or(0.0, |(time_s, _)| *time_s);
        for heading in self.headings.values_mut().flatten() {
            heading[0] -= begin_s;
        }
        let frame = if self.knows_ego { "odom" } else { "base_link" };
        let picture = folder.join("locational.png");
        draw_trajectories(&self.places, (&way, frame), &picture)
            .context("the trajectories are not drawn")?;
        draw_headings(&self.headings, &folder.join("rotational.png"))
            .context("the headings are not drawn")?;
        Ok(())
    }
}
