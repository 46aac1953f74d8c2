//! The registry: `models/registry.toml`, built into the program, read strictly.

use super::Sha256;
use roadwatch_core::ImageSize;
use roadwatch_detect::Family;
use serde::Deserialize;
use std::path::Path;

const EMBEDDED: &str = include_str!("../../../../models/registry.toml");
/// What the file says where nobody could find out a hash.
const UNKNOWN: &str = "unknown";

/// Every model that is known by name, in the order of the file. Names are different.
#[derive(Debug, Clone, PartialEq)]
pub struct Registry {
    models: Vec<Model>,
}

/// A model that is known by name.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Model {
    /// What it is called on the command line.
    pub name: String,
    /// The name of its file, without folders.
    pub file: String,
    /// What it is for, in one line.
    pub purpose: String,
    /// How it is had.
    pub origin: Origin,
    /// What its file hashes to.
    pub checksum: Checksum,
    /// Length of its file; `None` when unknown.
    pub size_bytes: Option<u64>,
    /// SPDX expression of its weights' licence.
    pub licence: String,
    /// The family of its output.
    pub head: Family,
    /// The input that it takes; `None` when its file has to be asked.
    pub input: Option<ImageSize>,
    /// The page that it is published on.
    pub page: String,
}

/// What a file has to hash to.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Checksum {
    /// To this.
    Known(Sha256),
    /// Nobody could find out: what comes cannot be checked.
    Unknown,
}

/// How a model is had.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Origin {
    /// It is kept in the repository, at this path.
    Repository(String),
    /// It is published as a file at this address.
    Url(String),
    /// Nobody publishes a file that fits; how to make one.
    Export(String),
}

