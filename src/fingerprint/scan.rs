//! What a receiver hears.

use super::Config;

/// One beacon as a scan heard it: a packet, or the mean of several.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Reading {
    /// The number of the beacon, see [`super::RadioMap::beacon_index`].
    pub beacon: u8,
    /// Strength in dBm. For whole scans: less the offset of the receiver.
    pub rssi_dbm: f32,
}

/// The most readings of a scan that are used.
pub const MAX_READINGS: usize = 64;

/// The readings of a scan that can be used.
pub(super) fn accepted<'a>(
    scan: &'a [Reading],
    config: &'a Config,
) -> impl Iterator<Item = &'a Reading> {
    let accepted = scan.iter().filter(|r| config.accepts(r.rssi_dbm));
    accepted.take(MAX_READINGS)
}
