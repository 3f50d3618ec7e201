//! The radio map: what was measured where, read in place.

use super::{Lattice, MapError};
use crate::ConfigError;
use crate::checksum::crc32;

/// A radio map: how strongly each beacon is heard at each point of a [`Lattice`].
///
/// A view over bytes, which may lie in flash; nothing is copied. The bytes are made on a desk from a survey, by the
/// project's host crate. All of them are checked when the map is opened, which the compiler can do already:
///
/// ```
/// use foxhunt::fingerprint::{MapError, RadioMap};
///
/// const BYTES: &[u8] =
///     include_bytes!(concat!(env!("CARGO_MANIFEST_DIR"), "/examples/data/tunnel.map"));
/// static TUNNEL: RadioMap<'static> = match RadioMap::new(BYTES) {
///     Ok(map) => map,
///     Err(_) => panic!("the radio map is damaged"),
/// };
///
/// let beacon = TUNNEL.beacon_index(3).unwrap();
/// assert_eq!(TUNNEL.moments(beacon, 49).unwrap().mean_dbm, -40.5);
/// assert_eq!(TUNNEL.limited(80, 4).err(), Some(MapError::Points));
/// assert_eq!(RadioMap::new(&BYTES[1..]).err(), Some(MapError::Magic));
/// ```
///
/// # Format, version 2
///
/// Little-endian, without padding:
///
/// | offset | bytes | holds |
/// |---|---|---|
/// | 0 | 4 | `FXRM` |
/// | 4 | 1 | version: 2 |
/// | 5 | 1 | [`Encoding`]: 1 or 2 |
/// | 6 | 1 | beacons: 1 to 255 |
/// | 7 | 1 | levels: 2 to 255; 0 in encoding 1, whose fields from offset 24 are below |
/// | 8 | 2 + 2 | columns, rows of the lattice |
/// | 12 | 4 + 4 | origin of the lattice in metres, f32 |
/// | 20 | 4 | spacing of the lattice in metres, f32 |
/// | 24 | 1 | the lowest level in dBm, signed |
/// | 25 | 1 | dB from one level to the next |
/// | 26 | 4 | natural logarithm of the density, per dB, that code 0 stands for, f32 |
/// | 30 | 4 | what every step of a code takes off that, f32 |
/// | 24 | 2 | in encoding 1: what a tag at rest is off by, in centimetres, see [`RadioMap::rest_error_m`]; 0: not known |
/// | 26 | 8 | in encoding 1: 0 |
/// | 34 | 4 | length of the map's error in metres, f32; 0: not known |
/// | 38 | 4 | date of the survey, days since 1970-01-01; 0: not known |
/// | 42 | 1 | sigma of a packet in quarters of a dB |
/// | 43 | 1 | what was not chosen by the survey but by hand: a bit each for lattice, cells, field, sigma, length and packets |
/// | 44 | 6 each | beacons: identifier, 4; detection probability in 255ths; sensitivity in dBm, signed |
/// | | 1 for 8 | points: a bit each, the lowest first, set where a tag can be |
/// | | | the data, see [`Encoding`] |
/// | | 4 | CRC-32 (IEEE 802.3) of all bytes before it |
#[derive(Debug, Clone, Copy)]
pub struct RadioMap<'a> {
    lattice: Lattice,
    encoding: Encoding,
    levels: Levels,
    origin: Origin,
    beacons: &'a [u8],
    possible: &'a [u8],
    /// Whether all points are possible.
    complete: bool,
    data: &'a [u8],
}

/// What a map holds of each beacon at each point.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub enum Encoding {
    /// Mean and sigma, in two bytes: by beacon, then by point; the sigma in quarters of a dB (1 to 63, or 0 where the
    /// beacon was not heard), then the mean in halves of a dB above -128 dBm. The sigma is that of the mean: how far the
    /// map may be wrong there. What packets scatter about their mean is in the header.
    Moments,
    /// The logarithm of a kernel density, in four bits for each level: rows by beacon and by level, and after the levels
    /// of a beacon a row for its absence. A row holds eight points in four bytes: the low halves of the bytes are the
    /// first four.
    Levels,
}

/// Scale of the codes of [`Encoding::Levels`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Levels {
    pub lowest_dbm: i8,
    pub spacing_db: u8,
    pub count: u8,
    /// Log-density that code 0 stands for.
    pub top: f32,
    /// How much every step of a code takes off it.
    pub step: f32,
}

