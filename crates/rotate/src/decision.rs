//! From all that is known of an object's direction to one heading.

use crate::{
    angle::{RayAngle, Yaw},
    forest::Turned,
    row::Row,
};
use arrayvec::ArrayVec;
use roadwatch_core::{
    Heading, HeadingCandidate, Location, angle::wrapped, location::MAX_HEADING_CANDIDATES,
};
use std::f64::consts::{FRAC_PI_2, PI, TAU};

/// None of the headings that a place allows is right this often: another size than expected, a hidden end.
const PLACE_FAILS: f64 = 0.1;
/// A forest is wrong altogether this often: components of another car, a kind of vehicle it never saw.
const FOREST_FAILS: f64 = 0.1;
/// So is what the model sees at once.
const FACING_FAILS: f64 = 0.1;
/// The heading an object had is another object's, or from before a turn.
const PRIOR_FAILS: f64 = 0.2;
/// Those of a place, the forest's, and its opposite.
const MOST_CANDIDATES: usize = MAX_HEADING_CANDIDATES + 2;
/// The forest sharpens a heading that it agrees with to this, radians: beyond, it means another one.
const AGREES_WITHIN_RAD: f64 = 0.5;
/// No forest is better than this on photographs, radians: it was grown on simulated ones.
const LEAST_FOREST_STD_RAD: f64 = 0.1;

/// The likeliest heading of an object, its deviation, and how likely it is to be turned round.
///
/// Candidates are the headings that the object's place allows ([`Location::headings`]), each sharpened by the forest
/// where both mean the same, and what the forest says by itself, should the place's all be wrong. Each weighs as much
/// as its place, the forest, the model's direct look and the axis of the heading that the object had agree with it; each
/// of these may fail. Front and back are what this look shows: who remembers headings weighs look against look.
#[must_use]
pub fn decide(
    location: &Location,
    ray: RayAngle,
    (row, turned): (&Row, &Turned),
    before: Option<&Heading>,
) -> Heading {
    let forest = Heading {
        yaw_rad: turned.angle.seen_along(ray).radians(),
        std_dev_rad: turned.std_dev_rad.max(LEAST_FOREST_STD_RAD),
        flip_probability: turned.flip_share,
    };
    let mut candidates: ArrayVec<_, MOST_CANDIDATES> = of_place(location, &forest);
    candidates.extend(of_forest(&forest, location.headings.is_empty()));
    let axis = before.map(|before| Heading {
        flip_probability: 0.5,
        ..*before
    });
    let weigh = |(candidate, weight): &(Heading, f64)| {
        let by_look = (1.0 - FACING_FAILS) * facing(row, candidate, ray) + FACING_FAILS;
        let by_memory = axis
            .as_ref()
            .map_or(1.0, |axis| likelihood(axis, candidate, PRIOR_FAILS));
        weight * by_look * by_memory
    };
    let weights: ArrayVec<f64, MOST_CANDIDATES> = candidates.iter().map(weigh).collect();
    let sum: f64 = weights.iter().sum();
    let side = |at: usize| Side::of(&candidates, &weights, &candidates[at].0);
    // The likeliest heading among those that more is for than against.
    let best = (0..weights.len()).max_by(|&a, &b| {
        let believed = |at: usize| (side(at).mass / sum).min(0.5);
        let by_side = believed(a).total_cmp(&believed(b));
        by_side.then(weights[a].total_cmp(&weights[b]))
    });
    let Some(best) = best.filter(|_| sum > 0.0) else {
        return forest;
    };
    let (chosen, Side { mass, spread }) = (candidates[best].0, side(best));
    Heading {
        std_dev_rad: chosen.std_dev_rad.hypot((spread / mass).sqrt()),
        flip_probability: (1.0 - mass / sum).clamp(0.0, 0.5),
        ..chosen
    }
}

/// What points the same way as a heading, to a quarter turn.
struct Side {
    /// Sum of weights.
    mass: f64,
    /// Sum of weighted squared angles between, square radians.
    spread: f64,
}

