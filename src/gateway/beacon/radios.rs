//! Which radios still hear anything.

/// When each radio of the map was heard of last.
#[derive(Debug)]
pub(super) struct Radios<const B: usize> {
    silence_ms: u32,
    /// Time of the last packet of any tag, by radio; of the first packet of all for a radio that has heard none.
    heard_ms: [u32; B],
    is_silent: [bool; B],
    has_begun: bool,
}

impl<const B: usize> Radios<B> {
    pub const fn new(silence_ms: u32) -> Self {
        Self {
            silence_ms,
            heard_ms: [0; B],
            is_silent: [false; B],
            has_begun: false,
        }
    }

    pub fn clear(&mut self) {
        *self = Self::new(self.silence_ms);
    }

    /// How many are silent.
    pub fn silent(&self) -> u32 {
        self.is_silent
            .iter()
            .map(|is_silent| u32::from(*is_silent))
            .sum()
    }

    /// Takes note that one of the map's radios has heard a tag, and calls `tell` for each that has fallen silent, and for
    /// this one if it had: with its number and whether it is silent.
    pub fn hear(
        &mut self,
        time_ms: u32,
        radio: usize,
        radios: usize,
        mut tell: impl FnMut(usize, bool),
    ) {
        if !self.has_begun {
            self.heard_ms = [time_ms; B];
            self.has_begun = true;
        }
        let each = self.heard_ms.iter_mut().zip(&mut self.is_silent);
        for (number, (heard_ms, is_silent)) in each.enumerate().take(radios) {
            if number == radio {
                *heard_ms = time_ms;
            }
            // Clocks overflow; a time ahead is no silence.
            let silence = time_ms.wrapping_sub(*heard_ms) as i32;
            let silent = u32::try_from(silence).is_ok_and(|silence| silence > self.silence_ms);
            if silent != *is_silent {
                *is_silent = silent;
                tell(number, silent);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    extern crate std;
    use super::*;
    use std::vec::Vec;

    #[test]
    fn a_silent_radio_is_told_of_once_and_again_when_it_is_heard() {
        let mut radios = Radios::<3>::new(5_000);
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
            radios.hear(time, radio, 3, |radio, silent| {
                told.push((after, radio, silent))
            });
        }
        assert_eq!(told, [(5_100, 2, true), (7_000, 2, false)]);
        assert_eq!(radios.silent(), 0);
    }
}