impl Levels {
    /// Reads the scale from a header.
    const fn read(bytes: &[u8]) -> Self {
        let [count] = take(bytes, 7);
        let [lowest, spacing_db] = take(bytes, 24);
        Self {
            lowest_dbm: lowest as i8,
            spacing_db,
            count,
            top: f32_at(bytes, 26),
            step: f32_at(bytes, 30),
        }
    }

    const fn is_possible(&self) -> bool {
        self.count >= 2
            && self.spacing_db > 0
            && self.top.abs() < 100.0
            && self.step > 1e-3
            && self.step < 100.0
    }
}

/// What the map says of the survey that it was made of.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Origin {
    error_length_m: f32,
    days: u32,
    noise: u8,
    by_hand: u8,
    rest_error_cm: u16,
}

impl Origin {
    const fn read(bytes: &[u8]) -> Self {
        let [noise, by_hand] = take(bytes, 42);
        Self {
            error_length_m: f32_at(bytes, 34),
            days: u32::from_le_bytes(take(bytes, 38)),
            noise,
            by_hand,
            // In the other encoding these bytes are of the levels.
            rest_error_cm: match take(bytes, 5) {
                [1] => u16::from_le_bytes(take(bytes, 24)),
                _ => 0,
            },
        }
    }

    const fn is_possible(&self) -> bool {
        self.error_length_m >= 0.0 && self.error_length_m <= 1e4
    }
}

/// A beacon of a map.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Beacon {
    /// Its identifier.
    pub identifier: u32,
    /// The probability that it is heard in a scan where it is well above `sensitivity_dbm`; 0 when its absence says
    /// nothing.
    pub detection: f32,
    /// The level in dBm below which it is not heard.
    pub sensitivity_dbm: f32,
}

/// Strength of a beacon at a point.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Moments {
    /// Mean in dBm.
    pub mean_dbm: f32,
    /// Standard deviation in dB.
    pub sigma_db: f32,
}

const HEADER: usize = 44;
const BEACON: usize = 6;
const CHECKSUM: usize = 4;
/// Means count from here, in dBm.
pub(super) const LOWEST_MEAN_DBM: f32 = -128.0;

/// `N` bytes from `at`; zero where there are none.
const fn take<const N: usize>(bytes: &[u8], at: usize) -> [u8; N] {
    let mut taken = [0; N];
    let mut i = 0;
    while i < N {
        if at + i < bytes.len() {
            taken[i] = bytes[at + i];
        }
        i += 1;
    }
    taken
}

const fn f32_at(bytes: &[u8], at: usize) -> f32 {
    f32::from_le_bytes(take(bytes, at))
}

/// The first `length` bytes and the rest.
const fn split(bytes: &[u8], length: usize) -> (&[u8], &[u8]) {
    match bytes.split_at_checked(length) {
        Some(parts) => parts,
        None => (&[], &[]),
    }
}

/// Whether they are of a map, there are enough of them, and they are of this version.
const fn check_beginning(bytes: &[u8]) -> Result<(), MapError> {
    if u32::from_le_bytes(take(bytes, 0)) != u32::from_le_bytes(*b"FXRM") {
        return Err(MapError::Magic);
    }
    if bytes.len() < HEADER + CHECKSUM {
        return Err(MapError::Length);
    }
    let [version] = take(bytes, 4);
    if version != RadioMap::VERSION {
        return Err(MapError::Version);
    }
    Ok(())
}

/// Whether the bits of all points are set.
const fn is_complete(possible: &[u8], points: usize) -> bool {
    let mut i = 0;
    while i < possible.len() {
        let last = points < 8 * (i + 1);
        let mask = if last { !(0xff << (points % 8)) } else { 0xff };
        if possible[i] & mask != mask {
            return false;
        }
        i += 1;
    }
    true
}

/// Bytes of a row of [`Encoding::Levels`].
const fn row_length(points: usize) -> usize {
    points.div_ceil(8) * 4
}

impl<'a> RadioMap<'a> {
    /// The version of the format that this library reads.
    pub const VERSION: u8 = 2;

