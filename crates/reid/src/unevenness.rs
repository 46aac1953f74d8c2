//! How uneven the ground is, from how much what boxes say of it scatters.

use nalgebra::SVector;
use roadwatch_core::GroundReading;

const HYPOTHESES: usize = 5;
/// What is thought possible: deviations of slopes against the configured ones. Car parks and motorways are level within a
/// tenth of a degree, hilly streets slope by two degrees to their sides.
const UNEVENNESS: [f64; HYPOTHESES] = [2.0, 1.0, 0.5, 0.25, 0.125];
/// How likely each is beforehand. Their mean square is 1: nobody knows better than the configuration at first.
const BEFOREHAND: [f64; HYPOTHESES] = [0.1, 0.55, 0.15, 0.1, 0.1];
/// Share of readings that are mistaken: a foot is hidden, a class is wrong.
const MISTAKEN: f64 = 0.1;
/// Mistaken readings scatter by this many deviations of the most uneven ground.
const MISTAKEN_STD_DEVS: f64 = 2.0;

/// What is past says no more than this against what is now, as a difference of log-likelihoods: a car park that is left for a hill
/// is outvoted by a few cars there.
const MOST_OF_PAST: f64 = 4.0;

/// What readings say of each hypothesis: sums of log-likelihoods.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Unevenness(SVector<f64, HYPOTHESES>);

impl Unevenness {
    /// Nobody said anything.
    pub(crate) const NOTHING: Self = Self(SVector::<f64, HYPOTHESES>::from_array_storage(
        nalgebra::ArrayStorage([[0.0; HYPOTHESES]]),
    ));

    /// What one reading says.
    pub(crate) fn of(reading: &GroundReading) -> Self {
        let alike = reading.by_box_m.hypot(reading.by_mean_size_m);
        let density = |std_dev_m: f64| {
            let deviations = reading.height_m / std_dev_m;
            (-0.5 * deviations * deviations).exp() / std_dev_m
        };
        let on = |unevenness: f64| alike.hypot(unevenness * reading.configured_m);
        let mistaken = MISTAKEN * density(MISTAKEN_STD_DEVS * on(UNEVENNESS[0]));
        let says = UNEVENNESS
            .map(|unevenness| ((1.0 - MISTAKEN) * density(on(unevenness)) + mistaken).ln());
        let says = SVector::from(says);
        // Only differences count; so nothing is far from zero.
        let middle = says.mean();
        Self(says.add_scalar(-middle))
    }

    /// Both, each that many times.
    pub(crate) fn blend(&self, times: f64, other: &Self, other_times: f64) -> Self {
        Self(self.0 * times + other.0 * other_times)
    }

    /// The same, no surer than what is past may be.
    pub(crate) fn of_past(&self) -> Self {
        let difference = self.0.max() - self.0.min();
        Self(self.0 * (MOST_OF_PAST / difference.max(MOST_OF_PAST)))
    }

    /// How uneven the ground is: root of the mean square over the hypotheses.
    pub(crate) fn expected(&self) -> f64 {
        let most = self.0.max();
        let (mut square, mut sum) = (0.0, 0.0);
        for (at, beforehand) in BEFOREHAND.iter().enumerate() {
            let weight = beforehand * (self.0[at] - most).exp();
            square += weight * UNEVENNESS[at] * UNEVENNESS[at];
            sum += weight;
        }
        (square / sum).sqrt()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::Vector2;

    /// An object 25 m ahead, its box good for 12 cm, on ground that is expected to be within 35 cm.
    fn reading(height_m: f64) -> GroundReading {
        GroundReading {
            place: Vector2::new(25.0, 0.0),
            height_m,
            std_dev_m: 0.3,
            by_mean_size_m: 0.08,
            by_side_m: 0.1,
            by_box_m: 0.12,
            configured_m: 0.35,
        }
    }

    fn after(heights_m: impl IntoIterator<Item = f64>) -> f64 {
        let all = heights_m
            .into_iter()
            .map(|height_m| Unevenness::of(&reading(height_m)));
        let sum = all.fold(Unevenness::NOTHING, |sum, one| sum.blend(1.0, &one, 1.0));
        sum.expected()
    }

    #[test]
    fn ground_is_as_configured_before_anything_is_seen() {
        assert!((after([]) - 1.0).abs() < 0.01);
    }

    #[test]
    fn objects_that_scatter_by_their_boxes_alone_stand_on_even_ground() {
        // As wide as their own deviation, in five equal parts.
        let alone = [-1.28, -0.52, 0.0, 0.52, 1.28].map(|std_devs| std_devs * 0.144);
        assert!(after(alone) < 0.75);
        assert!(after(alone.repeat(4)) < 0.3, "{}", after(alone.repeat(4)));
    }

    #[test]
    fn objects_up_and_down_stand_on_uneven_ground() {
        let hills = [-0.5, 0.4, -0.3, 0.6, 0.45, -0.4];
        assert!((0.9..1.6).contains(&after(hills)), "{}", after(hills));
    }

    #[test]
    fn a_level_hour_is_outvoted_by_a_few_objects_on_a_hill() {
        let sum = |heights_m: &[f64]| {
            let all = heights_m
                .iter()
                .map(|height_m| Unevenness::of(&reading(*height_m)));
            all.fold(Unevenness::NOTHING, |sum, one| sum.blend(1.0, &one, 1.0))
        };
        let level = sum(&[0.05; 200]);
        assert!(level.expected() < 0.2);
        let past = level.of_past();
        assert!(past.expected() < 0.7, "{}", past.expected());
        let hill = sum(&[-0.5, 0.4, -0.45, 0.6]);
        let both = past.blend(1.0, &hill, 1.0);
        assert!(both.expected() > 0.8, "{}", both.expected());
    }

    #[test]
    fn one_hidden_foot_among_many_is_no_hill() {
        let mut seen = vec![0.05; 20];
        let level = after(seen.clone());
        seen.push(0.9);
        assert!(after(seen) < 1.2 * level);
    }
}
