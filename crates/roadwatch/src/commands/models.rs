//! `roadwatch models`.

mod fetch;
mod list;

pub use fetch::fetch;
pub use list::list;

use super::output::say;
use crate::{
    cli::ModelsVerifyArgs,
    config::{Environment, detector::runtime_places},
    failure::Failure,
};
use anyhow::{Context as _, anyhow};
use roadwatch_core::ImageSize;
use roadwatch_detect::{
    COCO_CLASSES, Network, NetworkOptions, Runtime, letterbox::Letterbox, network::Batch,
};
use std::{
    num::NonZero,
    thread::available_parallelism,
    time::{Duration, Instant},
};

/// Runs before the timed ones: the first few allocate.
const WARM_UP_RUNS: u32 = 3;

/// Opens a model and prints what it is and how fast it runs.
///
/// # Errors
/// When ONNX Runtime is absent, or the model is no detector.
pub fn verify(args: &ModelsVerifyArgs) -> Result<(), Failure> {
    let places = runtime_places(&Environment::of_process());
    let runtime = Runtime::load(&places).map_err(anyhow::Error::from)?;
    let cores = available_parallelism().map_or(1, NonZero::get);
    let options = NetworkOptions {
        threads: if args.threads == 0 {
            cores
        } else {
            args.threads
        },
        spinning: false,
        input_size: args.input_size.as_deref().map(parse_size).transpose()?,
        max_batch: 1,
    };
    let mut network =
        Network::open(&runtime, &args.model, &options).map_err(anyhow::Error::from)?;
    say!("model     {}", args.model.display());
    describe(&network)?;
    say!("runtime   {}", runtime.library().display());
    say!(
        "provider  {}, {} threads",
        network.provider(),
        options.threads
    );
    let times = time_runs(&mut network, args.runs).context("the model opens but does not run")?;
    say!("speed     {}", speed_text(times));
    Ok(())
}

/// Prints what a model takes and gives.
fn describe(network: &Network) -> Result<(), Failure> {
    let head = network.head();
    let batch = match network.batch() {
        Batch::Fixed(count) => format!("fixed at {count}"),
        Batch::UpTo(_) => "free".to_owned(),
    };
    let names = match network.class_names() {
        Some(names) => names.join(", "),
        None if head.classes() == COCO_CLASSES.len() => {
            "none in the file; COCO's are assumed".to_owned()
        }
        None => "none in the file; set detector.class_names".to_owned(),
    };
    say!("head      {}, {} boxes", head.family(), head.boxes());
    say!("classes   {}: {names}", head.classes());
    say!("input     {}, batch {batch}", network.input_size());
    Ok(())
}

fn time_runs(network: &mut Network, runs: u32) -> Result<Vec<Duration>, anyhow::Error> {
    let images = network.batch().max();
    let input = vec![0.5; images * Letterbox::input_len(network.input_size())];
    let mut times = Vec::new();
    for run in 0..runs + WARM_UP_RUNS {
        let began = Instant::now();
        network
            .run(&input, images, |_, _, _| ())
            .map_err(|error| anyhow!("{error}"))?;
        if run >= WARM_UP_RUNS {
            times.push(began.elapsed());
        }
    }
    times.sort();
    Ok(times)
}

fn speed_text(times: Vec<Duration>) -> String {
    let millis = |time: &Duration| time.as_secs_f64() * 1e3;
    match (times.first(), times.get(times.len() / 2), times.last()) {
        (Some(least), Some(median), Some(most)) => format!(
            "median {:.1} ms per run (least {:.1}, most {:.1}, {} runs)",
            millis(median),
            millis(least),
            millis(most),
            times.len()
        ),
        _ => "not timed".to_owned(),
    }
}

fn parse_size(text: &str) -> Result<ImageSize, anyhow::Error> {
    let parsed = text.split_once('x').and_then(|(width, height)| {
        Some(ImageSize {
            width_px: width.parse().ok()?,
            height_px: height.parse().ok()?,
        })
    });
    parsed.ok_or_else(|| anyhow!("--input-size {text}: expected WIDTHxHEIGHT, like 640x640"))
}
