//! `roadwatch models fetch`.

use super::{describe, list::megabytes};
use crate::{
    cli::ModelsFetchArgs,
    commands::{output::say, progress::Progress},
    config::{Environment, detector::runtime_places},
    failure::Failure,
    models::{
        self, Arrival, Checksum, Download, FetchOptions, Fetched, Model, News, Origin, Registry,
        State, default_folder,
    },
};
use anyhow::{Context as _, anyhow};
use roadwatch_core::error_chain;
use roadwatch_detect::{Network, NetworkOptions, Runtime};
use std::{
    path::{Path, PathBuf, absolute},
    time::Duration,
};

const BYTES_PER_KB: u64 = 1000;

/// Fetches a model by name, opens it, and prints its path.
///
/// # Errors
/// When there is no such model, when it cannot be fetched or is not the one that was meant, or is no detector.
pub fn fetch(args: &ModelsFetchArgs) -> Result<(), Failure> {
    let environment = Environment::of_process();
    let registry = Registry::embedded().map_err(anyhow::Error::from)?;
    let model = named(&registry, &args.name)?;
    if let (Origin::Repository(place), None) = (&model.origin, &args.url) {
        return point_to_repository(model, place, &environment);
    }
    let download = download(args, model, &environment)?;
    say!("{}: {}", model.name, model.purpose);
    say!("licence   {} ({})", model.licence, model.page);
    say!("from      {}", download.url);
    say!("to        {}", download.to.display());
    if download.checksum == Checksum::Unknown && !args.accept_unverified {
        return Err(unverified(model, &download).into());
    }
    let mut reporter = Reporter::default();
    let options = FetchOptions::default();
    let fetched = models::fetch(&download, &options, &mut |news| reporter.hear(news));
    reporter.clear();
    let fetched = fetched.map_err(anyhow::Error::from)?;
    report(&fetched, download.checksum)?;
    open(model, &download.to, &environment)?;
    point_to(&download.to)
}

fn named<'a>(registry: &'a Registry, name: &str) -> Result<&'a Model, anyhow::Error> {
    registry.find(name).ok_or_else(|| {
        let names: Vec<_> = registry.models().iter().map(|model| &*model.name).collect();
        anyhow!(
            "no model is called `{name}`; there are {}",
            names.join(", ")
        )
    })
}

fn point_to_repository(
    model: &Model,
    place: &str,
    environment: &Environment,
) -> Result<(), Failure> {
    match State::of(model, None, environment) {
        State::InRepository(path) => {
            say!("{} is in the repository, there is nothing to fetch", model.name);
            point_to(&path)
        }
        _ => Err(anyhow!(
            "{} is not published by itself: it is the file {place} of Roadwatch's repository, and this program \
             does not run from a checkout that has it",
            model.name
        )
        .into()),
    }
}

fn download(
    args: &ModelsFetchArgs,
    model: &Model,
    environment: &Environment,
) -> Result<Download, anyhow::Error> {
    let url = match (&args.url, &model.origin) {
        (Some(url), _) | (None, Origin::Url(url)) => url.clone(),
        (None, Origin::Export(recipe)) => {
            let Model { name, licence, .. } = model;
            return Err(anyhow!("{name} ({licence}) cannot be fetched: {recipe}"));
        }
        (None, Origin::Repository(place)) => return Err(anyhow!("{place} is not fetched")),
    };
    let folder = match &args.to {
        Some(folder) => folder.clone(),
        None => default_folder(environment)
            .context("neither XDG_DATA_HOME nor HOME is set; name a folder with --to")?,
    };
    let folder = absolute(&folder).with_context(|| format!("`{}`", folder.display()))?;
    Ok(Download {
        url,
        to: folder.join(&model.file),
        checksum: model.checksum,
        size_bytes: model.size_bytes,
    })
}

fn unverified(model: &Model, download: &Download) -> anyhow::Error {
    anyhow!(
        "the registry knows no sha256 of {}, so nobody can tell whether what comes from {} is what it should be: \
         add --accept-unverified to take it all the same; its size and sha256 are then printed",
        model.name,
        download.url
    )
}

fn report(fetched: &Fetched, checksum: Checksum) -> Result<(), Failure> {
    let size_bytes = fetched.size_bytes;
    say!("size      {} ({size_bytes} bytes)", megabytes(size_bytes));
    let checked = match checksum {
        Checksum::Known(_) => "as it should be",
        Checksum::Unknown => "not checked: the registry knows none",
    };
    say!("sha256    {} ({checked})", fetched.sha256);
    if fetched.arrival == Arrival::Before {
        say!("it was there already, nothing was fetched");
    }
    Ok(())
}

/// Opens what was fetched, where that is possible.
fn open(model: &Model, path: &Path, environment: &Environment) -> Result<(), Failure> {
    let runtime = match Runtime::load(&runtime_places(environment)) {
        Ok(runtime) => runtime,
        Err(error) => {
            say!("not opened, because {}", error_chain(&error));
            return Ok(());
        }
    };
    let options = NetworkOptions {
        threads: 1,
        spinning: false,
        input_size: model.input,
        max_batch: 1,
    };
    let network = Network::open(&runtime, path, &options)
        .with_context(|| format!("`{}` was fetched and cannot be used", path.display()))?;
    let found = network.head().family();
    if found != model.head {
        let expected = model.head;
        let path = path.display();
        return Err(anyhow!("`{path}` has the head {found}, the registry says {expected}").into());
    }
    describe(&network)
}

fn point_to(path: &Path) -> Result<(), Failure> {
    let quoted = toml::Value::from(PathBuf::from(path).display().to_string());
    say!("to use it, write below [detector]:\n\nmodel = {quoted}");
    Ok(())
}

/// Progress on standard error.
#[derive(Default)]
struct Reporter {
    progress: Option<Progress>,
}

impl Reporter {
    fn hear(&mut self, news: News) {
        match news {
            News::Has { bytes, total } => self.show(bytes, total),
            News::Anew => {
                self.clear();
                eprintln!("the server does not go on from there: once more from the beginning");
            }
            News::Again { reason, pause } => {
                self.clear();
                eprintln!("{reason}; trying again in {}", seconds(pause));
            }
        }
    }

    fn show(&mut self, bytes: u64, total: Option<u64>) {
        let Some(total) = total else { return };
        self.progress
            .get_or_insert_with(|| Progress::new(total.div_ceil(BYTES_PER_KB), "kB"))
            .set(bytes.div_ceil(BYTES_PER_KB));
    }

    fn clear(&mut self) {
        if let Some(progress) = self.progress.take() {
            progress.finish();
        }
    }
}

fn seconds(pause: Duration) -> String {
    format!("{:.1} s", pause.as_secs_f64())
}
