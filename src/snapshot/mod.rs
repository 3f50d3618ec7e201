//! Snapshots: the whole state of a locator as bytes, and back.
//!
//! A board that was without power for a moment need not drive past the source again: it goes on from the last snapshot
//! that it kept, to the last bit as if nothing had happened. What a snapshot holds is what its owner could not compute
//! anew; configurations are not in it.
//!
//! ```
//! use foxhunt::aoa::{Bearing, Clean, Locate, Observation, clean::Config};
//! use foxhunt::random::{SeedableRng, Xoshiro128PlusPlus};
//! use foxhunt::snapshot;
//!
//! type State = (Clean<100>, Xoshiro128PlusPlus);
//! let new = || (Clean::EMPTY, Xoshiro128PlusPlus::seed_from_u64(1));
//! let mut state: State = new();
//! let observation = Observation::new(0, [0.0, 0.0], Bearing::from_compass_degrees(36.6), 0.02)?;
//! state.0.push(&observation, &Config::DEFAULT, &mut state.1)?;
//!
//! let mut buffer = [0; snapshot::largest::<State>()];
//! let bytes = snapshot::save(&state, &mut buffer)?;
//! let mut restored: State = new();
//! snapshot::restore(&mut restored, bytes)?;
//! assert_eq!(restored.0.answer(), state.0.answer());
//! assert_eq!(restored.1, state.1);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # Format
//!
//! Little-endian, the same on every machine, without gaps:
//!
//! | bytes | |
//! |---|---|
//! | 4 | `FXSN` |
//! | 4 | version of the format: 1 |
//! | 4 | [shape](Persist::SHAPE) of the type: a hash of its name, its constants and its fields |
//! | 4 | length of the content in bytes |
//! | | the content: numbers as they are, lists after their length |
//! | 4 | CRC-32 (of Ethernet and zip) of all before it |
//!
//! Every field of a snapshot is checked before the first one is written: what cannot be restored leaves the state as it
//! was. The checksum is against accidents. Whoever forges a snapshot gets numbers of his own choice into a state, but no
//! panic out of it.
//!
//! This is no `serde` because that builds a value before it assigns it: with `postcard`, restoring a locator of 4 kB took
//! 18 kB of stack, and there was a panic in it.

mod cursor;
mod keeper;
pub(crate) mod list;
mod persist;
#[cfg(test)]
mod tests;

use crate::checksum::crc32_by_table;
use crate::error::messages;

pub use cursor::{Reader, Writer};
pub use keeper::Keeper;
#[doc(hidden)]
pub use persist::of_field;
pub use persist::{Persist, shape};
pub(crate) use persist::{Value, by_value, size_of_field, value, value_as};

const MAGIC: [u8; 4] = *b"FXSN";
const VERSION: u32 = 1;
/// Bytes before the content.
const HEADER: usize = 16;
/// Bytes after the content.
const CHECKSUM: usize = 4;

/// Why a state was not saved, or not restored.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub enum Error {
    /// The buffer is too small for a snapshot.
    BufferTooSmall {
        /// How many bytes this one takes.
        needed: usize,
    },
    /// The bytes do not begin like a snapshot.
    NotASnapshot,
    /// The snapshot is of another version of the format.
    Version {
        /// Which.
        found: u32,
    },
    /// Bytes are missing at the end.
    Truncated,
    /// The checksum is wrong.
    Checksum,
    /// The snapshot is of another type, or of one with other fields or constants, such as another number of particles. A
    /// [shape](Persist::SHAPE) does not see the types of a plain value's fields beyond their size.
    Shape,
    /// A value that no state has: the snapshot was forged, or by another program.
    Malformed,
}

messages!(Error {
    Self::BufferTooSmall { .. } => "the buffer is too small for a snapshot",
    Self::NotASnapshot => "the bytes are no snapshot",
    Self::Version { .. } => "the snapshot is of another version of the format",
    Self::Truncated => "the snapshot is truncated",
    Self::Checksum => "the checksum of the snapshot is wrong",
    Self::Shape => "the snapshot is of another type or size",
    Self::Malformed => "the snapshot holds a value that no state has",
});

/// The most bytes that a snapshot of a `T` takes.
pub const fn largest<T: Persist>() -> usize {
    HEADER + T::BYTES + CHECKSUM
}

/// Writes a snapshot of `state` to the front of `buffer`, and returns that part of it.
///
/// # Errors
/// [`Error::BufferTooSmall`]; what stands in the buffer then is no snapshot.
pub fn save<'b, T: Persist>(state: &T, buffer: &'b mut [u8]) -> Result<&'b [u8], Error> {
    let mut writer = Writer::new(buffer.get_mut(HEADER..).unwrap_or_default());
    state.save(&mut writer);
    let content = writer.count();
    seal(buffer, T::SHAPE, content)
}

/// Makes `state` what it was when the snapshot at the front of `bytes` was taken.
///
/// # Errors
/// When the bytes do not begin with a snapshot of such a type, whole and unharmed; `state` is then as
/// it was before.
pub fn restore<T: Persist>(state: &mut T, bytes: &[u8]) -> Result<(), Error> {
    take(state, Reader::new(open(bytes, T::SHAPE)?))
}

/// Reads the whole of a content, after a check of all.
fn take<T: Persist>(state: &mut T, mut content: Reader<'_>) -> Result<(), Error> {
    let mut reader = content.clone();
    state.check(&mut reader)?;
    if !reader.is_at_end() {
        return Err(Error::Malformed);
    }
    state.load(&mut content)
}

/// Puts a header and a checksum round the content.
#[inline(never)]
fn seal(buffer: &mut [u8], shape: u32, content: usize) -> Result<&[u8], Error> {
    let needed = HEADER + content + CHECKSUM;
    let too_small = Error::BufferTooSmall { needed };
    let sealed = buffer.split_at_mut_checked(HEADER + content);
    let (sealed, rest) = sealed.ok_or(too_small)?;
    let (checksum, _) = rest.split_first_chunk_mut().ok_or(too_small)?;
    let mut writer = Writer::new(sealed);
    writer.bytes(MAGIC);
    for number in [VERSION, shape, content as u32] {
        number.write(&mut writer);
    }
    *checksum = crc32_by_table(sealed).to_le_bytes();
    buffer.get(..needed).ok_or(too_small)
}

/// The content of the snapshot at the front of `bytes`.
#[inline(never)]
fn open(bytes: &[u8], shape: u32) -> Result<&[u8], Error> {
    let (magic, rest) = bytes.split_first_chunk().ok_or(Error::Truncated)?;
    if *magic != MAGIC {
        return Err(Error::NotASnapshot);
    }
    let mut reader = Reader::new(rest);
    let mut number = || u32::read(&mut reader).map_err(|_| Error::Truncated);
    let (found, of, content) = (number()?, number()?, number()? as usize);
    if found != VERSION {
        return Err(Error::Version { found });
    }
    let sealed = HEADER.saturating_add(content);
    let (sealed, rest) = bytes.split_at_checked(sealed).ok_or(Error::Truncated)?;
    let (checksum, _) = rest.split_first_chunk().ok_or(Error::Truncated)?;
    if crc32_by_table(sealed) != u32::from_le_bytes(*checksum) {
        return Err(Error::Checksum);
    }
    if of != shape {
        return Err(Error::Shape);
    }
    sealed.get(HEADER..).ok_or(Error::Truncated)
}