    /// Opens a map.
    ///
    /// # Errors
    /// When the bytes are no map, or a damaged one.
    pub const fn new(bytes: &'a [u8]) -> Result<Self, MapError> {
        if let Err(error) = check_beginning(bytes) {
            return Err(error);
        }
        let [encoding, beacons, levels] = take(bytes, 5);
        let columns = u16::from_le_bytes(take(bytes, 8));
        let rows = u16::from_le_bytes(take(bytes, 10));
        let points = columns as u64 * rows as u64;
        if points > Lattice::MAX_POINTS as u64 {
            return Err(MapError::Lattice);
        }
        let points = points as usize;
        let (encoding, of_beacon) = match encoding {
            1 => (Encoding::Moments, 2 * points),
            2 => (Encoding::Levels, (levels as usize + 1) * row_length(points)),
            _ => return Err(MapError::Encoding),
        };
        let beacons_length = beacons as usize * BEACON;
        let possible_length = points.div_ceil(8);
        // At most 65,536 points by 255 beacons by 256 rows in 4 bits: below 2^31.
        let end = HEADER + beacons_length + possible_length + beacons as usize * of_beacon;
        if bytes.len() != end + CHECKSUM {
            return Err(MapError::Length);
        }
        let (checked, checksum) = split(bytes, end);
        if crc32(checked) != u32::from_le_bytes(take(checksum, 0)) {
            return Err(MapError::Checksum);
        }
        let origin = [f32_at(bytes, 12), f32_at(bytes, 16)];
        let lattice = match Lattice::new(origin, f32_at(bytes, 20), columns, rows) {
            Ok(lattice) => lattice,
            Err(error) => return Err(error),
        };
        if beacons == 0 {
            return Err(MapError::Beacons);
        }
        let levels = Levels::read(bytes);
        if matches!(encoding, Encoding::Levels) != levels.is_possible() {
            return Err(MapError::Levels);
        }
        let origin = Origin::read(bytes);
        if !origin.is_possible() {
            return Err(MapError::ErrorLength);
        }
        let (_, rest) = split(checked, HEADER);
        let (beacons, rest) = split(rest, beacons_length);
        let (possible, data) = split(rest, possible_length);
        Ok(Self {
            lattice,
            encoding,
            levels,
            origin,
            beacons,
            possible,
            complete: is_complete(possible, points),
            data,
        })
    }

    /// Refuses a map of more points or beacons: at the start, if there will be no room for them.
    ///
    /// # Errors
    /// [`MapError::Points`] or [`MapError::Beacons`].
    pub const fn limited(self, points: usize, beacons: usize) -> Result<Self, MapError> {
        if self.lattice.points() > points {
            return Err(MapError::Points);
        }
        if self.beacons() > beacons {
            return Err(MapError::Beacons);
        }
        Ok(self)
    }

    /// The lattice of its points.
    pub const fn lattice(&self) -> &Lattice {
        &self.lattice
    }

    /// What the map holds of each beacon.
    pub const fn encoding(&self) -> Encoding {
        self.encoding
    }

    /// Refuses a map of another encoding.
    pub(super) const fn check_encoding(&self, wanted: Encoding) -> Result<(), ConfigError> {
        match (self.encoding, wanted) {
            (Encoding::Moments, Encoding::Moments) | (Encoding::Levels, Encoding::Levels) => Ok(()),
            _ => Err(ConfigError::new("map is of another encoding")),
        }
    }

    /// The distance in metres over which the correlation of the map's error falls to 1/e; 0 when that is not known, and
    /// readings are taken for independent.
    pub const fn error_length_m(&self) -> f32 {
        self.origin.error_length_m
    }

    /// What a tag at rest is off by, however long it is heard, because the error of the map stays as it is: the root mean
    /// square in metres of one look without noise, over the places of the map; 0 when that is not known.
    pub const fn rest_error_m(&self) -> f32 {
        0.01 * self.origin.rest_error_cm as f32
    }

    /// Standard deviation of a packet about the mean at its place, in dB.
    pub const fn noise_db(&self) -> f32 {
        0.25 * self.origin.noise as f32
    }

    /// When the survey was made, in days since 1970-01-01, if that is known.
    pub const fn surveyed_on(&self) -> Option<u32> {
        match self.origin.days {
            0 => None,
            days => Some(days),
        }
    }

    /// What was not chosen by the survey but by hand: see the format.
    pub const fn by_hand(&self) -> u8 {
        self.origin.by_hand
    }

    /// The number of beacons.
    pub const fn beacons(&self) -> usize {
        self.beacons.len() / BEACON
    }

