//! The fit behind [`crate::mount_drive`]: what boxes say of a pitch, a scale and a roll.

use crate::{
    drive::BoxSighting,
    least_squares::{Minimum, Normal, minimise},
    mount_drive::{DriveError, DriveFit, DriveOptions, LEAST_BOXES, LEAST_TRACKS, Trust},
    mount_estimate::{MountEstimate, MountStd},
    size_model::{Predicted, SizeModel},
    track_effect::{Residual, Track},
};
use nalgebra::{DMatrix, DVector};
use roadwatch_core::{Mount, RigCamera};

/// More boxes cost time and, being of the same objects, tell little more.
const MOST_BOXES: usize = 1500;
/// How far the pitch may be off at the start, radians, and how finely it is searched (4 and 0.5 degrees).
const SEARCH_RAD: f64 = 0.07;
const SEARCH_STEP_RAD: f64 = 0.00875;
/// Boxes used for the search.
const SEARCH_BOXES: usize = 200;
/// Steps of slopes: radians, and shares.
const STEPS: [f64; 3] = [1e-4, 1e-4, 1e-4];
/// Rounds of fits, each with the noise that the last mount gives.
const ROUNDS: usize = 4;
/// A box that the mount puts above the horizon costs what four deviations do.
const LOST_COST: f64 = 4.0;
/// Sizes that are said to be exact still spread a little: a share of the height.
const LEAST_SPREAD: f64 = 1e-3;

/// Parameters are: pitch by which the mount is moved, logarithm of the scale, and roll where it is free.
pub(crate) struct Fit<'a> {
    camera: &'a RigCamera,
    start: Mount,
    ground_z_m: f64,
    boxes: Vec<&'a BoxSighting>,
    tracks: usize,
    options: &'a DriveOptions,
}

impl<'a> Fit<'a> {
    pub(crate) fn new(
        camera: &'a RigCamera,
        ground_z_m: f64,
        all: &'a [BoxSighting],
        options: &'a DriveOptions,
    ) -> Result<Self, DriveError> {
        let mut boxes: Vec<_> = all
            .iter()
            .step_by(all.len().div_ceil(MOST_BOXES).max(1))
            .collect();
        // Boxes of one object stand together.
        boxes.sort_by_key(|sighting| sighting.track);
        let tracks = boxes.chunk_by(|a, b| a.track == b.track).count();
        if boxes.len() < LEAST_BOXES || tracks < LEAST_TRACKS {
            let boxes = boxes.len();
            return Err(DriveError::TooFew { boxes, tracks });
        }
        SizeModel::new(camera, ground_z_m).ok_or(DriveError::NoGround)?;
        Ok(Self {
            camera,
            start: Mount::of(&camera.base_from_optical),
            ground_z_m,
            boxes,
            tracks,
            options,
        })
    }

    fn mount(&self, at: &DVector<f64>) -> Mount {
        let mut mount = self.start;
        mount.pitch_rad += at[0];
        mount.roll_rad += at.get(2).copied().unwrap_or(0.0);
        if self.options.trust == Trust::Sizes {
            let height_m = (mount.position_m[2] - self.ground_z_m) * at[1].exp();
            mount.position_m[2] = self.ground_z_m + height_m;
        }
        mount
    }

    fn model(&self, at: &DVector<f64>) -> Option<SizeModel> {
        let moved = RigCamera {
            base_from_optical: self.mount(at).base_from_optical(),
            ..self.camera.clone()
        };
        SizeModel::new(&moved, self.ground_z_m)
    }

    /// Logarithm of the height over the predicted one.
    fn off(&self, at: &DVector<f64>, sighting: &BoxSighting, predicted: &Predicted) -> f64 {
        let scale = match self.options.trust {
            Trust::Sizes => 0.0,
            Trust::Height => at[1],
        };
        f64::from(sighting.seen.box_px.height_px()).ln() - predicted.log_height - scale
    }

    /// What every box says at a place; `None` for those that are not below the horizon there.
    fn offs(&self, at: &DVector<f64>) -> Option<Vec<Option<(f64, Predicted)>>> {
        let model = self.model(at)?;
        let all = self.boxes.iter().map(|sighting| {
            let predicted = model.predict(&sighting.seen, &self.options.noise)?;
            Some((self.off(at, sighting, &predicted), predicted))
        });
        Some(all.collect())
    }

    /// The best of the pitches around the start, each with the scale that suits the median box.
    pub(crate) fn search(&self) -> DVector<f64> {
        let few: Vec<_> = (self.boxes.iter())
            .step_by(self.boxes.len().div_ceil(SEARCH_BOXES))
            .copied()
            .collect();
        let fit = Fit {
            boxes: few,
            ..*self
        };
        let steps = (SEARCH_RAD / SEARCH_STEP_RAD).round() as i32;
        let tried = (-steps..=steps).filter_map(|step| {
            let pitch = f64::from(step) * SEARCH_STEP_RAD;
            let level = DVector::from_vec(vec![pitch, 0.0, 0.0]);
            let offs = fit.offs(&level)?;
            let mut known: Vec<f64> = offs.iter().flatten().map(|(off, _)| *off).collect();
            let scale = median(&mut known)?;
            let lost = offs.len() - known.len();
            let spread: f64 = known.iter().map(|off| (off - scale).abs().min(1.0)).sum();
            // Taller boxes than predicted mean nearer ones: a lower camera, or larger objects.
            let scale = match self.options.trust {
                Trust::Sizes => -scale,
                Trust::Height => scale,
            };
            Some((
                spread + lost as f64,
                DVector::from_vec(vec![pitch, scale, 0.0]),
            ))
        });
        let best = tried.min_by(|a, b| a.0.total_cmp(&b.0));
        best.map_or_else(|| DVector::zeros(3), |(_, at)| at)
    }

