//! Groups of objects that figures are given apart for.

use crate::sample::Target;

/// What objects are grouped by.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Grouping {
    /// True distance.
    Distance,
    /// Labelled class.
    Class,
    /// The dataset's own name for the kind of object.
    Label,
    /// Camera.
    Camera,
    /// Height of the labelled box.
    BoxHeight,
    /// Share outside the image.
    Truncation,
    /// Share hidden by others.
    Occlusion,
    /// True heading against the ray from the camera's foot: 0 shows the rear, 180 the front.
    ObservationAngle,
}

/// Lower ends of the bands of distance, metres. What a driver needs to know well comes in steps of ten.
pub const DISTANCE_BANDS_M: [f64; 6] = [0.0, 10.0, 20.0, 30.0, 45.0, 60.0];
/// Lower ends of the bands of box height, pixels: each about half as much again as the one before.
const BOX_HEIGHT_BANDS_PX: [f64; 6] = [0.0, 20.0, 30.0, 45.0, 70.0, 110.0];
/// Lower ends of the bands of shares, percent; the first is *clean* (docs/method.md, section 9).
const TRUNCATION_BANDS_PERCENT: [f64; 4] = [0.0, 5.0, 20.0, 50.0];
/// Bands of a full turn.
const ANGLE_BANDS: usize = 8;
/// Lower ends of the bands of shares, percent.
const OCCLUSION_BANDS_PERCENT: [f64; 4] = [0.0, 10.0, 30.0, 60.0];

impl Grouping {
    /// Every grouping, in the order of reports.
    pub const ALL: [Self; 8] = [
        Self::Distance,
        Self::Class,
        Self::Label,
        Self::Camera,
        Self::BoxHeight,
        Self::Truncation,
        Self::Occlusion,
        Self::ObservationAngle,
    ];

    /// Its key in `report.json`.
    #[must_use]
    pub const fn as_str(self) -> &'static str {
        match self {
            Self::Distance => "distance_band",
            Self::Class => "class",
            Self::Label => "label",
            Self::Camera => "camera",
            Self::BoxHeight => "box_height",
            Self::Truncation => "truncation",
            Self::Occlusion => "occlusion",
            Self::ObservationAngle => "observation_angle",
        }
    }

    /// Its heading in `report.md`.
    #[must_use]
    pub const fn title(self) -> &'static str {
        match self {
            Self::Distance => "true distance, m",
            Self::Class => "class",
            Self::Label => "the dataset's own label",
            Self::Camera => "camera",
            Self::BoxHeight => "height of the labelled box, px",
            Self::Truncation => "share outside the image, %",
            Self::Occlusion => "share hidden by others, %",
            Self::ObservationAngle => {
                "angle to the ray, degrees (0: the rear is seen, 180: the front)"
            }
        }
    }

    /// The group that an object belongs to: its place in order and its name.
    #[must_use]
    pub fn group(self, target: &Target) -> (usize, String) {
        let object = &target.object;
        let named = |name: &str| (0, name.to_owned());
        match self {
            Self::Distance => band(&DISTANCE_BANDS_M, target.range_m),
            Self::Class => named(&object.class),
            Self::Label => named(object.label.as_deref().unwrap_or("unlabelled")),
            Self::Camera => named(&target.camera),
            Self::BoxHeight => {
                let height_px = object
                    .box_px
                    .map_or(0.0, |box_px| f64::from(box_px.height_px()));
                band(&BOX_HEIGHT_BANDS_PX, height_px)
            }
            Self::Truncation => band(&TRUNCATION_BANDS_PERCENT, object.truncated * 100.0),
            Self::Occlusion => band(&OCCLUSION_BANDS_PERCENT, object.occluded * 100.0),
            Self::ObservationAngle => observation_angle(target),
        }
    }
}

/// The eighth of a turn that an object is seen in.
fn observation_angle(target: &Target) -> (usize, String) {
    let Some(yaw_rad) = target.object.yaw_rad else {
        return (ANGLE_BANDS, "unlabelled".to_owned());
    };
    let [foot_x, foot_y] = target.foot;
    let center = target.object.center;
    let ray_rad = (center.y() - foot_y).atan2(center.x() - foot_x);
    let width_deg = 360 / ANGLE_BANDS;
    let turned_deg = (yaw_rad - ray_rad).to_degrees().rem_euclid(360.0);
    // A turn's end rounds to its beginning.
    let at = (turned_deg / width_deg as f64) as usize % ANGLE_BANDS;
    (at, format!("{}-{}", at * width_deg, (at + 1) * width_deg))
}

/// The band a value falls into: from its lower end up to, but not with, the next one's.
fn band(lower_ends: &[f64], value: f64) -> (usize, String) {
    let at = lower_ends
        .iter()
        .rposition(|&low| value >= low)
        .unwrap_or(0);
    let name = match lower_ends.get(at + 1) {
        Some(high) => format!("{}-{high}", lower_ends[at]),
        None => format!("{}+", lower_ends[at]),
    };
    (at, name)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        made::{CAR_TRUTH, camera},
        truth::TruthObject,
    };

    #[test]
    fn an_object_belongs_to_the_angle_that_its_camera_sees() {
        let group = |yaw_deg: Option<f64>| {
            let object = TruthObject {
                yaw_rad: yaw_deg.map(f64::to_radians),
                ..CAR_TRUTH.clone()
            };
            let target = Target::new(&object, &camera(), true);
            Grouping::ObservationAngle.group(&target).1
        };
        assert_eq!(group(Some(0.0)), "0-45");
        assert_eq!(group(Some(181.0)), "180-225");
        assert_eq!(group(Some(-1.0)), "315-360");
        assert_eq!(group(None), "unlabelled");
    }

    #[test]
    fn a_band_holds_its_lower_end_and_the_last_has_no_upper() {
        let name = |value| band(&DISTANCE_BANDS_M, value).1;
        assert_eq!(name(0.0), "0-10");
        assert_eq!(name(9.99), "0-10");
        assert_eq!(name(10.0), "10-20");
        assert_eq!(name(59.9), "45-60");
        assert_eq!(name(250.0), "60+");
    }
}
