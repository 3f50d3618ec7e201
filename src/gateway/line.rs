//! Bytes to lines.

use heapless::Vec;

use super::{Rejected, TakeSpectrum};

/// Longest NMEA sentence: the standard says 82, receivers send up to 102.
const NMEA_BYTES: usize = 120;
/// Longest event of a u-blox board, with two texts of 30 characters.
const UBLOX_BYTES: usize = 160;
/// Longest `%BBB/Q`.
const AGRELO_BYTES: usize = 6;
/// Longest first part of a KrakenSDR line, up to its spectrum.
const KRAKEN_BYTES: usize = 240;
/// Fields of a KrakenSDR line before its spectrum.
const KRAKEN_FIELDS: u8 = 17;
/// Longest KrakenSDR line, with its spectrum of 360 values.
const KRAKEN_LINE_BYTES: u16 = 8_192;

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Kind {
    /// `$...`
    Nmea,
    /// `%BBB/Q`
    Agrelo,
    /// `+UUDF:...`
    Ublox,
    /// `1617843840000, 297, ...`
    Kraken,
}

/// Collects the bytes of one line, as many as its kind may have.
#[derive(Debug)]
pub(super) struct LineReader<S> {
    kind: Option<Kind>,
    bytes: Vec<u8, KRAKEN_BYTES>,
    /// All bytes of the line, also those not kept.
    length: u16,
    commas: u8,
    overlong: bool,
    spectrum: S,
}

impl<S> LineReader<S> {
    pub const fn new(spectrum: S) -> Self {
        Self {
            kind: None,
            bytes: Vec::new(),
            length: 0,
            commas: 0,
            overlong: false,
            spectrum,
        }
    }

    /// The line that has just ended, until the next byte is pushed.
    pub fn bytes(&self) -> &[u8] {
        &self.bytes
    }

    /// Its spectrum.
    pub const fn spectrum(&self) -> &S {
        &self.spectrum
    }
}

impl<S: TakeSpectrum> LineReader<S> {
    /// Takes a byte; says what has ended with it, if anything. Empty lines end nothing.
    pub fn push(&mut self, byte: u8) -> Option<Result<Kind, Rejected>> {
        match byte {
            b'\r' | b'\n' => return self.end(),
            // What an idle or unplugged line sounds like.
            0 if self.length == 0 => {}
            // Where bytes were lost the next line begins in the middle of another.
            b'$' | b'%' if self.length > 0 && !self.may_hold(byte) => {
                self.begin(byte);
                return Some(Err(Rejected::Unparsable));
            }
            _ if self.length == 0 => self.begin(byte),
            _ => self.extend(byte),
        }
        None
    }

    /// Whether the first byte of a line may also stand within this one: both in the name of a KrakenSDR's
    /// station, `%` in the text of a sentence.
    fn may_hold(&self, byte: u8) -> bool {
        match self.kind {
            Some(Kind::Kraken) => true,
            Some(Kind::Nmea) => byte == b'%',
            // In its texts.
            Some(Kind::Ublox) => true,
            Some(Kind::Agrelo) | None => false,
        }
    }

    fn begin(&mut self, byte: u8) {
        self.kind = match byte {
            b'$' => Some(Kind::Nmea),
            b'%' => Some(Kind::Agrelo),
            b'+' => Some(Kind::Ublox),
            b'0'..=b'9' => Some(Kind::Kraken),
            _ => None,
        };
        self.bytes.clear();
        self.length = 0;
        self.commas = 0;
        self.overlong = false;
        if self.kind == Some(Kind::Kraken) {
            self.spectrum.begin();
        }
        self.extend(byte);
    }

    fn extend(&mut self, byte: u8) {
        self.length = self.length.saturating_add(1);
        let (kept, whole) = match self.kind {
            Some(Kind::Nmea) => (NMEA_BYTES, NMEA_BYTES as u16),
            Some(Kind::Agrelo) => (AGRELO_BYTES, AGRELO_BYTES as u16),
            Some(Kind::Ublox) => (UBLOX_BYTES, UBLOX_BYTES as u16),
            Some(Kind::Kraken) => (KRAKEN_BYTES, KRAKEN_LINE_BYTES),
            // Nothing of it is of interest, however long.
            None => return,
        };
        if self.length > whole {
            self.overlong = true;
        }
        if self.kind == Some(Kind::Kraken) {
            if self.commas >= KRAKEN_FIELDS {
                return self.spectrum.take(byte);
            }
            self.commas += u8::from(byte == b',');
            if self.commas >= KRAKEN_FIELDS {
                return;
            }
        }
        if self.bytes.len() >= kept || self.bytes.push(byte).is_err() {
            self.overlong = true;
        }
    }

