//! Models known by name: what they are, where they lie, how they are fetched.

mod digest;
pub mod fetch;
pub mod fetch_error;
mod part;
pub mod registry;
mod response;
mod state;
mod transfer;

pub use digest::Sha256;
pub use fetch::{Arrival, Download, FetchOptions, Fetched, News, Proxy, fetch};
pub use fetch_error::FetchError;
pub use registry::{Checksum, Model, Origin, Registry};
pub use state::State;

use crate::config::Environment;
use std::path::PathBuf;

/// Below the data folder.
const FOLDER: &str = "roadwatch/models";
/// Where the data folder is in a home that does not say otherwise (XDG Base Directory Specification).
const HOME_DATA: &str = ".local/share";

/// Where fetched models lie: `$XDG_DATA_HOME/roadwatch/models`, or `~/.local/share/roadwatch/models`.
/// `None` when there is no home. A relative `XDG_DATA_HOME` is ignored, as its specification demands.
#[must_use]
pub fn default_folder(environment: &Environment) -> Option<PathBuf> {
    let named = environment.get("XDG_DATA_HOME").map(PathBuf::from);
    let at_home = || Some(PathBuf::from(environment.get("HOME")?).join(HOME_DATA));
    let data = named.filter(|path| path.is_absolute()).or_else(at_home)?;
    Some(data.join(FOLDER))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn folder(variables: &[(&str, &str)]) -> Option<PathBuf> {
        default_folder(&Environment::new(variables, PathBuf::from("/work")))
    }

    #[test]
    fn models_lie_in_the_data_folder_or_at_home() {
        let both = folder(&[("XDG_DATA_HOME", "/data"), ("HOME", "/home/me")]);
        assert_eq!(both, Some(PathBuf::from("/data/roadwatch/models")));
        let relative = folder(&[("XDG_DATA_HOME", "data"), ("HOME", "/home/me")]);
        let at_home = Some(PathBuf::from("/home/me/.local/share/roadwatch/models"));
        assert_eq!(relative, at_home);
        assert_eq!(folder(&[("HOME", "/home/me")]), at_home);
        assert_eq!(folder(&[]), None);
    }
}