impl Side {
    fn of(candidates: &[(Heading, f64)], weights: &[f64], heading: &Heading) -> Self {
        let mut side = Self {
            mass: 0.0,
            spread: 0.0,
        };
        for ((candidate, _), weight) in candidates.iter().zip(weights) {
            let apart = wrapped(candidate.yaw_rad - heading.yaw_rad);
            if apart.abs() <= FRAC_PI_2 {
                side.mass += weight;
                side.spread += weight * apart * apart;
            }
        }
        side
    }
}

/// The headings that a place allows, weighed by the forest and sharpened by it.
fn of_place(location: &Location, forest: &Heading) -> ArrayVec<(Heading, f64), MOST_CANDIDATES> {
    let weigh = |HeadingCandidate { heading, weight }: &HeadingCandidate| {
        let by_forest = likelihood(forest, heading, FOREST_FAILS);
        let weight = (1.0 - PLACE_FAILS) * weight * by_forest;
        (sharpened(heading, forest), weight)
    };
    location.headings.iter().map(weigh).collect()
}

/// What the forest says by itself, and its opposite, by the chance of that; `alone` where a place allows anything.
fn of_forest(forest: &Heading, alone: bool) -> [(Heading, f64); 2] {
    let share = if alone { 1.0 } else { PLACE_FAILS };
    let flipped = forest.flip_probability;
    [(0.0, 1.0 - flipped), (PI, flipped)].map(|(turn, probability)| {
        let heading = Heading {
            yaw_rad: wrapped(forest.yaw_rad + turn),
            flip_probability: 0.0,
            ..*forest
        };
        (heading, share * (1.0 - FOREST_FAILS) * probability)
    })
}

/// How likely `said` makes a heading, relative to all being alike; a share `fails` of its answers means nothing.
fn likelihood(said: &Heading, heading: &Heading, fails: f64) -> f64 {
    let variance = said.std_dev_rad.powi(2) + heading.std_dev_rad.powi(2);
    let height = TAU / (TAU * variance).sqrt();
    let near = |turn: f64| {
        let apart = wrapped(heading.yaw_rad - said.yaw_rad - turn);
        height * (-0.5 * apart * apart / variance).exp()
    };
    let flipped = said.flip_probability;
    (1.0 - fails) * ((1.0 - flipped) * near(0.0) + flipped * near(PI)) + fails
}

/// How likely the model's direct look makes a heading, over the heading's deviation.
fn facing(row: &Row, heading: &Heading, ray: RayAngle) -> f64 {
    let sides = [-1.0, 0.0, 1.0].map(|deviations| {
        let yaw = Yaw::new(heading.yaw_rad + deviations * heading.std_dev_rad);
        row.facing_likelihood(yaw.seen_along(ray))
    });
    sides.iter().sum::<f64>() / sides.len() as f64
}

