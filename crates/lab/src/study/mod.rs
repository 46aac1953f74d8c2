//! The paper's studies (its Fig. 3, 4, 5 and 8) repeated on simulated drives whose truth is exact, with the locators
//! that the daemon uses. docs/studies.md shows what comes out.

mod focal;
mod markdown;
mod paths;
mod report;
mod scene;
mod seen;
mod trial;
mod vehicles;
mod weights;

#[cfg(test)]
mod tests;

pub use focal::{FocalStudy, HEIGHT_ERRORS_M, Heat, PUBLISHED, Point, PublishedFocal};
pub use paths::{FEW_METRES_M, PathFigures, PathStudy, path_figures};
pub use report::StudyReportError;
pub use scene::{OpenedScene, SceneError, Shape, StudyScene};
pub use seen::{BoxSource, SeenVehicle, seen_by_detector, seen_by_labels, study_filter};
pub use trial::{MeasuredOn, TrialError};
pub use vehicles::{Group as VehicleGroup, VehicleStudy};
pub use weights::{WeightPoint, WeightStudy, WeightValue};

use trial::Bench;

/// Everything that was found; a part is `None` where its scene was not given.
#[derive(Debug, Clone)]
pub struct Study {
    /// Whose boxes were located.
    pub boxes: BoxSource,
    /// What was looked at.
    pub scenes: Vec<StudyScene>,
    /// F by eq. 1, as the paper measures it; `None` without a Y path.
    pub measured: Option<MeasuredOn>,
    /// X path and Y path (Fig. 3).
    pub paths: Vec<PathStudy>,
    /// F and heights over the grid (Fig. 4 and 5).
    pub focal: Option<FocalStudy>,
    /// The weight of eq. 7 (Fig. 8).
    pub weights: Option<WeightStudy>,
    /// Every kind of vehicle.
    pub vehicles: Option<VehicleStudy>,
}

/// Runs every part for which there is a scene. `progress` is told the name of each part as it begins.
///
/// # Errors
/// When a camera cannot offer a method, such as one that looks straight up.
pub fn study(
    scenes: Vec<StudyScene>,
    boxes: BoxSource,
    mut progress: impl FnMut(&'static str),
) -> Result<Study, TrialError> {
    let bench = Bench::new(&scenes);
    progress("X path and Y path");
    let paths = paths::study(&bench)?;
    progress("focal values and heights");
    let focal = focal::study(&bench)?;
    progress("weights of the look-up table");
    let weights = weights::study(&bench)?;
    progress("all vehicles");
    let vehicles = vehicles::study(&bench)?;
    let measured = bench.measured;
    Ok(Study {
        boxes,
        measured,
        paths,
        focal,
        weights,
        vehicles,
        scenes,
    })
}
