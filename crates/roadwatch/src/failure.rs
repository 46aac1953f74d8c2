//! How commands fail, and with which exit code.

use crate::config::Mistakes;
use roadwatch_core::error_chain;
use std::process::ExitCode;

/// `EX_CONFIG` of `sysexits.h`: a supervisor need not try again before somebody changed the configuration.
pub const EXIT_CONFIG: u8 = 78;
/// Any other failure.
pub const EXIT_FAILURE: u8 = 1;

/// A failed command.
#[derive(Debug, thiserror::Error)]
pub enum Failure {
    /// The configuration, or something it names, is wrong.
    #[error(transparent)]
    Mistakes(#[from] Mistakes),
    /// Anything else, with its causes.
    #[error("{}", error_chain(.0.as_ref()))]
    Other(#[from] anyhow::Error),
}

impl Failure {
    /// The process's exit code.
    #[must_use]
    pub fn exit_code(&self) -> ExitCode {
        ExitCode::from(match self {
            Self::Mistakes(_) => EXIT_CONFIG,
            Self::Other(_) => EXIT_FAILURE,
        })
    }
}
