//! Bytes to lines.

use heapless::Vec;

use super::formats::format::{Framing, Sentence};
use super::formats::{self, Formats};
use super::outcome::Rejected;

/// The most bytes of a line that are kept: those of a KrakenSDR before its spectrum.
const KEPT_BYTES: usize = 240;

/// Collects the bytes of one line, as many as its format keeps.
#[derive(Debug)]
pub(super) struct LineReader<F> {
    formats: F,
    /// The format of the line: see [`Set::which`](formats::format::Set::which).
    which: u8,
    bytes: Vec<u8, KEPT_BYTES>,
    /// All bytes of the line, also those not kept.
    length: u16,
    commas: u8,
    overlong: bool,
}

impl<F> LineReader<F> {
    /// The line that has just ended, until the next byte is pushed.
    pub fn bytes(&self) -> &[u8] {
        &self.bytes
    }

    /// What formats know of their last lines beyond the bytes.
    pub const fn formats(&self) -> &F {
        &self.formats
    }
}

impl<F: Formats> LineReader<F> {
    pub const EMPTY: Self = Self {
        formats: F::EMPTY,
        which: 0,
        bytes: Vec::new(),
        length: 0,
        commas: 0,
        overlong: false,
    };

    /// Takes a byte; says whether a line has ended with it, and if so whether it can be parsed. Empty lines end nothing.
    pub fn push(&mut self, byte: u8) -> Option<Result<(), Rejected>> {
        if F::FRAMED && self.length > 0 && self.is_framed() {
            let framing = if self.length > 1 || self.continues(byte) {
                self.formats.frame(self.which, byte)
            } else {
                Framing::None
            };
            if framing != Framing::None {
                return self.push_framed(byte, framing);
            }
            // The rest is as good as text of no kind, in which others may begin.
            self.which = 0;
        }
        match byte {
            b'\r' | b'\n' => return self.end(),
            // What an idle or unplugged line sounds like.
            0 if self.length == 0 => {}
            // Where bytes were lost the next line begins in the middle of another.
            _ if self.length > 0 && self.is_interrupted_by(byte) => {
                self.begin(byte);
                return Some(Err(Rejected::Unparsable));
            }
            _ if self.length == 0 => self.begin(byte),
            _ => {
                while self.length == 1 && !self.continues(byte) {
                    let first = self.bytes.first().copied().unwrap_or_default();
                    self.begin_as(F::which(first, self.which), first);
                }
                self.extend(byte);
            }
        }
        None
    }

    /// Takes a byte of a binary frame, of which as many bytes are kept as there is room for.
    #[inline(never)]
    fn push_framed(&mut self, byte: u8, framing: Framing) -> Option<Result<(), Rejected>> {
        let Framing::Interrupted((recent, count)) = framing else {
            self.length = self.length.saturating_add(1);
            let _ = self.bytes.push(byte);
            return (framing == Framing::End).then(|| {
                self.length = 0;
                Ok(())
            });
        };
        let recent = recent.to_be_bytes();
        let mut begun = recent.iter().rev().take(usize::from(count)).rev();
        self.begin(begun.next().copied().unwrap_or_default());
        let is_framed = self.is_framed();
        for byte in begun {
            self.extend(*byte);
            if is_framed {
                self.formats.frame(self.which, *byte);
            }
        }
        Some(Err(Rejected::Checksum))
    }

    /// What the line that has just ended says.
    pub fn parse(&mut self, config: &formats::Config) -> Result<Sentence, Rejected> {
        self.formats.parse(self.which, &self.bytes, config)
    }

    fn is_framed(&self) -> bool {
        F::layout(self.which).is_some_and(|layout| layout.is_framed)
    }

    /// Whether this may be the second byte of the line.
    fn continues(&self, byte: u8) -> bool {
        F::layout(self.which).is_none_or(|layout| (layout.continues)(byte))
    }

    /// Whether a byte within this line begins another.
    fn is_interrupted_by(&self, byte: u8) -> bool {
        F::layout(F::which(byte, 0)).is_some_and(|next| next.interrupts)
            && !F::layout(self.which).is_some_and(|layout| (layout.holds)(&self.bytes, byte))
    }

    fn begin(&mut self, byte: u8) {
        self.begin_as(F::which(byte, 0), byte);
    }

    // Once a line.
    #[inline(never)]
    fn begin_as(&mut self, which: u8, byte: u8) {
        self.which = which;
        self.bytes.clear();
        self.length = 0;
        self.commas = 0;
        self.overlong = false;
        if F::RESTS || F::FRAMED {
            self.formats.begin(self.which);
        }
        self.extend(byte);
    }

    fn extend(&mut self, byte: u8) {
        self.length = self.length.saturating_add(1);
        // Nothing of an unknown line is of interest, however long.
        let Some(layout) = F::layout(self.which) else {
            return;
        };
        // Blanks at the end do not count.
        if self.length > layout.longest && byte != b' ' {
            self.overlong = true;
        }
        if layout.fields < u8::MAX {
            if self.commas >= layout.fields {
                if F::RESTS {
                    self.formats.rest(self.which, byte);
                }
                return;
            }
            self.commas += u8::from(byte == b',');
            if self.commas >= layout.fields {
                return;
            }
        }
        if self.overlong || self.bytes.push(byte).is_err() {
            self.overlong = true;
        }
    }

    fn end(&mut self) -> Option<Result<(), Rejected>> {
        if self.length == 0 {
            return None;
        }
        self.length = 0;
        while self.bytes.last() == Some(&b' ') {
            self.bytes.pop();
        }
        Some(match self.which {
            _ if self.overlong => Err(Rejected::Overlong),
            0 => Err(Rejected::Unparsable),
            _ => Ok(()),
        })
    }
}

