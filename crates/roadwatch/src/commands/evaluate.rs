//! `roadwatch evaluate`.

use super::{output::say, progress::Progress};
use crate::{
    cli::EvaluateArgs,
    config::{Config, Mistakes},
    failure::Failure,
    session::{Session, watch},
};
use anyhow::{Context as _, anyhow};
use roadwatch_camera::{Pace, PlaybackOptions, Repeat, RigDataset};
use roadwatch_core::Method;
use roadwatch_lab::{
    Evaluation, LostImages, MethodUnderTest, Recorded, Recorder, Truth, TruthFilter,
    evaluate::evaluate,
};
use roadwatch_pipeline::{NamedSink, Overload, PipelineOptions, Running};
use std::{sync::Arc, time::Duration};

/// Often enough for a bar to look alive.
const PROGRESS_PERIOD: Duration = Duration::from_millis(200);

/// Runs the pipeline over a labelled dataset, scores every method, writes the report.
///
/// # Errors
/// Mistakes in the configuration, a dataset without labels, a report that cannot be written.
pub fn run(args: &EvaluateArgs) -> Result<(), Failure> {
    let playback = PlaybackOptions {
        pace: Pace::AsFastAsPossible,
        repeat: Repeat::Once,
        frame_limit: args.frames,
    };
    let session = Session::open(&args.config, args.dataset.clone(), playback)?;
    let config = session.config.clone();
    let dataset = dataset_of(&config, args)?;
    let truth = Truth::read(dataset.folder()).context("nothing can be scored")?;
    check_classes(args, &truth)?;
    let rig = Arc::clone(&session.rig);
    let frames = dataset.frames().len() as u64;
    let images = args.frames.map_or(frames, |limit| limit.min(frames)) * rig.cameras().len() as u64;
    let recorded = perceive(session, Progress::new(images, "images"))?;
    let filter = TruthFilter {
        min_height_px: args.min_height_px,
        max_occluded: args.max_occluded,
        max_truncated: args.max_truncated,
        classes: args.class.clone(),
    };
    let evaluation = Evaluation {
        rig: &rig,
        dataset: &dataset,
        truth: &truth,
        filter: &filter,
        lost_images: LostImages::Count,
        frame_limit: args.frames,
    };
    let report = evaluate(&evaluation, &recorded, &methods(&config));
    report
        .write(&args.out)
        .context("the evaluation is done but not kept")?;
    if args.json {
        say!("{:#}", report.to_json());
    } else {
        say!("{}", report.to_markdown());
    }
    eprintln!(
        "written: {0}/report.json, {0}/report.md",
        args.out.display()
    );
    Ok(())
}

/// Runs the pipeline over everything and keeps what it perceives.
fn perceive(session: Session, mut progress: Progress) -> Result<Vec<Recorded>, Failure> {
    let rig = Arc::clone(&session.rig);
    let recorder = Recorder::default();
    let sink = NamedSink {
        name: "recorder".to_owned(),
        sink: Box::new(recorder.clone()),
    };
    let running = session.start(vec![sink], PipelineOptions::new(Overload::Wait))?;
    let report = |running: &Running| {
        let published = rig
            .ids()
            .map(|camera| running.metrics().camera(camera).published);
        progress.set(published.sum());
    };
    watch(&running, PROGRESS_PERIOD, || false, report)?;
    progress.finish();
    Ok(recorder.take())
}

/// A class that nobody labelled is a slip: its report would be empty.
fn check_classes(args: &EvaluateArgs, truth: &Truth) -> Result<(), Failure> {
    let labelled = truth.classes();
    match args
        .class
        .iter()
        .find(|class| !labelled.contains(class.as_str()))
    {
        None => Ok(()),
        Some(class) => {
            let labelled: Vec<_> = labelled.into_iter().collect();
            Err(anyhow!(
                "--class {class}: nothing is labelled so; labelled are {}",
                labelled.join(", ")
            )
            .into())
        }
    }
}

fn dataset_of(config: &Config, args: &EvaluateArgs) -> Result<Arc<RigDataset>, Mistakes> {
    let dataset = config.rig.as_ref().and_then(|rig| rig.dataset.clone());
    dataset.ok_or_else(|| {
        Mistakes::about_file(
            &args.config,
            "names no dataset: set rig.dataset, or give --dataset DIR",
        )
    })
}

/// Every method on every camera, or why a method cannot be tried.
fn methods(config: &Config) -> Vec<MethodUnderTest> {
    let Some(rig) = &config.rig else {
        return Vec::new();
    };
    let locators = |method| {
        let pairs = rig.rig.cameras().iter().zip(&rig.cameras);
        let built = pairs.map(|(camera, camera_config)| {
            config
                .locate
                .locator(&rig.rig, camera, camera_config, method)
                .map_err(|(_, what)| what)
        });
        built.collect::<Result<Vec<_>, _>>()
    };
    let tested = Method::ALL.into_iter();
    tested
        .map(|method| MethodUnderTest {
            method,
            locators: locators(method),
        })
        .collect()
}