/// A registry that cannot be used.
#[derive(Debug, thiserror::Error)]
pub enum RegistryError {
    /// Not TOML, a key that is missing or unknown.
    #[error("the registry of models: {0}")]
    Unreadable(#[from] toml::de::Error),
    /// A value that makes no sense.
    #[error("the registry of models: {model}.{key}: {reason}")]
    Wrong {
        /// The entry.
        model: String,
        /// The key.
        key: &'static str,
        /// What is wrong with its value.
        reason: String,
    },
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Written {
    model: Vec<Entry>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Entry {
    name: String,
    file: String,
    purpose: String,
    repository: Option<String>,
    url: Option<String>,
    export: Option<String>,
    sha256: String,
    size_bytes: Option<u64>,
    licence: String,
    head: String,
    input_px: Option<[u32; 2]>,
    page: String,
}

impl Registry {
    /// The one that is built in.
    ///
    /// # Errors
    /// As [`Registry::parse`]; a test sees to it that there are none.
    pub fn embedded() -> Result<Self, RegistryError> {
        Self::parse(EMBEDDED)
    }

    /// Reads a registry.
    ///
    /// # Errors
    /// At the first thing that is missing, unknown or senseless.
    pub fn parse(text: &str) -> Result<Self, RegistryError> {
        let written: Written = toml::from_str(text)?;
        let mut models: Vec<Model> = Vec::new();
        for entry in written.model {
            let name = entry.name.clone();
            let wrong = |(key, reason)| RegistryError::Wrong {
                model: name.clone(),
                key,
                reason,
            };
            let model = Model::read(entry).map_err(wrong)?;
            if models.iter().any(|other| other.name == model.name) {
                return Err(wrong(("name", "it is there twice".to_owned())));
            }
            models.push(model);
        }
        Ok(Self { models })
    }

    /// Every model.
    #[must_use]
    pub fn models(&self) -> &[Model] {
        &self.models
    }

    /// The model of this name.
    #[must_use]
    pub fn find(&self, name: &str) -> Option<&Model> {
        self.models.iter().find(|model| model.name == name)
    }
}

impl Model {
    fn read(entry: Entry) -> Result<Self, (&'static str, String)> {
        let said = |key, text: &str| match text.trim() {
            "" => Err((key, "it is empty".to_owned())),
            _ => Ok(text.to_owned()),
        };
        if Path::new(&entry.file).file_name() != Some(entry.file.as_ref()) {
            let reason = format!("`{}` is no bare file name", entry.file);
            return Err(("file", reason));
        }
        if entry.size_bytes == Some(0) {
            return Err(("size_bytes", "no model is empty".to_owned()));
        }
        let checksum = match entry.sha256.as_str() {
            UNKNOWN => Checksum::Unknown,
            text => Checksum::Known(text.parse().map_err(|reason| ("sha256", reason))?),
        };
        let head = Family::ALL
            .into_iter()
            .find(|family| family.as_str() == entry.head);
        Ok(Self {
            origin: origin(&entry)?,
            checksum,
            size_bytes: entry.size_bytes,
            licence: said("licence", &entry.licence)?,
            head: head.ok_or_else(|| ("head", format!("`{}` is no family", entry.head)))?,
            input: entry.input_px.map(|[width_px, height_px]| ImageSize {
                width_px,
                height_px,
            }),
            page: said("page", &entry.page)?,
            purpose: said("purpose", &entry.purpose)?,
            name: said("name", &entry.name)?,
            file: entry.file,
        })
    }
}

fn origin(entry: &Entry) -> Result<Origin, (&'static str, String)> {
    match (&entry.repository, &entry.url, &entry.export) {
        (Some(path), None, None) => Ok(Origin::Repository(path.clone())),
        (None, Some(url), None) if url.starts_with("https://") => Ok(Origin::Url(url.clone())),
        (None, Some(url), None) => Err(("url", format!("`{url}` does not begin with https://"))),
        (None, None, Some(recipe)) => Ok(Origin::Export(recipe.clone())),
        _ => {
            let reason = "expected one of `repository`, `url` and `export`".to_owned();
            Err(("url", reason))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const ENTRY: &str = "[[model]]\nname = \"a\"\nfile = \"a.onnx\"\npurpose = \"p\"\n\
        url = \"https://h/a\"\nsha256 = \"unknown\"\nlicence = \"MIT\"\nhead = \"yolov5\"\npage = \"x\"\n";

    fn refused(text: &str) -> String {
        Registry::parse(text).expect_err("it is wrong").to_string()
    }

    #[test]
    fn every_entry_that_is_built_in_parses() {
        let registry = Registry::embedded().expect("it parses");
        let names: Vec<_> = registry.models().iter().map(|m| m.name.as_str()).collect();
        let expected = [
            "roadwatch_detector",
            "yolov5s",
            "yolov8n",
            "yolox_s",
            "yolox_nano",
            "yolox_nano_features",
        ];
        assert_eq!(names, expected);
    }

    #[test]
    fn a_hash_that_nobody_knows_is_a_state_of_its_own() {
        let registry = Registry::parse(ENTRY).expect("it parses");
        let model = registry.find("a").expect("it is there");
        assert_eq!(model.checksum, Checksum::Unknown);
        assert_eq!(model.origin, Origin::Url("https://h/a".to_owned()));
    }

    #[test]
    fn unknown_keys_are_refused() {
        assert!(refused(&format!("{ENTRY}sha265 = \"x\"\n")).contains("sha265"));
        assert!(refused(&format!("version = 1\n{ENTRY}")).contains("version"));
    }

    #[test]
    fn senseless_values_are_refused_with_entry_and_key() {
        let cases = [
            ("\"unknown\"", "\"abc\"", "a.sha256: `abc` is no SHA-256"),
            ("\"yolov5\"", "\"yolov6\"", "a.head: `yolov6` is no family"),
            ("\"a.onnx\"", "\"../a.onnx\"", "a.file: `../a.onnx`"),
            ("https://", "http://", "a.url: `http://h/a`"),
            ("url = \"https://h/a\"\n", "", "a.url: expected one of"),
            ("\"MIT\"", "\" \"", "a.licence: it is empty"),
        ];
        for (from, to, expected) in cases {
            let text = refused(&ENTRY.replace(from, to));
            assert!(text.contains(expected), "{text}");
        }
        assert!(refused(&ENTRY.repeat(2)).contains("a.name: it is there twice"));
    }
}