/// The mean of a heading and the forest's, by their variances, where they mean the same.
fn sharpened(heading: &Heading, forest: &Heading) -> Heading {
    let apart = wrapped(forest.yaw_rad - heading.yaw_rad);
    if apart.abs() > AGREES_WITHIN_RAD {
        return *heading;
    }
    let (own, other) = (heading.std_dev_rad.powi(2), forest.std_dev_rad.powi(2));
    let share = own / (own + other).max(f64::MIN_POSITIVE);
    Heading {
        yaw_rad: wrapped(heading.yaw_rad + share * apart),
        std_dev_rad: (own * other / (own + other).max(f64::MIN_POSITIVE)).sqrt(),
        ..*heading
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::angle::ObservationAngle;
    use nalgebra::Matrix3;
    use roadwatch_core::{
        Method, SizeLwh,
        space::{Covariance, Point},
    };

    fn heading(deg: f64, flip_probability: f64) -> Heading {
        Heading {
            yaw_rad: deg.to_radians(),
            std_dev_rad: 5.0_f64.to_radians(),
            flip_probability,
        }
    }

    fn location(candidates: &[(f64, f64)]) -> Location {
        let candidate = |&(deg, weight): &(f64, f64)| HeadingCandidate {
            heading: heading(deg, 0.0),
            weight,
        };
        Location {
            position: Point::new(20.0, 0.0, 0.8),
            covariance: Covariance::new(Matrix3::identity()),
            depth_m: 20.0,
            range_m: 20.0,
            size: SizeLwh {
                length_m: 4.6,
                width_m: 1.85,
                height_m: 1.6,
            },
            method: Method::Fused,
            headings: candidates.iter().map(candidate).collect(),
            ground: None,
            held: false,
        }
    }

    fn turned(deg: f64, flip_share: f64) -> Turned {
        Turned {
            angle: ObservationAngle::new(deg.to_radians()),
            std_dev_rad: 0.3,
            flip_share,
        }
    }

    /// Eight directions, one of them seen.
    fn looks(bin: usize) -> Row {
        let mut facing = vec![0.02; 8];
        facing[bin] = 0.86;
        Row {
            facing,
            ..Row::default()
        }
    }

    const FOUR: [(f64, f64); 4] = [(10.0, 0.25), (-10.0, 0.25), (170.0, 0.25), (-170.0, 0.25)];

    #[test]
    fn parts_choose_among_the_headings_that_the_place_allows() {
        let ray = RayAngle::towards(1.0, 0.0);
        let found = decide(
            &location(&FOUR),
            ray,
            (&looks(4), &turned(160.0, 0.1)),
            None,
        );
        assert!((found.yaw_rad.to_degrees() - 170.0).abs() < 3.0);
        assert!(found.flip_probability < 0.05);
        let back = decide(
            &location(&FOUR),
            ray,
            (&looks(0), &turned(-20.0, 0.1)),
            None,
        );
        assert!((back.yaw_rad.to_degrees() + 10.0).abs() < 3.0);
    }

    #[test]
    fn a_sure_forest_stands_against_a_place_whose_headings_are_all_wrong() {
        let ray = RayAngle::towards(1.0, 0.0);
        let sure = (&looks(2), &turned(90.0, 0.05));
        let found = decide(&location(&FOUR), ray, sure, None);
        assert!(
            (found.yaw_rad.to_degrees() - 90.0).abs() < 1e-6,
            "{found:?}"
        );
        assert!((0.0..=0.5).contains(&found.flip_probability));
    }

    #[test]
    fn what_disagrees_leaves_a_flip_open() {
        let ray = RayAngle::towards(1.0, 0.0);
        let agreed = decide(&location(&FOUR), ray, (&looks(0), &turned(5.0, 0.0)), None);
        let torn = decide(
            &location(&FOUR),
            ray,
            (&Row::default(), &turned(5.0, 0.4)),
            None,
        );
        assert!(agreed.flip_probability < 0.02 && torn.flip_probability > 0.1);
        assert!(torn.flip_probability <= 0.5);
    }

    #[test]
    fn the_axis_an_object_had_decides_where_parts_do_not_and_its_sense_stays_open() {
        let ray = RayAngle::towards(1.0, 0.0);
        let unsure = (&Row::default(), &turned(90.0, 0.5));
        let before = heading(-172.0, 0.1);
        let found = decide(&location(&FOUR), ray, unsure, Some(&before));
        let turned_deg = (found.yaw_rad.to_degrees() - 10.0).rem_euclid(180.0);
        assert!(turned_deg.min(180.0 - turned_deg) < 6.0, "{found:?}");
        assert!(found.flip_probability > 0.4, "{found:?}");
    }

    #[test]
    fn without_candidates_the_forest_is_believed_along_its_ray() {
        let ray = RayAngle::towards(1.0, 1.0);
        let found = decide(
            &location(&[]),
            ray,
            (&Row::default(), &turned(30.0, 0.1)),
            None,
        );
        assert!((found.yaw_rad.to_degrees() - 75.0).abs() < 1e-6);
        assert!(found.flip_probability < 0.2);
    }
}
