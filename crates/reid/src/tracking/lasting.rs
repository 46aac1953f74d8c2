//! What fixes of one object get wrong alike: its size, the ground under it, what hides it. No number of frames averages that out.

use super::filter::{DIMS, Fix, Row, StateCovariance};
use nalgebra::{Matrix2, SMatrix, Vector2, Vector3};
use roadwatch_core::CameraId;

/// Share of a fix's variance that is new in every frame. On labelled drives, real and simulated, errors of one object from frame
/// to frame agree to 0.65 to 0.95.
const FRESH_SHARE: f64 = 0.2;
/// How long the rest lasts, seconds: the same errors half a second to three seconds apart agree to 0.8 to 0.3, the less the
/// faster the view of the object changes.
const LASTS_S: f64 = 1.0;
/// What lasts is no worse than the best fix says, as a share of the distance; a worse one adds something of its own. This much
/// of that is believed to last after all.
const WORSE_SHARE: f64 = 0.02;

/// The state by two numbers.
type StateByTwo = SMatrix<f64, DIMS, 2>;

/// Errors that last, along the ray of a fix and across it: two numbers, each counted in its deviation, that fade and come anew.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Lasting {
    /// Whose fix was the last.
    camera: CameraId,
    /// Their deviations, as shares of the distance.
    relative: Vector2<f64>,
    /// Covariance of the state with them.
    with_state: StateByTwo,
}

/// What one fix gets wrong, in the steady frame.
#[derive(Clone, Copy, Debug)]
pub(super) struct Errors {
    camera: CameraId,
    /// Deviations of what lasts, as shares of the distance.
    relative: Vector2<f64>,
    /// By the two errors that last.
    lasting: Matrix2<f64>,
    /// Covariance of what is new.
    fresh: Matrix2<f64>,
}

impl Errors {
    /// Of all together.
    pub(super) fn covariance(&self) -> Matrix2<f64> {
        self.fresh + self.lasting * self.lasting.transpose()
    }
}

impl Lasting {
    /// After the first fix, which the place is taken from, with what that gets wrong.
    pub(super) fn of(fix: &Fix) -> (Self, Errors) {
        let mut lasting = Self {
            camera: fix.camera,
            relative: Vector2::repeat(f64::INFINITY),
            with_state: StateByTwo::zeros(),
        };
        let errors = lasting.errors(fix);
        lasting.relative = errors.relative;
        lasting
            .with_state
            .fixed_rows_mut::<2>(0)
            .copy_from(&-errors.lasting);
        (lasting, errors)
    }

    /// Parts what a fix gets wrong into what lasts and what is new.
    pub(super) fn errors(&self, fix: &Fix) -> Errors {
        let away = fix.place - fix.eye;
        let distance_m = away.norm().max(f64::EPSILON);
        let along = away / distance_m;
        let from_ray = Matrix2::new(along.x, -along.y, along.y, along.x);
        let spread = from_ray.transpose() * fix.spread() * from_ray;
        let deviations = spread.diagonal().map(f64::sqrt);
        let relative = self
            .relative
            .zip_map(&(deviations / distance_m), |best, now| {
                if now < best {
                    now
                } else {
                    best + (now - best) * WORSE_SHARE
                }
            });
        let lasting = relative * distance_m * (1.0 - FRESH_SHARE).sqrt();
        let fresh = lasting.zip_map(&deviations, |lasting, all| {
            (1.0 - (lasting / all).powi(2)).max(0.0).sqrt()
        });
        let fresh = spread.component_mul(&(fresh * fresh.transpose()));
        Errors {
            camera: fix.camera,
            relative,
            lasting: from_ray * Matrix2::from_diagonal(&lasting),
            fresh: from_ray * fresh * from_ray.transpose(),
        }
    }

    /// Some time later.
    pub(super) fn predict(&mut self, step: &StateCovariance, seconds: f64) {
        self.with_state = step * self.with_state * (-seconds / LASTS_S).exp();
    }

    /// Covariance of the state with a fix, by what lasts.
    pub(super) fn shared_with(&self, errors: &Errors) -> StateByTwo {
        self.with_state * errors.lasting.transpose()
    }

