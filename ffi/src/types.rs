//! The library's types, as large as [`sizes`](crate::sizes) says.

use foxhunt::aoa::{self, manoeuvring, multi, presets};
use foxhunt::fingerprint::tracker;
use foxhunt::gateway::{self, FullReport, ShortReport, formats};

use crate::sizes::{
    FOXHUNT_BEACONS, FOXHUNT_BEARINGS, FOXHUNT_PARTICLES, FOXHUNT_POINTS, FOXHUNT_PORTS,
    FOXHUNT_ROBUST_PARTICLES, FOXHUNT_SOURCES, FOXHUNT_TAG_PARTICLES, FOXHUNT_TAGS,
};

/// Locates one source by clean bearings.
pub type Clean = aoa::Clean<FOXHUNT_PARTICLES, FOXHUNT_BEARINGS>;
/// Locates one source by bearings of which some are wrong.
pub type Robust = aoa::Robust<FOXHUNT_ROBUST_PARTICLES, FOXHUNT_BEARINGS>;
/// Locates several sources, any of which may drive off.
pub type Several = presets::City<FOXHUNT_SOURCES>;
/// The configuration of that.
pub type SeveralConfig = multi::Config<manoeuvring::Config>;
/// Gateway of a vehicle for clean bearings: it reads every format, and reports in short.
pub type Vehicle = gateway::Vehicle<Clean, formats::All, ShortReport, FOXHUNT_PORTS>;
/// Gateway of a vehicle for bearings of which some are wrong: it reads every format, and reports all that it knows.
pub type RobustVehicle = gateway::Vehicle<Robust, formats::All, FullReport, FOXHUNT_PORTS>;
/// Tracks one tag.
pub type Tracker = tracker::Tracker<FOXHUNT_TAG_PARTICLES, FOXHUNT_BEACONS>;
/// The scratch memory of trackers.
pub type Workspace = tracker::Workspace<FOXHUNT_TAG_PARTICLES, FOXHUNT_POINTS>;
/// Gateway of a tunnel.
pub type Beacon = gateway::beacon::BeaconGateway<
    FOXHUNT_TAGS,
    FOXHUNT_TAG_PARTICLES,
    FOXHUNT_POINTS,
    FOXHUNT_BEACONS,
>;
