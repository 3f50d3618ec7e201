//! Which radios still hear anything.

use crate::persist;

/// When each radio of the map was heard of last.
#[derive(Debug)]
pub(super) struct Radios<const B: usize> {
    /// When the last packet of any tag came, by radio; when the first of all came for a radio that has heard none.
    heard_ms: [u32; B],
    is_silent: [bool; B],
    has_begun: bool,
}

impl<const B: usize> Radios<B> {
    pub const EMPTY: Self = Self {
        heard_ms: [0; B],
        is_silent: [false; B],
        has_begun: false,
    };

    /// How many are silent.
    pub fn silent(&self) -> u32 {
        self.is_silent
            .iter()
            .map(|is_silent| u32::from(*is_silent))
            .sum()
    }

    /// Notes that one of the map's radios, of which there are so many, has heard a tag. Calls `tell` for each that has been
    /// silent for more than `silence_ms`, and for this one if it had been: with its number and whether it is silent.
    pub fn hear(
        &mut self,
        now_ms: u32,
        radio: usize,
        (radios, silence_ms): (usize, u32),
        mut tell: impl FnMut(usize, bool),
    ) {
        if !self.has_begun {
            self.heard_ms = [now_ms; B];
            self.has_begun = true;
        }
        let each = self.heard_ms.iter_mut().zip(&mut self.is_silent);
        for (number, (heard_ms, is_silent)) in each.enumerate().take(radios) {
            if number == radio {
                *heard_ms = now_ms;
            }
            // Clocks overflow; a time ahead is no silence.
            let silence = now_ms.wrapping_sub(*heard_ms) as i32;
            let silent = u32::try_from(silence).is_ok_and(|silence| silence > silence_ms);
            if silent != *is_silent {
                *is_silent = silent;
                tell(number, silent);
            }
        }
    }
}

persist!(impl[const B: usize] Radios<B> as "Radios"(B) { heard_ms, is_silent, has_begun });

#[cfg(test)]
mod tests {
    extern crate std;
    use super::*;
    use std::vec::Vec;

    #[test]
    fn a_silent_radio_is_told_of_once_and_again_when_it_is_heard() {
        // The fourth radio of the map has no room.
        let mut radios = Radios::<3>::EMPTY;
        let start = u32::MAX - 2_000;
        let mut told = Vec::new();
        for (after, radio) in [
            (0, 0),
            (4_000, 1),
            (5_000, 0),
            (5_100, 0),
            (6_000, 1),
            (7_000, 2),
        ] {
            let time = start.wrapping_add(after);
            radios.hear(time, radio, (4, 5_000), |radio, silent| {
                told.push((after, radio, silent))
            });
        }
        assert_eq!(told, [(5_100, 2, true), (7_000, 2, false)]);
        assert_eq!(radios.silent(), 0);
    }
}
