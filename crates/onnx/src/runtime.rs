//! ONNX Runtime's shared library: looked for first, so that its absence is an error and not a panic.

use std::{
    path::{Path, PathBuf},
    sync::{Mutex, PoisonError},
};

/// ONNX Runtime allows one environment per process.
static LOADED: Mutex<Option<Runtime>> = Mutex::new(None);

/// ONNX Runtime, loaded. Cheap to clone; the first one loaded serves the whole process.
#[derive(Clone)]
pub struct Runtime {
    environment: ort::environment::Environment,
    library: PathBuf,
}

/// ONNX Runtime's library is absent or unfit.
#[derive(Debug, thiserror::Error)]
pub enum RuntimeError {
    /// None of the places has it.
    #[error(
        "ONNX Runtime's shared library was not found (looked at: {}); `./dev setup` fetches it, or install \
         the Python package `onnxruntime` and set ORT_DYLIB_PATH (or detector.runtime_library) to its \
         onnxruntime/capi/libonnxruntime.so.*",
        looked_at(.0)
    )]
    NotFound(Vec<PathBuf>),
    /// A file is there and does not load.
    #[error("`{path}` is not a usable ONNX Runtime library: {reason}")]
    Unusable {
        /// The file.
        path: PathBuf,
        /// What the loader said.
        reason: String,
    },
}

impl Runtime {
    /// Loads the first library of `candidates` that exists, unless this process has loaded one already.
    ///
    /// # Errors
    /// When none exists, or the first that does is not ONNX Runtime 1.22 or later.
    pub fn load(candidates: &[PathBuf]) -> Result<Self, RuntimeError> {
        let mut loaded = LOADED.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(runtime) = loaded.as_ref() {
            return Ok(runtime.clone());
        }
        let runtime = Self::load_first(candidates)?;
        *loaded = Some(runtime.clone());
        Ok(runtime)
    }

    fn load_first(candidates: &[PathBuf]) -> Result<Self, RuntimeError> {
        let Some(library) = candidates.iter().find(|path| path.is_file()) else {
            return Err(RuntimeError::NotFound(candidates.to_vec()));
        };
        let unusable = |reason: String| RuntimeError::Unusable {
            path: library.clone(),
            reason,
        };
        let environment = ort::init_from(library)
            .map_err(|error| unusable(error.to_string()))?
            .with_name("roadwatch")
            .with_telemetry(false)
            .build()
            .map_err(|error| unusable(error.to_string()))?;
        // Its warnings speak of graph nodes; what matters comes back as errors.
        environment.set_log_level(ort::logging::LogLevel::Error);
        Ok(Self {
            environment,
            library: library.clone(),
        })
    }

    /// The library's file.
    #[must_use]
    pub fn library(&self) -> &Path {
        &self.library
    }

    pub(crate) fn environment(&self) -> &ort::environment::Environment {
        &self.environment
    }
}

fn looked_at(paths: &[PathBuf]) -> String {
    if paths.is_empty() {
        return "nowhere".to_owned();
    }
    let paths: Vec<_> = paths
        .iter()
        .map(|path| path.display().to_string())
        .collect();
    paths.join(", ")
}
