extern crate std;

use std::{vec, vec::Vec};

use embedded_storage::nor_flash::{ErrorType, NorFlash, NorFlashErrorKind, ReadNorFlash};
use foxhunt::aoa::{Bearing, Clean, Locate, Observation, clean};
use foxhunt::random::{SeedableRng, Xoshiro128PlusPlus};

use super::*;

type State = Clean<20, 4>;

pub(crate) const PAGE: usize = 256;
/// They begin at the third page.
const START: u32 = 2 * PAGE as u32;
const BYTES: usize = snapshot::largest::<State>().next_multiple_of(4);

/// Flash whose power fails after so many words and pages, and then does nothing more.
#[derive(Clone)]
pub(crate) struct Flash {
    bytes: Vec<u8>,
    erased: Vec<u32>,
    left: usize,
}

impl Flash {
    pub(crate) fn new(pages: usize) -> Self {
        Self {
            bytes: vec![0xA5; pages * PAGE],
            erased: vec![0; pages],
            left: usize::MAX,
        }
    }

    fn spend(&mut self) -> Result<(), NorFlashErrorKind> {
        self.left = self.left.checked_sub(1).ok_or(NorFlashErrorKind::Other)?;
        Ok(())
    }
}

impl ErrorType for Flash {
    type Error = NorFlashErrorKind;
}

impl ReadNorFlash for Flash {
    const READ_SIZE: usize = 1;

    fn read(&mut self, offset: u32, bytes: &mut [u8]) -> Result<(), Self::Error> {
        let from = self.bytes.get(offset as usize..).unwrap();
        let from = from.get(..bytes.len());
        bytes.copy_from_slice(from.ok_or(NorFlashErrorKind::OutOfBounds)?);
        Ok(())
    }

    fn capacity(&self) -> usize {
        self.bytes.len()
    }
}

impl NorFlash for Flash {
    const WRITE_SIZE: usize = 4;
    const ERASE_SIZE: usize = PAGE;

    fn erase(&mut self, from: u32, to: u32) -> Result<(), Self::Error> {
        for page in (from..to).step_by(PAGE) {
            self.spend()?;
            let page = page as usize;
            self.bytes[page..page + PAGE].fill(0xFF);
            self.erased[page / PAGE] += 1;
        }
        Ok(())
    }

    fn write(&mut self, offset: u32, bytes: &[u8]) -> Result<(), Self::Error> {
        assert!(offset.is_multiple_of(4) && bytes.len().is_multiple_of(4));
        for (number, word) in bytes.chunks(4).enumerate() {
            self.spend()?;
            for (place, byte) in word.iter().enumerate() {
                self.bytes[offset as usize + 4 * number + place] &= byte;
            }
        }
        Ok(())
    }
}

fn slots(flash: Flash) -> Slots<Flash> {
    let end = (flash.bytes.len()) as u32;
    Slots::new(flash, START..end, BYTES).unwrap()
}

/// Slots of a board that has just started.
fn started(flash: Flash) -> Slots<Flash> {
    let mut slots = slots(flash);
    let mut state = State::EMPTY;
    let _ = slots.restore(&mut state, &mut [0; BYTES]);
    slots
}

/// What is known after so many bearings.
fn after(bearings: u16) -> State {
    let mut rng = Xoshiro128PlusPlus::seed_from_u64(1);
    let mut state = State::EMPTY;
    for i in 0..bearings {
        let bearing = Bearing::from_compass_degrees(40.0 + f32::from(i));
        let place = [50.0 * f32::from(i), 0.0];
        let observation = Observation::new(1000 * u32::from(i), place, bearing, 0.03).unwrap();
        let config = clean::Config::DEFAULT;
        state.push(&observation, &config, &mut rng).unwrap();
    }
    state
}

fn bytes(state: &State) -> Vec<u8> {
    let mut buffer = [0; BYTES];
    snapshot::save(state, &mut buffer).unwrap().to_vec()
}

/// Number and bytes of the state that a board finds when it starts.
fn found(flash: &Flash) -> Result<(u32, Vec<u8>), Error> {
    let mut state = State::EMPTY;
    let number = slots(flash.clone()).restore(&mut state, &mut [0; BYTES])?;
    Ok((number, bytes(&state)))
}

#[test]
fn the_newest_is_found_all_round_and_pages_wear_alike() {
    let mut flash = Flash::new(20);
    assert_eq!(found(&flash), Err(Error::Empty));
    for count in 1..=60 {
        // A reset after each.
        let mut slots = started(flash);
        slots.save(&after(count), &mut [0; BYTES]).unwrap();
        flash = slots.flash;
        assert_eq!(found(&flash), Ok((count.into(), bytes(&after(count)))));
    }
    let (before, pages) = flash.erased.split_at(2);
    assert_eq!(before, [0, 0]);
    let worn = pages.iter().filter(|erased| **erased > 0);
    let (least, most) = (worn.clone().min().unwrap(), worn.max().unwrap());
    assert!(*most <= least + 1, "{:?}", flash.erased);
}

#[test]
fn power_that_fails_at_any_word_leaves_the_last_one() {
    let mut flash = Flash::new(20);
    for count in 1..=12 {
        let before = found(&flash);
        let mut cut = 0;
        loop {
            let mut slots = started(flash.clone());
            slots.flash.left = cut;
            if slots.save(&after(count), &mut [0; BYTES]).is_ok() {
                flash = slots.flash;
                flash.left = usize::MAX;
                break;
            }
            assert_eq!(found(&slots.flash), before, "cut after {cut}");
            cut += 1;
        }
        assert!(cut > 20);
    }
}

#[test]
fn one_that_is_damaged_is_passed_over_and_its_number_is_not_used_again() {
    let mut slots = slots(Flash::new(20));
    for count in 1..=3 {
        slots.save(&after(count), &mut [0; BYTES]).unwrap();
    }
    let newest = slots.address(2) as usize;
    slots.flash.bytes[newest + 100] ^= 1;
    assert_eq!(found(&slots.flash), Ok((2, bytes(&after(2)))));
    let mut slots = started(slots.flash);
    slots.save(&after(9), &mut [0; BYTES]).unwrap();
    assert_eq!(found(&slots.flash), Ok((4, bytes(&after(9)))));
    slots.clear().unwrap();
    assert_eq!(found(&slots.flash), Err(Error::Empty));
}

#[test]
fn what_is_too_small_keeps_nothing() {
    let flash = Flash::new(3);
    let new = Slots::new(flash, START..3 * PAGE as u32, BYTES);
    assert_eq!(new.map(drop).unwrap_err(), Error::TooSmall);
    let mut slots = slots(Flash::new(20));
    let error = slots.save(&after(2), &mut [0; 64]).unwrap_err();
    assert_eq!(error, Error::TooSmall);
}