#[cfg(test)]
mod tests {
    extern crate std;
    use super::*;
    use crate::gateway::formats::All;
    use std::{format, string::String, vec::Vec};

    fn read(input: &str) -> Vec<Result<String, Rejected>> {
        let mut reader = LineReader::<All>::EMPTY;
        let mut lines = Vec::new();
        for byte in input.bytes() {
            if let Some(end) = reader.push(byte) {
                let text = || String::from_utf8(reader.bytes().to_vec()).unwrap();
                lines.push(end.map(|()| text()));
            }
        }
        lines
    }

    #[test]
    fn lines_end_by_cr_or_lf() {
        let lines = read("\r\n$GPHDT,1*00\r\n%045/7\r%270/9\n17,2\n\n\r?\r\nunfinished");
        let line = |text| Ok(String::from(text));
        assert_eq!(
            lines,
            [
                line("$GPHDT,1*00"),
                line("%045/7"),
                line("%270/9"),
                line("17,2"),
                Err(Rejected::Unparsable),
            ]
        );
    }

    #[test]
    fn zeros_are_silence_between_lines_and_damage_within() {
        let lines = read("\0\0%045/7\r\0\0%270/9\r%0\x0045/7\r");
        let line = |text| Ok(String::from(text));
        assert_eq!(
            lines,
            [line("%045/7"), line("%270/9"), Err(Rejected::Overlong)]
        );
        assert_eq!(read("%0\x005/7\r"), [line("%0\x005/7")]);
    }

    #[test]
    fn lost_bytes_cost_one_line() {
        let lines = read("$GPRMC,1235$GPHDT,1*00\r\nxx$GPHDT,2*00\r\n");
        let line = |text| Ok(String::from(text));
        assert_eq!(
            lines,
            [
                Err(Rejected::Unparsable),
                line("$GPHDT,1*00"),
                Err(Rejected::Unparsable),
                line("$GPHDT,2*00"),
            ]
        );
    }

    #[test]
    fn lost_bytes_cost_no_bearing_that_is_whole() {
        let bearing = || Ok(String::from("%045/7"));
        for lost in ["%27", "/9", "x%270/"] {
            let lines = read(&format!("{lost}%045/7\r"));
            assert_eq!(lines.last(), Some(&bearing()), "{lost}");
            assert!(lines[..lines.len() - 1].iter().all(Result::is_err));
        }
        for text in [
            "$GPTXT,01,01,02,5% up!*00",
            "1756823719250, 297, 87.8, -32, 43, UCA, 1, fox % $",
        ] {
            assert!(matches!(&read(&format!("{text}\r"))[..], [Ok(line)] if line == text));
        }
    }

    #[test]
    fn a_dollar_begins_a_sentence_anywhere_but_in_the_name_of_a_station() {
        let sentence = || Ok(String::from("$GPHDT,1*00"));
        for before in [
            "8\u{4}\0\0fc",
            "17,2,",
            "1756823719250, 297, 87.8",
            "1756823719250, 297, 87.8, -32, 43, UCA, 1, fox, 48",
            "x1756823719250, 297, 87.8, -32, 43, UCA, 1, fox",
            "1756823719250x, 297, 87.8, -32, 43, UCA, 1, fox",
            "+UUDF:6C1DEBA4241B,-65,26,-65,6,37,\"",
            "!AIVDM,1,1,,A,15RT",
            "1,1,1,1,1,1,1,1,1,1,1,1,1,1,1,1,1,0.5, 0.25",
        ] {
            let lines = read(&format!("{before}$GPHDT,1*00\r"));
            assert_eq!(lines, [Err(Rejected::Unparsable), sentence()], "{before}");
        }
    }

    #[test]
    fn blanks_at_the_end_are_no_part_of_a_line() {
        let line = |text| Ok(String::from(text));
        assert_eq!(
            read("%143/7 \r%143/7   \n$GPHDT,1*47 \r\n   \r17,2 , \n"),
            [
                line("%143/7"),
                line("%143/7"),
                line("$GPHDT,1*47"),
                Err(Rejected::Unparsable),
                line("17,2 ,"),
            ]
        );
        assert_eq!(read("%143/7 x\r"), [Err(Rejected::Overlong)]);
    }

    #[test]
    fn a_second_byte_may_tell_that_it_is_no_line() {
        for text in ["$1", "!48", "8\u{4}", "1,"] {
            assert_eq!(read(&format!("{text}\r")), [Err(Rejected::Unparsable)]);
        }
    }

    #[test]
    fn an_idle_line_is_no_line() {
        let line = |text| Ok(String::from(text));
        assert_eq!(
            read("\0\0%045/7\r\0\n\x0017,2\r\0$GPHDT,1*00\n\0\r"),
            [line("%045/7"), line("17,2"), line("$GPHDT,1*00"),]
        );
    }

    #[test]
    fn every_format_has_its_longest_line() {
        let nmea = |n: usize| format!("${}\r\n", "X".repeat(n - 1));
        assert!(read(&nmea(120))[0].is_ok());
        assert_eq!(read(&nmea(121)), [Err(Rejected::Overlong)]);
        assert_eq!(read("%045/77\r"), [Err(Rejected::Overlong)]);

        let kraken = |spectrum: usize| format!("1{}{}\n", "1,".repeat(17), "2".repeat(spectrum));
        let kept = read(&kraken(8_192 - 35));
        assert_eq!(kept, [Ok(format!("1{}1", "1,".repeat(16)))]);
        assert_eq!(read(&kraken(8_193 - 35)), [Err(Rejected::Overlong)]);
        assert_eq!(read(&kraken(100_000)), [Err(Rejected::Overlong)]);
        assert_eq!(
            read(&format!("{}\n", "1".repeat(241))),
            [Err(Rejected::Overlong)]
        );
    }
}
