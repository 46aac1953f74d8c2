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
    say!("{}", where_the_vehicle_is(&session));
    Ok(())
}

fn where_the_vehicle_is(session: &Session) -> String {
    let (ego, taken) = (&session.config.ego, session.ego.counts().taken);
    match ego.told_by(taken > 0) {
        None => "where the vehicle is: nobody tells it, so it counts as standing".to_owned(),
        Some(by) if ego.is_live() => {
            format!("where the vehicle is: {by}, which only `run` listens to")
        }
        Some(by) if taken == 0 => format!("where the vehicle is: {by}"),
        Some(by) => format!("where the vehicle is: {by}, {taken} poses"),
    }
}
