//! The gateway of any tunnel, on a radio map that may be replaced while it runs.

use foxhunt::{
    fingerprint::{
        RadioMap,
        tracker::{self, Site, Walls},
    },
    gateway::beacon::{BeaconGateway, Config},
};

/// Tags at once.
const TAGS: usize = 32;
const PARTICLES: usize = 300;
/// Points of a map: a metre apart, they are so many metres of tunnel.
const POINTS: usize = 512;
/// Radios.
const RADIOS: usize = 16;

/// The gateway, for maps with one row of points.
pub type Gateway = BeaconGateway<TAGS, PARTICLES, POINTS, RADIOS, 1>;

/// How people walk there.
pub const WALKS: tracker::Config = tracker::Config::TUNNEL;

/// The map of the recorded walk, until the site has one of its own.
pub const EXAMPLE: RadioMap<'static> =
    match RadioMap::new(include_bytes!("../../examples/data/tunnel.map")) {
        Ok(map) => map,
        Err(_) => panic!("the example's map is damaged"),
    };

/// The most that such a map takes: a mean and a sigma for each radio and point, and what describes them, which is less than
/// a page.
pub const MAP_BYTES: usize = 2 * RADIOS * POINTS + 4_096;

/// The configuration with a map.
pub const fn config(map: RadioMap<'_>) -> Config<Site<'_>> {
    Config::new(Site {
        map,
        config: WALKS,
        walls: Walls::None,
    })
}

/// A map for which the gateway has room.
pub const fn fitting(map: RadioMap<'_>) -> Option<RadioMap<'_>> {
    match map.limited(POINTS, RADIOS) {
        Ok(map) if map.lattice().axes() == 1 => Some(map),
        _ => None,
    }
}
