//! `roadwatch evaluate`.

use super::{output::say, progress::Progress, scoring::labelled};
use crate::{
    cli::EvaluateArgs,
    config::{Changes, Config, DatasetChoice, Identities, Mistakes, ReidConfig},
    failure::Failure,
    open,
    session::{Session, watch},
};
use anyhow::{Context as _, anyhow};
use roadwatch_camera::{Pace, PlaybackOptions, Repeat};
use roadwatch_core::Method;
use roadwatch_lab::{
    Baseline, Evaluation, LatencyMs, LostImages, MethodUnderTest, Recorder, Recording, Report,
    Truth, TruthFilter, evaluate::evaluate,
};
use roadwatch_pipeline::{NamedSink, Overload, PipelineOptions, Running};
use std::{sync::Arc, time::Duration};

/// Often enough for a bar to look alive.
const PROGRESS_PERIOD: Duration = Duration::from_millis(200);
/// The recorder's place among the sinks: it is the only one.
const RECORDER: usize = 0;

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
    let chosen = args.dataset.clone().map(|folder| DatasetChoice {
        folder,
        format: args.format.map(Into::into),
    });
    let changes = chosen.map_or_else(Changes::default, Changes::from);
    let session = Session::open(&args.config, &changes, playback)?;
    let config = session.config.clone();
    let (dataset, truth) = labelled(&config)?.ok_or_else(|| no_dataset(args))?;
    check_classes(args, &truth)?;
    let rig = Arc::clone(&session.rig);
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
    let images = evaluation.images().count() as u64;
    let (recording, latency) = perceive(session, Progress::new(images, "images"))?;
    let report = Report {
        latency: Some(latency),
        ..evaluate(
            &evaluation,
            &recording,
            &methods(&config),
            baselines(&config),
        )
    };
    let files = report
        .write(&args.report)
        .context("the evaluation is done but not kept")?;
    if args.json {
        say!("{:#}", report.to_json());
    } else {
        say!("{}", report.to_markdown());
    }
    eprintln!("written to {}: {}", args.report.display(), files.join(", "));
    Ok(())
}

/// Runs the pipeline over everything; keeps what it perceives, and how long that took.
pub(super) fn perceive(
    session: Session,
    mut progress: Progress,
) -> Result<(Recording, LatencyMs), Failure> {
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
    let latency = running.metrics().received_to_published(RECORDER);
    let millis = |time: Duration| time.as_secs_f64() * 1e3;
    let latency = LatencyMs {
        p50: millis(latency.p50),
        p99: millis(latency.p99),
    };
    Ok((recorder.take(), latency))
}

/// The other ways to give identities.
fn baselines(config: &Config) -> Vec<Baseline> {
    let others = Identities::ALL.into_iter();
    let others = others.filter(|(_, identities)| {
        *identities != Identities::Tracks && *identities != config.reid.identities
    });
    let memory = config.locate.ground_memory;
    let baseline = |(name, identities): (&str, Identities)| {
        let reid = ReidConfig {
            identities,
            ..config.reid.clone()
        };
        let rig = open::shared_rig(config)?;
        Some(Baseline {
            name: name.to_owned(),
            reidentifier: reid.reidentifier(&rig, memory),
        })
    };
    others.filter_map(baseline).collect()
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

fn no_dataset(args: &EvaluateArgs) -> Mistakes {
    Mistakes::about_file(
        &args.config,
        "names no dataset: set rig.dataset, or give --dataset DIR",
    )
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
