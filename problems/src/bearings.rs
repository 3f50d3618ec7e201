//! Tracks from which the bearings of a source at rest are taken.
//!
//! The papers print theirs as pictures only; these are ours, of the same size. Du et al., Telecommunication
//! Engineering 56 (2016), for the fish school (A), and China Measurement & Test 43 (2017), for the fireflies (B).

use core::f32::consts::TAU;

use foxhunt::aoa::{Bearing, Observation};
use foxhunt::math::{atan2, sin_cos, sqrt};
use foxhunt::random::{Rng, normal};

/// A track, and what the published filter of it assumes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Track {
    /// A straight line past the source.
    A1,
    /// An L round the source.
    A2,
    /// A circle of 350 m round the source.
    A5,
    /// A larger L.
    B2,
}

impl Track {
    /// Where the source is, in metres east and north.
    pub const fn source(self) -> [f32; 2] {
        match self {
            Self::B2 => [3000.0, 2200.0],
            _ => [1200.0, 800.0],
        }
    }

    /// How many bearings are taken.
    pub const fn bearings(self) -> u32 {
        match self {
            Self::B2 => 40,
            _ => 60,
        }
    }

    /// Variance of the bearings, in square radians.
    pub const fn variance(self) -> f32 {
        match self {
            Self::B2 => 3.8e-4,
            _ => 3.801e-4,
        }
    }

    /// Process noise of the published filter, in square metres a step and axis; the source does not move.
    pub const fn process_variance(self) -> f32 {
        match self {
            Self::B2 => 5.0,
            _ => 1.0,
        }
    }

    /// Number of particles of the published filter.
    pub const fn particles(self) -> usize {
        match self {
            Self::B2 => 80,
            _ => 100,
        }
    }

    /// Where bearing `index` is taken, counted from zero, in metres east and north: at equal distances, both ends
    /// of a line included.
    pub fn receiver(self, index: u32) -> [f32; 2] {
        let part = index as f32 / (self.bearings() - 1) as f32;
        match self {
            Self::A1 => [1500.0 * part, 0.0],
            Self::A2 => corner(3000.0 * part, 1500.0),
            Self::A5 => {
                let (sin, cos) = sin_cos(TAU * index as f32 / 60.0);
                let [x, y] = self.source();
                [x + 350.0 * cos, y + 350.0 * sin]
            }
            Self::B2 => corner(6000.0 * part, 4000.0),
        }
    }

    /// The bearings of one run.
    pub fn simulate<R: Rng + ?Sized>(
        self,
        rng: &mut R,
    ) -> impl Iterator<Item = Observation> + use<'_, R> {
        let sigma = sqrt(self.variance());
        let [x, y] = self.source();
        (0..self.bearings()).filter_map(move |index| {
            let [px, py] = self.receiver(index);
            let angle = atan2(y - py, x - px) + sigma * normal(rng);
            let time_ms = 1000 * index;
            Observation::new(time_ms, [px, py], Bearing::from_radians(angle), sigma).ok()
        })
    }
}

/// A place `way` metres along a line that turns from east to north after `leg` metres.
fn corner(way: f32, leg: f32) -> [f32; 2] {
    if way <= leg {
        [way, 0.0]
    } else {
        [leg, way - leg]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use foxhunt::aoa::triangulation::gauss_newton;
    use foxhunt::random::{SeedableRng, Xoshiro128PlusPlus};

    #[test]
    fn every_track_finds_its_source() {
        let mut rng = Xoshiro128PlusPlus::seed_from_u64(42);
        for (track, error, last) in [
            (Track::A1, 6.9, [1500.0, 0.0]),
            (Track::A2, 2.9, [1500.0, 1500.0]),
            (Track::A5, 1.3, [1200.0 + 348.08, 800.0 - 36.59]),
            (Track::B2, 12.8, [4000.0, 2000.0]),
        ] {
            let [x, y] = track.receiver(track.bearings() - 1);
            assert!((x - last[0]).abs() < 0.01 && (y - last[1]).abs() < 0.01);
            let mut observations = [None; 60];
            let mut count = 0;
            for (slot, observation) in observations.iter_mut().zip(track.simulate(&mut rng)) {
                *slot = Some(observation);
                count += 1;
            }
            assert_eq!(count, track.bearings() as usize);
            let observations = observations.map(|o| o.or(observations[0]).unwrap());
            let [x, y] = track.source();
            let (found, _) = gauss_newton(&observations[..count], [x + 50.0, y]).unwrap();
            let off = (found[0] - x).hypot(found[1] - y);
            assert!(off < 4.0 * error, "{track:?}: {off} m");
        }
    }
}
