//! How much there is room for. Whoever changes a number here, or a type, writes the header anew: the README has the command.

/// Particles of a locator for clean bearings.
pub const FOXHUNT_PARTICLES: usize = 200;
/// Particles of a locator for bearings of which some are wrong.
pub const FOXHUNT_ROBUST_PARTICLES: usize = 256;
/// Bearings that a `FoxhuntClean`, a `FoxhuntRobust` or a gateway with one of them keeps. A `FoxhuntSeveral` keeps 64 for
/// each source, whatever this says, with 256 particles.
pub const FOXHUNT_BEARINGS: usize = 64;
/// The most sources of a locator of several.
pub const FOXHUNT_SOURCES: usize = 3;
/// Ports of a vehicle's gateway: a computer, a receiver and a direction finder, at any of them.
pub const FOXHUNT_PORTS: usize = 3;
/// Particles of the tracker of a tag.
pub const FOXHUNT_TAG_PARTICLES: usize = 300;
/// The most tags that a gateway tracks at once.
pub const FOXHUNT_TAGS: usize = 16;
/// The most beacons of a radio map.
pub const FOXHUNT_BEACONS: usize = 16;
/// The most points of a radio map.
pub const FOXHUNT_POINTS: usize = 1_024;
