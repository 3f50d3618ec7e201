//! The gateway of a tunnel, on the radio map that the build names.
//!
//! Two variables of the environment, whose defaults are in `.cargo/config.toml`: `FOXHUNT_MAP`, the full path of the map,
//! and `FOXHUNT_WALKS`, how people walk and radios hear there: `tunnel` or `floor`.

use foxhunt::{
    fingerprint::{
        RadioMap,
        tracker::{Settings, Site},
    },
    gateway::beacon::{self, BeaconGateway, Framing},
};

use crate::walks;

/// The map, in flash. A file that is damaged or is no map does not compile.
const MAP: RadioMap<'static> = match RadioMap::new(include_bytes!(env!("FOXHUNT_MAP"))) {
    Ok(map) => map,
    Err(_) => panic!("FOXHUNT_MAP is no radio map, or a damaged one"),
};

const SITE: Site<'static> = match Site::new(MAP, settings()) {
    Ok(site) => site,
    Err(_) => panic!("trackers need a map of moments"),
};

/// Eight tags at once, three hundred particles for each, and room for this very map.
pub type Gateway = BeaconGateway<'static, 8, 300, { MAP.lattice().points() }, { MAP.beacons() }>;

/// The gateway before its first byte, with packets as they are `framed`.
pub const fn gateway(framed: Framing) -> Gateway {
    Gateway::new(SITE, beacon::Settings::new().with_framing(framed))
}

const fn settings() -> Settings {
    match env!("FOXHUNT_WALKS").as_bytes() {
        b"tunnel" => walks::tunnel(),
        // Slowly, with turns, in the reach of a dozen radios.
        b"floor" => Settings::new(),
        _ => panic!("FOXHUNT_WALKS is neither tunnel nor floor"),
    }
}
