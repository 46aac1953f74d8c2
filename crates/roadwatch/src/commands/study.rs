//! `roadwatch study`.

use super::{evaluate::perceive, output::say, progress::Progress};
use crate::{
    cli::{StudyArgs, StudyBoxes},
    config::DatasetChoice,
    failure::Failure,
    session::Session,
};
use anyhow::Context as _;
use roadwatch_camera::{Pace, PlaybackOptions, Repeat};
use roadwatch_lab::{
    DatasetFormat, StudyScene,
    study::{BoxSource, OpenedScene, seen_by_detector, seen_by_labels, study},
};
use std::path::Path;

/// Repeats the paper's studies on simulated drives, writes the report.
///
/// # Errors
/// A dataset that no study fits, mistakes in the configuration, a report that cannot be written.
pub fn run(args: &StudyArgs) -> Result<(), Failure> {
    let opened = args.data.iter().map(|folder| StudyScene::open(folder));
    let opened: Vec<OpenedScene> = opened
        .collect::<Result<_, _>>()
        .context("nothing was studied")?;
    let detector = match (args.boxes, &args.config) {
        (StudyBoxes::Detector, Some(config)) => Some(config),
        _ => None,
    };
    let mut scenes = Vec::with_capacity(opened.len());
    for opened in opened {
        let seen = match detector {
            Some(config) => detected(config, &opened)?,
            None => seen_by_labels(&opened),
        };
        scenes.push(StudyScene {
            seen,
            ..opened.scene
        });
    }
    let boxes = match detector {
        Some(_) => BoxSource::Detector,
        None => BoxSource::Truth,
    };
    let found = study(scenes, boxes, |part| eprintln!("studying {part}"))
        .context("the study cannot be made")?;
    let files = found
        .write(&args.report)
        .context("the study is done but not kept")?;
    if args.json {
        say!("{:#}", found.to_json());
    } else {
        say!("{}", found.to_markdown());
    }
    eprintln!("written to {}: {}", args.report.display(), files.join(", "));
    Ok(())
}

/// What the configured detector sees in a scene.
fn detected(
    config: &Path,
    opened: &OpenedScene,
) -> Result<Vec<roadwatch_lab::study::SeenVehicle>, Failure> {
    let playback = PlaybackOptions {
        pace: Pace::AsFastAsPossible,
        repeat: Repeat::Once,
        frame_limit: None,
    };
    let chosen = DatasetChoice {
        folder: opened.scene.folder.clone(),
        format: Some(DatasetFormat::Rig),
    };
    let session = Session::open(config, &chosen.into(), playback)?;
    let images = opened.dataset.frames().len() as u64;
    eprintln!("detecting in {}", opened.scene.folder.display());
    let (recording, _) = perceive(session, Progress::new(images, "images"))?;
    Ok(seen_by_detector(opened, &recording.frames))
}
