//! Why a map, a reading or a scan was refused.

use crate::error::messages;

/// Why a map was refused.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub enum MapError {
    /// There are fewer or more bytes than its header says.
    Length,
    /// These bytes are no radio map.
    Magic,
    /// Its format is of another version.
    Version,
    /// The checksum does not match: some byte has changed.
    Checksum,
    /// Its encoding is unknown.
    Encoding,
    /// Its lattice has too few or too many points, or impossible coordinates.
    Lattice,
    /// It has no beacon, or more than there is room for.
    Beacons,
    /// The scale of its levels is impossible.
    Levels,
    /// It has more points than there is room for.
    Points,
    /// The length of its error is impossible.
    ErrorLength,
}

messages!(MapError {
    Self::Length => "fewer or more bytes than the header says",
    Self::Magic => "not a radio map",
    Self::Version => "a radio map of another version",
    Self::Checksum => "the checksum does not match",
    Self::Encoding => "unknown encoding",
    Self::Lattice => "impossible lattice",
    Self::Beacons => "no beacon, or more than there is room for",
    Self::Levels => "impossible levels",
    Self::Points => "more points than there is room for",
    Self::ErrorLength => "impossible length of its error",
});

/// Why a reading or a scan was not used. What it was for is as before.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub enum ReadingError {
    /// The map has no beacon of that number or holds no means, or the tracker has no room for the beacon.
    Beacon,
    /// No receiver can report such a strength. For a scan: all its strengths.
    Strength,
    /// It is older than the last update.
    TooOld,
    /// The map has more points than there is room for.
    Points,
    /// The map is a plane, and there is room for one axis.
    Axes,
    /// A tag can be at no point of the map.
    Survey,
}

messages!(ReadingError {
    Self::Beacon => "the map has no such beacon",
    Self::Strength => "no receiver can report such a strength",
    Self::TooOld => "the reading is older than the last update",
    Self::Points => "the map has more points than there is room for",
    Self::Axes => "the map is a plane, and there is room for one axis",
    Self::Survey => "a tag can be at no point of the map",
});