    fn end(&mut self) -> Option<Result<Kind, Rejected>> {
        if self.length == 0 {
            return None;
        }
        self.length = 0;
        if self.kind == Some(Kind::Kraken) {
            self.spectrum.end();
        }
        Some(match self.kind {
            _ if self.overlong => Err(Rejected::Overlong),
            Some(kind) => Ok(kind),
            None => Err(Rejected::Unparsable),
        })
    }
}

#[cfg(test)]
mod tests {
    extern crate std;
    use super::*;
    use crate::gateway::SkipSpectrum;
    use std::{format, string::String, vec::Vec};

    fn read(input: &str) -> Vec<Result<(Kind, String), Rejected>> {
        let mut reader = LineReader::new(SkipSpectrum);
        let mut lines = Vec::new();
        for byte in input.bytes() {
            if let Some(end) = reader.push(byte) {
                let text = || String::from_utf8(reader.bytes().to_vec()).unwrap();
                lines.push(end.map(|kind| (kind, text())));
            }
        }
        lines
    }

    #[test]
    fn kinds_and_ends() {
        let lines = read("\r\n$GPHDT,1*00\r\n%045/7\r%270/9\n17,2\n\n\r?\r\nunfinished");
        let line = |kind, text| Ok((kind, String::from(text)));
        assert_eq!(
            lines,
            [
                line(Kind::Nmea, "$GPHDT,1*00"),
                line(Kind::Agrelo, "%045/7"),
                line(Kind::Agrelo, "%270/9"),
                line(Kind::Kraken, "17,2"),
                Err(Rejected::Unparsable),
            ]
        );
    }

    #[test]
    fn lost_bytes_cost_one_line() {
        let lines = read("$GPRMC,1235$GPHDT,1*00\r\nxx$GPHDT,2*00\r\n");
        let line = |text| Ok((Kind::Nmea, String::from(text)));
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
        let bearing = || Ok((Kind::Agrelo, String::from("%045/7")));
        for lost in ["%27", "/9", "x%270/"] {
            let lines = read(&format!("{lost}%045/7\r"));
            assert_eq!(lines.last(), Some(&bearing()), "{lost}");
            assert!(lines[..lines.len() - 1].iter().all(Result::is_err));
        }
        for text in ["$GPTXT,01,01,02,5%*00", "17,2,fox % $"] {
            assert!(matches!(&read(&format!("{text}\r"))[..], [Ok((_, line))] if line == text));
        }
    }

    #[test]
    fn an_idle_line_is_no_line() {
        let line = |kind, text| Ok((kind, String::from(text)));
        assert_eq!(
            read("\0\0%045/7\r\0\n\x0017,2\r\0$GPHDT,1*00\n\0\r"),
            [
                line(Kind::Agrelo, "%045/7"),
                line(Kind::Kraken, "17,2"),
                line(Kind::Nmea, "$GPHDT,1*00"),
            ]
        );
    }

    #[test]
    fn every_kind_has_its_longest_line() {
        let nmea = |n: usize| format!("${}\r\n", "x".repeat(n - 1));
        assert!(read(&nmea(120))[0].is_ok());
        assert_eq!(read(&nmea(121)), [Err(Rejected::Overlong)]);
        assert_eq!(read("%045/77\r"), [Err(Rejected::Overlong)]);

        let kraken = |spectrum: usize| format!("{}{}\n", "1,".repeat(17), "2".repeat(spectrum));
        let kept = read(&kraken(8_192 - 34));
        assert_eq!(kept, [Ok((Kind::Kraken, format!("{}1", "1,".repeat(16))))]);
        assert_eq!(read(&kraken(8_193 - 34)), [Err(Rejected::Overlong)]);
        assert_eq!(read(&kraken(100_000)), [Err(Rejected::Overlong)]);
        assert_eq!(
            read(&format!("{}\n", "1".repeat(241))),
            [Err(Rejected::Overlong)]
        );
    }
}
