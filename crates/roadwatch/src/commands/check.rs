//! `roadwatch check`.

use super::output::say;
use crate::{cli::ConfigArgs, failure::Failure, session::Session};
use roadwatch_camera::{Pace, PlaybackOptions, Repeat};

/// Opens everything a configuration names, and runs nothing.
pub(super) const NOT_PLAYED: PlaybackOptions = PlaybackOptions {
    pace: Pace::AsFastAsPossible,
    repeat: Repeat::Once,
    frame_limit: None,
};

/// Prints every mistake, or what is fine.
///
/// # Errors
/// The mistakes.
pub fn run(args: &ConfigArgs) -> Result<(), Failure> {
    let session = Session::open(&args.config, &args.ros.read().into(), NOT_PLAYED)?;
    let cameras: Vec<_> = session
        .rig
        .cameras()
        .iter()
        .map(|camera| camera.name.as_str())
        .collect();
    say!(
        "{}: no mistakes; {} cameras: {}",
        args.config.display(),
        cameras.len(),
        cameras.join(", ")
    );
    Ok(())
}
