//! Snapshots in pages of flash, one after the other all round, so that all pages wear alike.

use core::ops::Range;

use embedded_storage::nor_flash::NorFlash;
use foxhunt::snapshot::{self, Persist};

/// Bytes before a snapshot: its number, and the same inverted, which are written when all else is.
const HEADER: u32 = 8;

/// Why there is nothing to go on with, or nothing was kept.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(target_os = "none", derive(defmt::Format))]
#[non_exhaustive]
pub enum Error {
    /// The pages hold no whole snapshot of such a state.
    Empty,
    /// The buffer, or the pages, are too small for a snapshot.
    TooSmall,
    /// The flash did not do what it was told.
    Flash,
}

/// Places for a snapshot in a range of pages. Whenever writing is cut short, the snapshot before is whole.
#[derive(Debug)]
pub struct Slots<F> {
    flash: F,
    pages: Range<u32>,
    /// Bytes of a place: whole pages.
    bytes: u32,
    /// Number of the newest snapshot; the first has one.
    number: u32,
    /// The place of the next one.
    next: u32,
}

impl<F: NorFlash> Slots<F> {
    /// Pages in this range of addresses, for snapshots of so many bytes at most.
    ///
    /// # Errors
    /// [`Error::TooSmall`] unless there are two places.
    pub fn new(flash: F, pages: Range<u32>, largest: usize) -> Result<Self, Error> {
        let largest = u32::try_from(largest).map_err(|_| Error::TooSmall)?;
        let page = const { F::ERASE_SIZE as u32 };
        let bytes = HEADER
            .checked_add(largest)
            .and_then(|bytes| bytes.checked_next_multiple_of(page))
            .ok_or(Error::TooSmall)?;
        let slots = Self {
            flash,
            pages,
            bytes,
            number: 0,
            next: 0,
        };
        if slots.count() < 2 {
            return Err(Error::TooSmall);
        }
        Ok(slots)
    }

    /// Makes `state` what it was when the newest snapshot was taken that can be restored, and returns the number of that.
    ///
    /// # Errors
    /// [`Error::Empty`] when there is none; `state` is then as it was.
    pub fn restore<T: Persist>(&mut self, state: &mut T, buffer: &mut [u8]) -> Result<u32, Error> {
        // One that is newer than that which is restored is broken, but has had its number.
        let mut below = u32::MAX;
        while let Some((number, place)) = self.newest(below) {
            if below == u32::MAX {
                self.number = number;
                self.next = self.after(place);
            }
            let (bytes, _) = buffer.split_at_mut(buffer.len().min((self.bytes - HEADER) as usize));
            let read = self.flash.read(self.address(place) + HEADER, bytes);
            if read.is_ok() && snapshot::restore(state, bytes).is_ok() {
                return Ok(number);
            }
            below = number;
        }
        Err(Error::Empty)
    }

    /// Writes a snapshot over the oldest one.
    ///
    /// # Errors
    /// When it does not fit, or the flash fails; the newest one stays what it is.
    pub fn save<T: Persist>(&mut self, state: &T, buffer: &mut [u8]) -> Result<(), Error> {
        let length = snapshot::save(state, buffer)
            .map_err(|_| Error::TooSmall)?
            .len();
        let whole = length.next_multiple_of(const { F::WRITE_SIZE });
        let bytes = buffer.get(..whole).ok_or(Error::TooSmall)?;
        if bytes.len() > (self.bytes - HEADER) as usize {
            return Err(Error::TooSmall);
        }
        let number = self.number.wrapping_add(1);
        let address = self.address(self.next);
        let written = (|| {
            self.flash.erase(address, address + self.bytes)?;
            self.flash.write(address + HEADER, bytes)?;
            self.flash.write(address, &header(number))
        })();
        written.map_err(|_| Error::Flash)?;
        self.number = number;
        self.next = self.after(self.next);
        Ok(())
    }

    /// Erases all of them: what they are of is no more.
    ///
    /// # Errors
    /// [`Error::Flash`].
    pub fn clear(&mut self) -> Result<(), Error> {
        let end = self.address(self.count());
        let erased = self.flash.erase(self.pages.start, end);
        erased.map_err(|_| Error::Flash)
    }

    /// The flash, for what else is in it.
    pub fn flash(&mut self) -> &mut F {
        &mut self.flash
    }

    fn count(&self) -> u32 {
        let pages = self.pages.end.saturating_sub(self.pages.start);
        pages.checked_div(self.bytes).unwrap_or(0)
    }

    fn address(&self, place: u32) -> u32 {
        self.pages.start + place * self.bytes
    }

    fn after(&self, place: u32) -> u32 {
        let next = place + 1;
        if next < self.count() { next } else { 0 }
    }

    /// Number and place of the newest snapshot with a number below this one.
    fn newest(&mut self, below: u32) -> Option<(u32, u32)> {
        let mut newest = None;
        for place in 0..self.count() {
            let mut found = [0; HEADER as usize];
            if self.flash.read(self.address(place), &mut found).is_err() {
                continue;
            }
            let (number, _) = found.split_first_chunk()?;
            let number = u32::from_le_bytes(*number);
            if found == header(number)
                && number < below
                && newest.is_none_or(|(newest, _)| newest < number)
            {
                newest = Some((number, place));
            }
        }
        newest
    }
}

fn header(number: u32) -> [u8; HEADER as usize] {
    let number = u64::from(number) | u64::from(!number) << 32;
    number.to_le_bytes()
}

#[cfg(test)]
pub(crate) mod tests;
