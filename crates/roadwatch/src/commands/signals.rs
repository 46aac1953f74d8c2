//! A stop that somebody asks for.

use crate::failure::Failure;
use anyhow::Context as _;
use signal_hook::{
    consts::{SIGINT, SIGTERM},
    flag,
};
use std::sync::{Arc, atomic::AtomicBool};

/// Becomes true with the first signal that asks for an end.
///
/// # Errors
/// When the system does not let signals be handled.
pub(super) fn stop_on_signals() -> Result<Arc<AtomicBool>, Failure> {
    let stop = Arc::new(AtomicBool::new(false));
    for signal in [SIGINT, SIGTERM] {
        // A second signal ends the process at once, should the first not help.
        flag::register_conditional_default(signal, Arc::clone(&stop))
            .context("signals cannot be handled")?;
        flag::register(signal, Arc::clone(&stop)).context("signals cannot be handled")?;
    }
    Ok(stop)
}
