//! `roadwatch models list`.

use crate::{
    cli::ModelsListArgs,
    commands::output::say,
    config::Environment,
    failure::Failure,
    models::{Checksum, Model, Origin, Registry, State, default_folder},
};
use anyhow::Context as _;
use serde_json::{Value, json};

/// Prints the models that are known by name.
///
/// # Errors
/// When standard output cannot be written.
pub fn list(args: &ModelsListArgs) -> Result<(), Failure> {
    let environment = Environment::of_process();
    let folder = default_folder(&environment);
    let registry = Registry::embedded().map_err(anyhow::Error::from)?;
    let models: Vec<_> = registry
        .models()
        .iter()
        .map(|model| (model, State::of(model, folder.as_deref(), &environment)))
        .collect();
    if args.json {
        let models: Vec<_> = models
            .iter()
            .map(|(model, state)| json(model, state))
            .collect();
        let text = serde_json::to_string_pretty(&models).context("the list as JSON")?;
        say!("{text}");
        return Ok(());
    }
    let titles = ["name", "size", "licence", "head", "state"].map(str::to_owned);
    let rows: Vec<_> = models
        .iter()
        .map(|(model, state)| row(model, state))
        .collect();
    let widths: [usize; 4] = std::array::from_fn(|column| {
        let cells = rows.iter().chain([&titles]).map(|row| row[column].len());
        cells.max().unwrap_or_default()
    });
    say!("{}", line(&titles, widths));
    for (row, (model, _)) in rows.iter().zip(&models) {
        say!("{}", line(row, widths));
        say!("{:indent$}{}", "", model.purpose, indent = widths[0] + 2);
    }
    Ok(())
}

fn row(model: &Model, state: &State) -> [String; 5] {
    [
        model.name.clone(),
        model
            .size_bytes
            .map_or_else(|| "unknown".to_owned(), megabytes),
        model.licence.clone(),
        model.head.to_string(),
        state_text(model, state),
    ]
}

fn line([name, size, licence, head, state]: &[String; 5], widths: [usize; 4]) -> String {
    let [w_name, w_size, w_licence, w_head] = widths;
    format!("{name:w_name$}  {size:>w_size$}  {licence:w_licence$}  {head:w_head$}  {state}")
}

pub(super) fn megabytes(bytes: u64) -> String {
    format!("{:.1} MB", bytes as f64 / 1e6)
}

fn state_text(model: &Model, state: &State) -> String {
    match state {
        State::InRepository(path) => format!("in the repository: {}", path.display()),
        State::OnlyInRepository => "only in a checkout of the repository".to_owned(),
        State::Fetched(path) => format!("fetched: {}", path.display()),
        State::Unlike { path, size_bytes } => {
            format!("another file of {size_bytes} bytes: {}", path.display())
        }
        State::PartlyFetched { size_bytes } => format!("{} fetched", megabytes(*size_bytes)),
        State::Absent => match model.origin {
            Origin::Export(_) => "not here; `fetch` says how to make it".to_owned(),
            _ => "not fetched".to_owned(),
        },
    }
}

fn json(model: &Model, state: &State) -> Value {
    let (origin, at) = match &model.origin {
        Origin::Repository(path) => ("repository", path),
        Origin::Url(url) => ("url", url),
        Origin::Export(recipe) => ("export", recipe),
    };
    let sha256 = match model.checksum {
        Checksum::Known(sha256) => Some(sha256.to_string()),
        Checksum::Unknown => None,
    };
    let input_px = model.input.map(|size| [size.width_px, size.height_px]);
    json!({
        "name": model.name,
        "file": model.file,
        "purpose": model.purpose,
        origin: at,
        "sha256": sha256,
        "size_bytes": model.size_bytes,
        "licence": model.licence,
        "head": model.head.as_str(),
        "input_px": input_px,
        "page": model.page,
        "state": state.as_str(),
        "path": state.path(),
    })
}