    pub(crate) fn solve(&self, start: DVector<f64>, parameters: usize) -> Option<Minimum> {
        let mut at = start.rows(0, parameters).into_owned();
        let mut found = None;
        for _ in 0..ROUNDS {
            let noise = self.noise(&at)?;
            let normal = |at: &DVector<f64>| self.normal(at, &noise);
            let round = minimise(at, &normal)?;
            at = round.at.clone();
            found = Some(round);
        }
        found
    }

    /// Standard deviation of each box's disagreement, apart from its object's size.
    fn noise(&self, at: &DVector<f64>) -> Option<Vec<f64>> {
        let offs = self.offs(at)?;
        let all = self.boxes.iter().zip(offs).map(|(sighting, off)| {
            let predicted = off.map(|(_, predicted)| predicted);
            predicted.map_or(1.0, |predicted| self.noise_of(sighting, &predicted))
        });
        Some(all.collect())
    }

    /// `ln(h / b)` moves by `1/h - 1/b` per pixel of the bottom edge, `1/h` per pixel of the top edge, and
    /// `fy / b` per radian of pitch.
    fn noise_of(&self, sighting: &BoxSighting, predicted: &Predicted) -> f64 {
        let b = predicted.below_horizon_px;
        let h = f64::from(sighting.seen.box_px.height_px());
        let edge_px = self.options.noise.edge_std_px(&sighting.seen.box_px);
        let slope_px = self.camera.model.intrinsics.fy * self.options.slope_std_rad;
        let edges = (edge_px / h).hypot(edge_px * (1.0 / h - 1.0 / b));
        edges.hypot(slope_px / b).hypot(predicted.heading_std)
    }

    fn normal(&self, at: &DVector<f64>, noise: &[f64]) -> Option<Normal> {
        let here = self.offs(at)?;
        let mut moved = Vec::with_capacity(at.len());
        for (parameter, step) in STEPS.iter().enumerate().take(at.len()) {
            let mut place = at.clone();
            place[parameter] += step;
            moved.push(self.offs(&place)?);
        }
        let residual = |index: usize| {
            let (off, _) = here[index]?;
            let slope: Option<Vec<f64>> = moved
                .iter()
                .zip(STEPS)
                .map(|(moved, step)| Some((moved[index]?.0 - off) / step))
                .collect();
            Some(Residual {
                off,
                slope: DVector::from_vec(slope?),
                std: noise[index],
            })
        };
        let mut normal = Normal::zero(at.len());
        let mut first = 0;
        for boxes in self.boxes.chunk_by(|a, b| a.track == b.track) {
            let residuals: Vec<_> = (first..first + boxes.len()).filter_map(residual).collect();
            normal.cost += LOST_COST * (boxes.len() - residuals.len()) as f64;
            first += boxes.len();
            let size = &boxes[0].seen.size;
            let spread = (size.std_dev.height_m / size.size.height_m).max(LEAST_SPREAD);
            Track::new(&residuals, spread).add_to(&mut normal);
        }
        Some(normal)
    }

    /// Of pitch, scale and roll; a roll that is held has none and stands as infinite.
    pub(crate) fn deviations(&self, found: &Minimum) -> Option<[f64; 3]> {
        let covariance: DMatrix<f64> = found.covariance()?;
        let of = |at: usize| covariance[(at, at)].sqrt();
        // Where the height is trusted, the mean size is what is found.
        let mean_size_std = match self.options.trust {
            Trust::Sizes => self.options.mean_size_std,
            Trust::Height => 0.0,
        };
        let roll = if covariance.nrows() > 2 {
            of(2)
        } else {
            f64::INFINITY
        };
        Some([of(0), of(1).hypot(mean_size_std), roll])
    }

    pub(crate) fn result(&self, at: &DVector<f64>, std: &[f64; 3]) -> DriveFit {
        let mount = self.mount(at);
        let mut estimate = MountEstimate {
            mount,
            std: MountStd {
                pitch_rad: Some(std[0]),
                roll_rad: std[2].is_finite().then_some(std[2]),
                ..MountStd::default()
            },
        };
        let height_m = mount.position_m[2] - self.ground_z_m;
        let size_ratio = match self.options.trust {
            Trust::Sizes => {
                estimate.std.position_m[2] = Some(height_m * std[1]);
                (1.0, None)
            }
            Trust::Height => (at[1].exp(), Some(at[1].exp() * std[1])),
        };
        DriveFit {
            estimate,
            size_ratio,
            boxes: self.boxes.len(),
            tracks: self.tracks,
            disagreement: [self.disagreement(&DVector::zeros(2)), self.disagreement(at)],
        }
    }

    /// Boxes above the horizon disagree wholly.
    fn disagreement(&self, at: &DVector<f64>) -> f64 {
        let offs = self.offs(at).unwrap_or_default();
        let mut all: Vec<f64> = offs
            .iter()
            .map(|off| off.map_or(1.0, |(off, _)| off.exp_m1().abs()))
            .collect();
        median(&mut all).unwrap_or(1.0)
    }
}

fn median(values: &mut [f64]) -> Option<f64> {
    values.sort_by(f64::total_cmp);
    values.get(values.len() / 2).copied()
}
