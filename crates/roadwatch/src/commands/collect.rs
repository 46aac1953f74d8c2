//! `roadwatch collect`.

use crate::{
    cli::CollectArgs,
    commands::run::{Beside, run_beside},
    config::Config,
    failure::Failure,
    node::RosoutTap,
    open::encoded,
    session::Session,
};
use anyhow::{Context as _, anyhow};
use roadwatch_core::{Locator, Method};
use roadwatch_lab::collect::{CollectOptions, Collected, Collector, SecondOpinion, Triggers};
use roadwatch_pipeline::NamedSink;
use std::sync::Arc;

/// The collector's name among the sinks.
const COLLECTION: &str = "collection";
/// Who is asked beside the configured method: what they need is there for every camera.
const OTHERS: [Method; 3] = [Method::TriangleFy, Method::Ground, Method::Fused];

/// Runs the daemon and keeps what it sees.
///
/// # Errors
/// Those of `run`; a folder that cannot be written to.
pub fn run(args: &CollectArgs, rosout: &RosoutTap) -> Result<(), Failure> {
    let mut collected = None;
    let ran = run_beside(&args.run, rosout, |session| {
        let collector = collector(args, session)?;
        let progress = collector.collected();
        collected = Some(Arc::clone(&progress));
        Ok(Beside {
            sink: NamedSink {
                name: COLLECTION.to_owned(),
                sink: Box::new(collector),
            },
            is_done: Box::new(move || progress.is_ended()),
        })
    });
    let Some(collected) = collected else {
        return ran;
    };
    eprintln!("{}", summary(args, &collected));
    ran?;
    match collected.has_failed() {
        true => Err(anyhow!(
            "the collection ended early: the log says why; what was collected is whole"
        )
        .into()),
        false => Ok(()),
    }
}

fn collector(args: &CollectArgs, session: &Session) -> Result<Collector, Failure> {
    let options = CollectOptions {
        triggers: Triggers {
            every: args.every,
            on_object: args.on_object,
            on_disagreement: args.on_disagreement,
        },
        others: second_opinions(&session.config),
        budget_bytes: args.budget_mb.saturating_mul(1_000_000),
        as_jpeg: Box::new(|image| match encoded(image)? {
            file if file.format == "jpeg" => Ok(file.bytes),
            _ => Ok(roadwatch_picture::jpeg(
                image.pixels().map_err(Clone::clone)?,
            )?),
        }),
    };
    let collector = Collector::create(&args.out, Arc::clone(&session.rig), options);
    Ok(collector
        .with_context(|| format!("nothing can be collected in `{}`", args.out.display()))?)
}

/// Every other method that this rig allows.
fn second_opinions(config: &Config) -> Vec<SecondOpinion> {
    let Some(rig) = &config.rig else {
        return Vec::new();
    };
    let others = OTHERS
        .into_iter()
        .filter(|method| *method != config.locate.method);
    let opinion = |method| {
        let pairs = rig.rig.cameras().iter().zip(&rig.cameras);
        let locators =
            pairs.map(|(camera, own)| config.locate.locator(&rig.rig, camera, own, method).ok());
        let locators: Option<Vec<Box<dyn Locator>>> = locators.collect();
        Some(SecondOpinion {
            method,
            locators: locators?,
        })
    };
    others.filter_map(opinion).collect()
}

fn summary(args: &CollectArgs, collected: &Collected) -> String {
    let megabytes = collected.bytes() as f64 / 1e6;
    let ended = match collected.is_ended() && !collected.has_failed() {
        true => "; ended here: more is not within --budget-mb",
        false => "",
    };
    format!(
        "collected: {} of {} rounds, {megabytes:.1} MB in {}{ended}",
        collected.frames(),
        collected.rounds(),
        args.out.display()
    )
}