    /// A beacon by its number, which counts from 0.
    pub fn beacon(&self, index: usize) -> Option<Beacon> {
        let record = self.beacons.as_chunks::<BEACON>().0.get(index)?;
        let [a, b, c, d, detection, sensitivity] = *record;
        Some(Beacon {
            identifier: u32::from_le_bytes([a, b, c, d]),
            detection: f32::from(detection) * (1.0 / 255.0),
            sensitivity_dbm: f32::from(sensitivity as i8),
        })
    }

    /// Whether it has the beacons of another map, in the same order.
    pub(super) const fn has_beacons_of(&self, other: &RadioMap<'_>) -> bool {
        if self.beacons.len() != other.beacons.len() {
            return false;
        }
        let mut at = 0;
        while at < self.beacons.len() {
            // Of the six bytes of a beacon, the identifier is the first four.
            if at % BEACON < 4 && self.beacons[at] != other.beacons[at] {
                return false;
            }
            at += 1;
        }
        true
    }

    /// The number of a beacon.
    pub fn beacon_index(&self, identifier: u32) -> Option<usize> {
        (0..self.beacons()).find(|index| {
            self.beacon(*index)
                .is_some_and(|beacon| beacon.identifier == identifier)
        })
    }

    /// Whether a tag can be at a point. Matching leaves out the others, and no particle goes there.
    #[inline(always)]
    pub fn is_possible(&self, point: usize) -> bool {
        self.possible
            .get(point / 8)
            .is_some_and(|bits| bits >> (point % 8) & 1 == 1)
    }

    /// Whether a tag can be at every point.
    pub(super) const fn is_complete(&self) -> bool {
        self.complete
    }

    /// A bit for each point, set where a tag can be.
    pub(super) const fn possible(&self) -> &'a [u8] {
        self.possible
    }

    /// How strong a beacon is at a point. `None` where it was not heard, for unknown numbers, and in a map of
    /// [`Encoding::Levels`].
    pub fn moments(&self, beacon: usize, point: usize) -> Option<Moments> {
        let [sigma, mean] = *self.moments_row(beacon)?.get(point)?;
        (sigma > 0).then(|| Moments {
            mean_dbm: 0.5 * f32::from(mean) + LOWEST_MEAN_DBM,
            sigma_db: 0.25 * f32::from(sigma),
        })
    }

    /// Natural logarithm of the density, per dB, of a level of a beacon at a point. `None` for unknown numbers, and
    /// in a map of [`Encoding::Moments`].
    pub fn log_density(&self, beacon: usize, rssi_dbm: f32, point: usize) -> Option<f32> {
        let row = self.level_row(beacon, self.level(rssi_dbm))?;
        let bytes = row.as_chunks::<4>().0.get(point / 8)?;
        let byte = bytes.get(point % 4)?;
        let code = if point & 4 == 0 { byte & 15 } else { byte >> 4 };
        (point < self.lattice.points())
            .then(|| self.levels.top - self.levels.step * f32::from(code))
    }

    /// Sigma and mean of a beacon at every point.
    pub(super) fn moments_row(&self, beacon: usize) -> Option<&'a [[u8; 2]]> {
        if self.encoding != Encoding::Moments {
            return None;
        }
        let points = self.lattice.points();
        let start = beacon.checked_mul(points)?;
        let (pairs, _) = self.data.as_chunks();
        pairs.get(start..start.checked_add(points)?)
    }

    /// Codes of a level of a beacon at every point. The level after the last is the beacon's absence.
    pub(super) fn level_row(&self, beacon: usize, level: usize) -> Option<&'a [u8]> {
        if self.encoding != Encoding::Levels || level > usize::from(self.levels.count) {
            return None;
        }
        let length = row_length(self.lattice.points());
        let rows = beacon.checked_mul(usize::from(self.levels.count) + 1)?;
        let start = rows.checked_add(level)?.checked_mul(length)?;
        self.data.get(start..start.checked_add(length)?)
    }

    pub(super) const fn levels(&self) -> &Levels {
        &self.levels
    }

    /// The level nearest to a reading.
    pub(super) fn level(&self, rssi_dbm: f32) -> usize {
        let Levels {
            lowest_dbm,
            spacing_db,
            count,
            ..
        } = self.levels;
        let above = (rssi_dbm - f32::from(lowest_dbm)) / f32::from(spacing_db);
        // Saturates; NaN becomes 0.
        ((above + 0.5) as usize).min(usize::from(count).saturating_sub(1))
    }
}
