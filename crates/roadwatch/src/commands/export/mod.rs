//! `roadwatch export`.

mod frames;
mod replacing;

use super::progress::Progress;
use crate::{
    cli::{ExportCommand, ExportGltfArgs, ExportSceneArgs, RecordingArgs},
    failure::Failure,
};
use anyhow::Context as _;
use replacing::Replacing;
use roadwatch_lab::export::gltf::GltfScenes;
use roadwatch_ros::{
    Recorded,
    msg::roadwatch_msgs::ObjectArray,
    scene_lines::{LineRig, rig_line, scene_line},
};
use std::io::{BufWriter, Write as _};

/// Makes something of a recording.
///
/// # Errors
/// When the recording cannot be read, or the output cannot be written.
pub fn run(command: &ExportCommand) -> Result<(), Failure> {
    match command {
        ExportCommand::Scene(args) => scene(args),
        ExportCommand::Frames(args) => frames::run(args),
        ExportCommand::Gltf(args) => gltf(args),
    }
}

/// The scenes of a recording.
struct Scenes {
    recorded: Recorded,
    topic: String,
    rig: LineRig,
}

impl Scenes {
    fn open(args: &RecordingArgs) -> Result<Self, Failure> {
        let recorded = Recorded::open(&args.bag).context("nothing can be exported")?;
        let topic = match &args.topic {
            Some(topic) => topic.clone(),
            None => {
                let topic = recorded.scene_topic().context("nothing can be exported")?;
                topic.to_owned()
            }
        };
        let rig = recorded.line_rig().context("the rig cannot be read")?;
        Ok(Self {
            recorded,
            topic,
            rig,
        })
    }

    /// Goes through them, with a bar; gives their number.
    fn each(
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
    let scenes = Scenes::open(&args.recording)?;
    let out = Replacing::new(&args.out);
    let mut writer = BufWriter::new(out.create()?);
    let mut write = |line: String| {
        let written = writer.write_all(line.as_bytes());
        written.with_context(|| out.unwritten())
    };
    write(rig_line(&scenes.rig))?;
    let count = scenes.each(|seq, scene| Ok(write(scene_line(seq, &scene))?))?;
    writer.flush().with_context(|| out.unwritten())?;
    out.finish()?;
    let cameras = scenes.rig.cameras.len();
    eprintln!(
        "{}: {count} scenes of {cameras} cameras",
        args.out.display()
    );
    Ok(())
}

fn gltf(args: &ExportGltfArgs) -> Result<(), Failure> {
    let scenes = Scenes::open(&args.recording)?;
    let out = Replacing::new(&args.out);
    let mut writer = BufWriter::new(out.create()?);
    let mut all = GltfScenes::new(scenes.rig.clone(), args.range_m);
    let count = scenes.each(|_, scene| {
        all.add(&scene);
        Ok(())
    })?;
    let written = all.write(&mut writer).and_then(|tracks| {
        writer.flush()?;
        Ok(tracks)
    });
    let tracks = written.with_context(|| out.unwritten())?;
    out.finish()?;
    eprintln!("{}: {tracks} tracks in {count} scenes", args.out.display());
    Ok(())
}
