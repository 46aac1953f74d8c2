//! Which rounds are worth keeping.

use roadwatch_core::{
    Known, Locator, Method, Perceived, Phase, Scene, SlopeEvidence,
    space::{BaseLink, Point},
};

/// When a round is kept: when one of these holds, or always where none is asked for.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Triggers {
    /// Every n-th round, the first one too.
    pub every: Option<u64>,
    /// When an object is in the scene that was not in the last round that was kept.
    pub on_object: bool,
    /// When two methods put an object at distances that differ by more than this share of the nearer one.
    pub on_disagreement: Option<f64>,
}

/// Other ways to locate, asked beside the configured one: of each camera, by its id.
pub struct SecondOpinion {
    /// Which way.
    pub method: Method,
    /// Locators in order of camera ids.
    pub locators: Vec<Box<dyn Locator>>,
}

/// Where a second opinion puts an object.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Opinion {
    pub(super) method: Method,
    pub(super) position: Point<BaseLink>,
    pub(super) range_m: f64,
}

impl Triggers {
    /// Whether round number `count` is kept. `newcomers` says whether an object is new, `apart` by how much methods differ.
    pub(super) fn keep(&self, count: u64, newcomers: bool, apart: Option<f64>) -> bool {
        let nothing_asked = *self == Self::default();
        let due = self
            .every
            .is_some_and(|every| count.is_multiple_of(every.max(1)));
        let differ = self
            .on_disagreement
            .zip(apart)
            .is_some_and(|(most, apart)| apart > most);
        nothing_asked || due || (self.on_object && newcomers) || differ
    }
}

/// What the others say of the objects of a frame, in its order.
pub(super) fn opinions(perceived: &Perceived, others: &[SecondOpinion]) -> Vec<Vec<Opinion>> {
    let camera = perceived.tracks.frame.camera.index();
    let of_track = |track: &roadwatch_core::Track| {
        let located = &track.observed.located;
        // Nothing of earlier frames: it is to stand alone.
        let known = Known {
            object: None,
            slopes: SlopeEvidence::default(),
        };
        let asked = others.iter().filter_map(|other| {
            let found = other
                .locators
                .get(camera)?
                .locate(&located.detection, &known)?;
            Some(Opinion {
                method: other.method,
                position: found.position,
                range_m: found.range_m,
            })
        });
        asked.collect()
    };
    perceived.tracks.items.iter().map(of_track).collect()
}

/// By how much the methods differ most: the greater range less the nearer one, as a share of the nearer.
pub(super) fn disagreement(perceived: &Perceived, opinions: &[Vec<Opinion>]) -> Option<f64> {
    let pairs = perceived.tracks.items.iter().zip(opinions);
    let shares = pairs.flat_map(|(track, others)| {
        let own_m = track.observed.located.location.range_m;
        others.iter().map(move |other| {
            let nearer_m = own_m.min(other.range_m).max(f64::EPSILON);
            (own_m - other.range_m).abs() / nearer_m
        })
    });
    shares.reduce(f64::max)
}

/// Identities that are believed in.
pub(super) fn identities(scene: &Scene) -> impl Iterator<Item = u64> {
    let believed = scene.objects.iter().filter(|object| {
        let motion = object.track.motion.as_ref();
        motion.is_none_or(|motion| motion.phase != Phase::Tentative)
    });
    believed.map(|object| object.track.id.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn without_a_trigger_everything_is_kept() {
        let none = Triggers::default();
        assert!(none.keep(3, false, None));
    }

    #[test]
    fn each_trigger_keeps_what_it_is_for_and_nothing_else() {
        let every = Triggers {
            every: Some(3),
            ..Triggers::default()
        };
        let kept: Vec<u64> = (0..8)
            .filter(|&count| every.keep(count, true, Some(1.0)))
            .collect();
        assert_eq!(kept, [0, 3, 6]);
        let object = Triggers {
            on_object: true,
            ..Triggers::default()
        };
        assert!(object.keep(1, true, None) && !object.keep(0, false, Some(1.0)));
        let differ = Triggers {
            on_disagreement: Some(0.2),
            ..Triggers::default()
        };
        assert!(differ.keep(1, false, Some(0.21)));
        assert!(!differ.keep(1, true, Some(0.2)) && !differ.keep(1, true, None));
    }
}
