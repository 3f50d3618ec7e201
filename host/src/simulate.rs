//! Noisy bearings along a track.

use rand::{Rng, SeedableRng};
use rand_distr::{Distribution, StandardNormal};
use rand_xoshiro::{SplitMix64, Xoshiro256PlusPlus};

use crate::sight::{direction, wrap};
use crate::{Sight, tracks::Track};

/// The generator of run `run` of the experiment `seed`: every run has its own, so that runs may be
/// done in any order and on any number of threads.
pub fn generator(seed: u64, run: u64) -> Xoshiro256PlusPlus {
    Xoshiro256PlusPlus::from_rng(&mut SplitMix64::seed_from_u64(
        seed.wrapping_mul(0x9E37_79B9_7F4A_7C15) ^ run,
    ))
}

/// A standard normal sample.
pub fn normal(rng: &mut impl Rng) -> f64 {
    StandardNormal.sample(rng)
}

/// One bearing from every receiver of the track, in order.
pub fn bearings(track: &Track, rng: &mut impl Rng) -> Vec<Sight> {
    let sight = |(index, &position): (usize, &[f64; 2])| Sight {
        time_ms: 1000 * index as u32,
        position,
        bearing: wrap(direction(position, track.source) + track.sigma * normal(rng)),
        sigma: track.sigma,
    };
    track.receivers.iter().enumerate().map(sight).collect()
}
