//! The gateway of a tunnel, on the radio map that the build names.
//!
//! Two variables of the environment, whose defaults are in `.cargo/config.toml`: `FOXHUNT_MAP`, the full path of the map,
//! and `FOXHUNT_WALKS`, how people walk and radios hear there: `tunnel` or `floor`.

use foxhunt::{
    fingerprint::{
        RadioMap,
        tracker::{self, Site, Walls},
    },
    gateway::beacon::{BeaconGateway, Config, Framing},
};

/// The map, in flash. A file that is damaged or is no map does not compile.
const MAP: RadioMap<'static> = match RadioMap::new(include_bytes!(env!("FOXHUNT_MAP"))) {
    Ok(map) => map,
    Err(_) => panic!("FOXHUNT_MAP is no radio map, or a damaged one"),
};

/// Sixty-four tags at once, three hundred particles for each, and room for this very map.
pub type Gateway =
    BeaconGateway<64, 300, { MAP.lattice().points() }, { MAP.beacons() }, { MAP.lattice().axes() }>;

/// With packets as sentences.
pub const LINES: Config<Site<'static>> = foxhunt::config!(Config::new(Site {
    map: MAP,
    config: walks(),
    walls: Walls::None,
}));

/// With packets as binary frames.
pub const FRAMES: Config<Site<'static>> = Config {
    framing: Framing::Frames,
    ..LINES
};

const fn walks() -> tracker::Config {
    match env!("FOXHUNT_WALKS").as_bytes() {
        b"tunnel" => tracker::Config::TUNNEL,
        // Slowly, with turns, in the reach of a dozen radios.
        b"floor" => tracker::Config::DEFAULT,
        _ => panic!("FOXHUNT_WALKS is neither tunnel nor floor"),
    }
}
