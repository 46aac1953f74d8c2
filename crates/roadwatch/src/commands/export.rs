//! `roadwatch export`.

use super::progress::Progress;
use crate::{
    cli::{ExportCommand, ExportSceneArgs, RecordingArgs},
    failure::Failure,
};
use anyhow::Context as _;
use roadwatch_ros::{
    Recorded,
    msg::roadwatch_msgs::ObjectArray,
    scene_lines::{rig_line, scene_line},
};
use std::{
    fs::{self, File},
    io::{BufWriter, Write},
    path::{Path, PathBuf},
};

/// Makes something of a recording.
///
/// # Errors
/// When the recording cannot be read, or the output cannot be written.
pub fn run(command: &ExportCommand) -> Result<(), Failure> {
    match command {
        ExportCommand::Scene(args) => scene(args),
        ExportCommand::Frames(_) | ExportCommand::Gltf(_) => todo!(),
    }
}

/// A recording and the topic that is read of it.
struct Reading {
    recorded: Recorded,
    topic: String,
}

impl Reading {
    fn open(args: &RecordingArgs) -> Result<Self, Failure> {
        let recorded = Recorded::open(&args.bag).context("nothing can be exported")?;
        let topic = match &args.topic {
            Some(topic) => topic.clone(),
            None => {
                let topic = recorded.scene_topic().context("nothing can be exported")?;
                topic.to_owned()
            }
        };
        Ok(Self { recorded, topic })
    }

    /// Goes through the scenes, with a bar.
    fn scenes(
        &self,
        mut take: impl FnMut(u64, ObjectArray) -> Result<(), Failure>,
    ) -> Result<u64, Failure> {
        let mut progress = Progress::new(self.recorded.count(&self.topic), "scenes");
        let mut count = 0;
        for scene in self.recorded.arrays(&self.topic) {
            take(count, scene.context("the recording ends here")?)?;
            count += 1;
            progress.set(count);
        }
        progress.finish();
        Ok(count)
    }
}

fn scene(args: &ExportSceneArgs) -> Result<(), Failure> {
    let reading = Reading::open(&args.recording)?;
    let cameras = reading
        .recorded
        .line_cameras()
        .context("the rig cannot be read")?;
    let out = Replacing::create(&args.out)?;
    let mut writer = BufWriter::new(&out.file);
    let unwritten = || format!("`{}` cannot be written", args.out.display());
    writer
        .write_all(rig_line(&cameras).as_bytes())
        .with_context(unwritten)?;
    let count = reading.scenes(|seq, scene| {
        let line = scene_line(seq, &scene);
        Ok(writer.write_all(line.as_bytes()).with_context(unwritten)?)
    })?;
    writer.flush().with_context(unwritten)?;
    drop(writer);
    out.finish()?;
    eprintln!(
        "{}: {count} scenes of {} cameras",
        args.out.display(),
        cameras.len()
    );
    Ok(())
}

/// A file that takes its place when all of it is there; until then, and after a failure, what was there before stays.
struct Replacing {
    file: File,
    unfinished: PathBuf,
    path: PathBuf,
}

impl Replacing {
    fn create(path: &Path) -> Result<Self, Failure> {
        let mut unfinished = path.as_os_str().to_owned();
        unfinished.push(".unfinished");
        let unfinished = PathBuf::from(unfinished);
        let file = File::create(&unfinished)
            .with_context(|| format!("`{}` cannot be written", unfinished.display()))?;
        Ok(Self {
            file,
            unfinished,
            path: path.to_owned(),
        })
    }

    fn finish(self) -> Result<(), Failure> {
        let renamed = fs::rename(&self.unfinished, &self.path);
        Ok(renamed.with_context(|| format!("`{}` cannot be written", self.path.display()))?)
    }
}

impl Drop for Replacing {
    fn drop(&mut self) {
        // Gone already when all went well.
        let _gone = fs::remove_file(&self.unfinished);
    }
}
