//! Random numbers that depend on what they are for, not on who asks first.

use std::f64::consts::TAU;

/// The odd constant nearest to 2^64 divided by the golden ratio: consecutive multiples are far apart.
const STRIDE: u64 = 0x9e37_79b9_7f4a_7c15;

/// What a random number decides.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Purpose {
    /// Whether the detector misses an object.
    Dropout,
    /// How far the edges of a box stray.
    Jitter,
    /// Whether and where something is seen that is not there.
    FalseAlarm,
    /// Whether a camera loses a frame.
    MissingFrame,
    /// How late a camera fires.
    StampJitter,
    /// Where something stands.
    Place,
}

/// A stream of random numbers (SplitMix64), the same on every machine.
#[derive(Clone, Debug)]
pub struct Random(u64);

impl Random {
    /// The stream of a seed for one purpose and one thing, such as `[camera, frame, object]`.
    #[must_use]
    pub fn keyed(seed: u64, purpose: Purpose, thing: &[u64]) -> Self {
        let key = std::iter::once(purpose as u64).chain(thing.iter().copied());
        Self(key.fold(mix(seed), |state, part| {
            mix(state ^ part.wrapping_add(STRIDE))
        }))
    }

    /// Evenly in `0.0..1.0`.
    pub fn unit(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(STRIDE);
        (mix(self.0) >> 11) as f64 / (1_u64 << 53) as f64
    }

    /// Evenly between two numbers.
    pub fn between(&mut self, min: f64, max: f64) -> f64 {
        min + (max - min) * self.unit()
    }

    /// Normal, with mean 0 and standard deviation 1 (Box and Muller).
    pub fn normal(&mut self) -> f64 {
        let radius = (-2.0 * (1.0 - self.unit()).ln()).sqrt();
        radius * (TAU * self.unit()).cos()
    }
}

fn mix(state: u64) -> u64 {
    let state = (state ^ (state >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    let state = (state ^ (state >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    state ^ (state >> 31)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn streams_differ_by_seed_purpose_and_thing_and_by_nothing_else() {
        let first = |seed, purpose, thing: &[u64]| Random::keyed(seed, purpose, thing).unit();
        let one = first(1, Purpose::Dropout, &[0, 1]);
        assert_eq!(one, first(1, Purpose::Dropout, &[0, 1]));
        assert_ne!(one, first(2, Purpose::Dropout, &[0, 1]));
        assert_ne!(one, first(1, Purpose::Jitter, &[0, 1]));
        assert_ne!(one, first(1, Purpose::Dropout, &[1, 0]));
    }

    #[test]
    fn numbers_spread_as_they_say() {
        let mut random = Random::keyed(7, Purpose::Jitter, &[]);
        let numbers: Vec<f64> = (0..10_000).map(|_| random.normal()).collect();
        let mean = numbers.iter().sum::<f64>() / 1e4;
        let variance = numbers.iter().map(|number| number * number).sum::<f64>() / 1e4;
        assert!(mean.abs() < 0.05 && (variance - 1.0).abs() < 0.05);
    }
}
