//! The upper half of the flash: a radio map, and snapshots.

use core::ops::Range;

use embassy_nrf::nvmc::{Error, FLASH_SIZE, Nvmc, PAGE_SIZE};
use embedded_storage::nor_flash::NorFlash;
use foxhunt::fingerprint::RadioMap;
use foxhunt_gateways::corridor;

/// The pages of the map: its length in bytes, and itself.
const MAP: Range<u32> = 0x8_0000..0x8_8000;

/// The pages of the snapshots. Each page is erased once in a round; it bears 10,000.
pub const SNAPSHOTS: Range<u32> = MAP.end..FLASH_SIZE as u32;

/// Bytes before the map.
const LENGTH: usize = 4;

const _: () = assert!(
    corridor::MAP_BYTES + LENGTH <= (MAP.end - MAP.start) as usize
        && (MAP.end as usize).is_multiple_of(PAGE_SIZE)
);

/// The map in the pages, in place, if there is one for which the gateway has room. To be asked once, at the start: whoever
/// writes another map resets the board.
pub fn map() -> Option<RadioMap<'static>> {
    let (length, bytes) = pages(MAP).split_first_chunk::<LENGTH>()?;
    let length = usize::try_from(u32::from_le_bytes(*length)).ok()?;
    corridor::fitting(RadioMap::new(bytes.get(..length)?).ok()?)
}

/// Replaces the map.
///
/// # Errors
/// When it has no room.
pub fn keep_map(flash: &mut Nvmc<'_>, map: &[u8]) -> Result<(), Error> {
    let (words, rest) = map.as_chunks::<{ Nvmc::WRITE_SIZE }>();
    let end = MAP.start + LENGTH as u32 + words.as_flattened().len() as u32;
    if end >= MAP.end {
        return Err(Error::OutOfBounds);
    }
    flash.erase(MAP.start, MAP.end)?;
    flash.write(MAP.start + LENGTH as u32, words.as_flattened())?;
    let mut last = [0xFF; Nvmc::WRITE_SIZE];
    for (to, from) in last.iter_mut().zip(rest) {
        *to = *from;
    }
    flash.write(end, &last)?;
    // Until this is written, there is no map.
    flash.write(MAP.start, &(map.len() as u32).to_le_bytes())
}

#[allow(unsafe_code)]
fn pages(range: Range<u32>) -> &'static [u8] {
    let length = range.end.saturating_sub(range.start).min(FLASH_SIZE as u32);
    // SAFETY: the flash is there and can be read at any time, and the linker puts nothing into its upper half. Only
    // `keep_map` writes there, after which the board is reset.
    unsafe { core::slice::from_raw_parts(range.start as *const u8, length as usize) }
}
