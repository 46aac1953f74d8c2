//! Whether an object stands, and where it is if it does.

use super::filter::{DIMS, Filter, HEADING, TURN, VELOCITY};
use nalgebra::{Matrix2, SMatrix};

/// Share of objects that are believed to stand before anything was seen of their motion. More do in cities; but who is wrongly
/// said to stand is worse than who is said to creep, and a car that comes straight on seems to stand at first.
const STANDING: f64 = 0.01;
/// What stands seems to move at this speed, metres per second: its centre is what is seen of it.
const STANDING_M_S: f64 = 0.1;

impl Filter {
    /// The belief, if it may also stand: the mean and covariance of both, by their chances. The chance that it stands is the
    /// density of the velocity at nothing, against what it was before anything was seen (Savage and Dickey; Dickey 1971).
    pub(super) fn or_standing(mut self) -> Self {
        let velocity = self.velocity();
        let spread = self.velocity_covariance() + Matrix2::identity() * STANDING_M_S.powi(2);
        let Some(inverse) = spread.try_inverse() else {
            return self;
        };
        let squared = velocity.dot(&(inverse * velocity));
        let stands = STANDING * (-0.5 * squared).exp() / spread.determinant().sqrt();
        let moves = (1.0 - STANDING) / self.mobility.speed_std_m_s.powi(2);
        let chance = stands / (stands + moves);
        let with_velocity = self.covariance.fixed_columns::<2>(VELOCITY).into_owned();
        let mut gain: SMatrix<f64, DIMS, 2> = with_velocity * inverse;
        // Which way it points does not depend on that.
        gain.row_mut(HEADING).fill(0.0);
        gain.row_mut(TURN).fill(0.0);
        let step = gain * velocity;
        self.mean -= step * chance;
        self.covariance +=
            (step * step.transpose() * (1.0 - chance) - gain * spread * gain.transpose()) * chance;
        self
    }
}

#[cfg(test)]
mod tests {
    use super::{
        super::filter::{Fix, VEHICLE},
        *,
    };
    use nalgebra::Vector2;
    use roadwatch_core::CameraId;

    /// Seen ten times a second, as it moves along x.
    fn seen(speed_m_s: f64, seconds: f64) -> Filter {
        let fix = |at: f64| Fix {
            camera: CameraId(0),
            eye: Vector2::zeros(),
            place: Vector2::new(20.0 + speed_m_s * at, 5.0),
            covariance: Matrix2::new(1.0, 0.0, 0.0, 0.05),
        };
        let mut filter = Filter::new(&fix(0.0), VEHICLE);
        for step in 1..=(seconds * 10.0) as u32 {
            filter.predict(0.1);
            filter.correct(&fix(f64::from(step) / 10.0));
        }
        filter
    }

    #[test]
    fn what_stays_where_it_is_stands_and_its_place_is_better_known_for_it() {
        let filter = seen(0.0, 4.0);
        let both = filter.clone().or_standing();
        assert!(both.velocity().norm() <= filter.velocity().norm());
        let trace = |filter: &Filter| filter.position_covariance().trace();
        assert!(trace(&both) < trace(&filter));
        let speed = |filter: &Filter| filter.velocity_covariance().trace();
        assert!(speed(&both) < 0.5 * speed(&filter));
    }

    #[test]
    fn nobody_who_moves_is_said_to_stand() {
        let filter = seen(5.0, 4.0);
        let both = filter.clone().or_standing();
        assert!((both.velocity() - filter.velocity()).norm() < 1e-6);
        assert!((both.covariance - filter.covariance).norm() < 1e-6);
    }

    #[test]
    fn at_first_sight_nobody_knows() {
        let filter = seen(0.0, 0.0);
        let both = filter.clone().or_standing();
        let trace = |filter: &Filter| filter.velocity_covariance().trace();
        assert!(trace(&both) > 0.9 * trace(&filter));
    }
}
