//! What functions return.

use core::ffi::c_char;

use foxhunt::aoa::{ObservationError, PushError};
use foxhunt::fingerprint::{MapError, ReadingError};

/// What functions return: zero if all is well, else why nothing was done. State is then as before.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[repr(i32)]
pub enum FoxhuntResult {
    /// All is well.
    Ok = 0,
    /// A pointer is null.
    NullPointer = 1,
    /// A pointer is not aligned as its type must be.
    Misaligned = 2,
    /// Storage has another size than in the library: `size` is not `sizeof` the type, or the header is of another version.
    Size = 3,
    /// The locator, gateway or tracker was not initialised, or holds another type.
    Uninitialised = 4,
    /// A field of a configuration is out of range: the function `..._config_fault` of the configuration names it.
    Config = 5,
    /// There is no such thing: no fix yet, or no more of them.
    Nothing = 6,
    /// The gateway has no such port.
    Port = 7,
    /// The generator was not initialised, or holds another type.
    NoGenerator = 8,
    /// The site was not initialised, or holds another type.
    NoSite = 9,
    /// A position is not finite or too far from the origin.
    Position = 10,
    /// A bearing is not finite.
    Bearing = 11,
    /// A standard deviation is out of range.
    Sigma = 12,
    /// A bearing is older than all that are kept. The first of all sets the beginning: even the second may not be earlier.
    TooOld = 13,
    /// A bearing of this station and time was taken already.
    Duplicate = 14,
    /// A heading is not finite.
    Heading = 15,
    /// A probability is not from 0 to 1.
    Probability = 16,
    /// A covariance is none: an entry is not finite, or a variance would be negative.
    Covariance = 17,
    /// A map has fewer or more bytes than its header says.
    MapLength = 20,
    /// Bytes are not a map.
    MapMagic = 21,
    /// A map is of another version.
    MapVersion = 22,
    /// The checksum of a map does not match.
    MapChecksum = 23,
    /// A map has another encoding than a tracker needs.
    MapEncoding = 24,
    /// A map has an impossible lattice.
    MapLattice = 25,
    /// A map has no beacon, or more than there is room for.
    MapBeacons = 26,
    /// A map has more points than there is room for.
    MapPoints = 27,
    /// The header of a map is impossible.
    MapHeader = 28,
    /// The map has no such beacon.
    Beacon = 30,
    /// No receiver can report such a strength.
    Strength = 31,
    /// A packet is older than the last update of its tag.
    OldPacket = 32,
    /// The workspace was not initialised, or holds another type.
    NoWorkspace = 33,
    /// What this library does not know by name.
    Other = 99,
}

use FoxhuntResult as Code;

/// Every result with its text.
const TEXTS: [(Code, &str); 32] = [
    (Code::Ok, "all is well"),
    (Code::NullPointer, "a pointer is null"),
    (Code::Misaligned, "a pointer is not aligned"),
    (
        Code::Size,
        "storage has another size: `size` is not that of the type, or header and library are of different versions",
    ),
    (
        Code::Uninitialised,
        "the locator, gateway or tracker was not initialised, or holds another type",
    ),
    (
        Code::Config,
        "a field of the configuration is out of range: ..._config_fault names it",
    ),
    (Code::Nothing, "there is no fix yet, or no more of them"),
    (Code::Port, "the gateway has no such port"),
    (
        Code::NoGenerator,
        "the generator was not initialised, or holds another type",
    ),
    (
        Code::NoSite,
        "the site was not initialised, or holds another type",
    ),
    (Code::Position, ObservationError::Position.message()),
    (Code::Bearing, ObservationError::Bearing.message()),
    (Code::Sigma, ObservationError::Sigma.message()),
    (Code::TooOld, PushError::TooOld.message()),
    (Code::Duplicate, PushError::Duplicate.message()),
    (Code::Heading, "heading is not finite"),
    (Code::Probability, ObservationError::Probability.message()),
    (
        Code::Covariance,
        "the covariance is not finite, or a variance would be negative",
    ),
    (Code::MapLength, MapError::Length.message()),
    (Code::MapMagic, MapError::Magic.message()),
    (Code::MapVersion, MapError::Version.message()),
    (Code::MapChecksum, MapError::Checksum.message()),
    (Code::MapEncoding, MapError::Encoding.message()),
    (Code::MapLattice, MapError::Lattice.message()),
    (Code::MapBeacons, MapError::Beacons.message()),
    (Code::MapPoints, MapError::Points.message()),
    (Code::MapHeader, "the header of the map is impossible"),
    (Code::Beacon, ReadingError::Beacon.message()),
    (Code::Strength, ReadingError::Strength.message()),
    (Code::OldPacket, "the packet is older than the last update"),
    (
        Code::NoWorkspace,
        "the workspace was not initialised, or holds another type",
    ),
    (Code::Other, "refused"),
];

/// Text in the library: not ended by a zero. `printf("%.*s", (int)text.length, text.bytes)` prints it.
#[derive(Debug, Clone, Copy)]
#[repr(C)]
pub struct FoxhuntText {
    /// The bytes: ASCII.
    pub bytes: *const c_char,
    /// How many there are.
    pub length: usize,
}

impl From<&str> for FoxhuntText {
    fn from(text: &str) -> Self {
        Self {
            bytes: text.as_ptr().cast(),
            length: text.len(),
        }
    }
}

/// The code of a result.
pub fn code(result: Result<(), FoxhuntResult>) -> FoxhuntResult {
    match result {
        Ok(()) => Code::Ok,
        Err(code) => code,
    }
}

impl From<ObservationError> for FoxhuntResult {
    fn from(error: ObservationError) -> Self {
        match error {
            ObservationError::Position => Self::Position,
            ObservationError::Bearing => Self::Bearing,
            ObservationError::Sigma => Self::Sigma,
            _ => Self::Other,
        }
    }
}

impl From<PushError> for FoxhuntResult {
    fn from(error: PushError) -> Self {
        match error {
            PushError::TooOld => Self::TooOld,
            PushError::Duplicate => Self::Duplicate,
            _ => Self::Other,
        }
    }
}

impl From<MapError> for FoxhuntResult {
    fn from(error: MapError) -> Self {
        match error {
            MapError::Length => Self::MapLength,
            MapError::Magic => Self::MapMagic,
            MapError::Version => Self::MapVersion,
            MapError::Checksum => Self::MapChecksum,
            MapError::Encoding => Self::MapEncoding,
            MapError::Lattice => Self::MapLattice,
            MapError::Beacons => Self::MapBeacons,
            MapError::Points => Self::MapPoints,
            MapError::Levels | MapError::ErrorLength => Self::MapHeader,
            _ => Self::Other,
        }
    }
}

impl From<ReadingError> for FoxhuntResult {
    fn from(error: ReadingError) -> Self {
        match error {
            ReadingError::Beacon => Self::Beacon,
            ReadingError::Strength => Self::Strength,
            ReadingError::TooOld => Self::OldPacket,
            ReadingError::Points => Self::MapPoints,
            _ => Self::Other,
        }
    }
}

impl FoxhuntResult {
    /// What it says.
    pub fn text(self) -> FoxhuntText {
        foxhunt_error_text(self as i32)
    }
}

/// The text of a result; that it is unknown, of any other number.
#[unsafe(no_mangle)]
pub extern "C" fn foxhunt_error_text(result: i32) -> FoxhuntText {
    let found = TEXTS.iter().find(|(code, _)| *code as i32 == result);
    found.map_or("unknown result", |(_, text)| text).into()
}