    /// Covariance of the place some time later with a fix, by what lasts; the place is made of the state's first numbers by `step`.
    pub(super) fn shared_after(
        &self,
        seconds: f64,
        step: &Vector3<f64>,
        errors: &Errors,
    ) -> Matrix2<f64> {
        // Another camera's fixes need not err alike.
        if errors.camera != self.camera {
            return Matrix2::zeros();
        }
        let part = |at: usize| self.with_state.fixed_rows::<2>(2 * at) * step[at];
        let place: Matrix2<f64> = part(0) + part(1) + part(2);
        place * errors.lasting.transpose() * (-seconds / LASTS_S).exp()
    }

    /// After a fix corrected the place by a gain.
    pub(super) fn correct(&mut self, gain: &StateByTwo, errors: &Errors) {
        let place = self.with_state.fixed_rows::<2>(0) + errors.lasting;
        self.with_state -= gain * place;
        self.relative = errors.relative;
        self.camera = errors.camera;
    }

    /// After something that depends on the state by `by` corrected it by a gain.
    pub(super) fn correct_by(&mut self, by: &Row, gain: &SMatrix<f64, DIMS, 1>) {
        self.with_state -= gain * (by * self.with_state);
    }

    /// After a number of the state was set anew.
    pub(super) fn forget(&mut self, number: usize) {
        self.with_state.row_mut(number).fill(0.0);
    }
}

#[cfg(test)]
mod tests {
    use super::{
        super::filter::{Filter, VEHICLE},
        *,
    };

    /// Along the ray a metre, across it a tenth, with its axes turned a little out of it.
    fn fix(place: Vector2<f64>, scale: f64) -> Fix {
        let (sin, cos) = (place.y.atan2(place.x) + 0.1).sin_cos();
        let turn = Matrix2::new(cos, -sin, sin, cos);
        Fix {
            camera: CameraId(0),
            eye: Vector2::zeros(),
            place,
            covariance: turn * Matrix2::new(scale, 0.0, 0.0, 0.01 * scale) * turn.transpose(),
        }
    }

    #[test]
    fn what_lasts_and_what_is_new_are_all_that_a_fix_gets_wrong() {
        let fix = fix(Vector2::new(12.0, 16.0), 1.0);
        let (lasting, errors) = Lasting::of(&fix);
        assert!((errors.covariance().trace() - fix.spread().trace()).abs() < 1e-9);
        // Of one that claims more, the more is its own.
        let worse = lasting.errors(&Fix {
            covariance: fix.covariance * 9.0,
            ..fix.clone()
        });
        let lasts = |errors: &Errors| (errors.lasting * errors.lasting.transpose()).trace();
        assert!((1.0..1.2).contains(&(lasts(&worse) / lasts(&errors))));
        assert!(worse.fresh.trace() > 8.0 * errors.fresh.trace());
    }

    #[test]
    fn a_second_of_fixes_does_not_average_out_what_they_share() {
        let place = Vector2::new(20.0, 0.0);
        let mut filter = Filter::new(&fix(place, 1.0), VEHICLE);
        for _ in 0..10 {
            filter.predict(0.1);
            filter.correct(&fix(place, 1.0));
        }
        let variance = filter.position_covariance()[(0, 0)];
        assert!((0.5..1.0).contains(&variance), "{variance}");
    }

    #[test]
    fn covariances_stay_covariances_whatever_is_claimed() {
        let mut filter = Filter::new(&fix(Vector2::new(60.0, 5.0), 30.0), VEHICLE);
        for step in 1..200_u32 {
            filter.predict(0.05);
            let at = f64::from(step);
            let place = Vector2::new(60.0 - 0.25 * at, 5.0 + at.sin());
            filter.correct(&fix(place, [0.2, 3.0, 40.0][step as usize % 3]));
            filter.keep_to_heading();
            let eigenvalues = filter.covariance.symmetric_eigenvalues();
            assert!(eigenvalues.min() > -1e-9, "{step}: {eigenvalues}");
        }
    }
}
