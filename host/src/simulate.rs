//! Noisy bearings along a track.

use foxhunt_simulation::{
    Sight,
    random::normal,
    sight::{direction, wrap},
};
use rand::Rng;

use crate::tracks::Track;

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
