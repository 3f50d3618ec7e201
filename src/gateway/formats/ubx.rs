//! The binary form of u-blox receivers: UBX, of which `NAV-PVT` is read.
//!
//! A frame is `B5 62`, class, identifier, length of the payload (two bytes), payload, and a checksum of two bytes (Fletcher's,
//! over all from the class to the payload's end). Numbers begin with the low byte. `NAV-PVT` is `01 07` with a payload of 92
//! bytes, or of 84 from before protocol 15:
//!
//! | offset | field | unit, sense | taken as |
//! |---|---|---|---|
//! | 8, 9, 10 | hour, minute, second | UTC, if bit 1 of 11 is set | time, with the next |
//! | 16 | nanoseconds, signed | ns | added to it, rounded to milliseconds |
//! | 20 | kind of fix | 1 dead reckoning, 2 plane, 3 space, 4 both | whether there is a position: else none |
//! | 21 | flags | bit 0 fix is good, bit 5 heading is valid | the same |
//! | 24, 28 | longitude, latitude | 1e-7 degree | place |
//! | 60 | speed over ground | mm/s | speed |
//! | 64 | heading of motion | 1e-5 degree clockwise from true north | course over ground |
//! | 78 | flags | bit 0 place is void | no position |
//! | 84 | heading of the vehicle | 1e-5 degree clockwise from true north | true heading, if valid (receivers with inertial sensors) |
//! | 88 | magnetic declination, signed | 1e-2 degree clockwise | variation, if bit 3 of 11 is set |
//!
//! Frames of other kinds are left to others. Source: u-blox M10 interface description UBX-21035062, chapter 3.15.11; for 84
//! bytes, M8 receiver description UBX-13003221.
//!
//! Frames may come between sentences on one port, and damage must cost no more than it hits: `$`, five letters or digits and
//! a comma or `*` begin a sentence even within a frame, as the first six bytes of `NAV-PVT` begin another frame; by chance
//! either stands in one of 10^6 frames of a kilobyte.

use super::format::{Format, Framing, Heading, Layout, Motion, Sentence, Statement};
use crate::aoa::geodesy::Geodetic;
use crate::gateway::clock::TimeOfDay;
use crate::gateway::outcome::Rejected;

/// Frames of UBX.
#[derive(Debug)]
pub struct Ubx {
    /// Bytes of the frame so far.
    count: u16,
    /// All that it has, once known.
    length: u16,
    /// Fletcher's sums of the bytes from the class on, up to those that the frame states.
    sums: [u8; 2],
    /// The last eight bytes, the newest in the lowest.
    recent: u64,
}

/// The longest frame that is followed; what seems longer is damaged.
const LONGEST: u16 = 4_096;

/// Bytes before the payload, and after it.
const HEADER: u16 = 6;
const CHECKSUM: u16 = 2;

impl Format for Ubx {
    type Config = ();
    const DEFAULT: () = ();
    const LAYOUT: Layout = Layout {
        longest: LONGEST,
        is_framed: true,
        begins: |byte| byte == 0xb5,
        continues: |byte| byte == 0x62,
        interrupts: true,
        ..Layout::TEXT
    };
    const EMPTY: Self = Self {
        count: 0,
        length: 0,
        sums: [0; 2],
        recent: 0,
    };

    fn begin(&mut self) {
        *self = Self {
            count: 1,
            ..Self::EMPTY
        };
    }

    fn frame(&mut self, byte: u8) -> Framing {
        let place = self.count;
        self.count += 1;
        self.recent = self.recent << 8 | u64::from(byte);
        if place == HEADER - 1 {
            let payload = self.recent as u16;
            let length = payload.swap_bytes().saturating_add(HEADER + CHECKSUM);
            if length > LONGEST {
                return self.resumed(Framing::None);
            }
            self.length = length;
        }
        if let Some(begun) = begun_within(self.recent) {
            return Framing::Interrupted(begun);
        }
        if place < 2 {
            return Framing::More;
        }
        let is_content = place < HEADER || place + CHECKSUM < self.length;
        if is_content {
            let [first, second] = self.sums;
            let first = first.wrapping_add(byte);
            self.sums = [first, second.wrapping_add(first)];
        }
        if place < HEADER || place + 1 < self.length {
            return Framing::More;
        }
        if self.is_right() {
            return Framing::End;
        }
        self.resumed(Framing::End)
    }

    #[inline(never)]
    fn parse(&mut self, frame: &[u8], _config: &()) -> Result<Sentence, Rejected> {
        let [_, _, class, identifier, _, _, payload @ ..] = frame else {
            return Err(Rejected::Unparsable);
        };
        match (self.is_right(), [class, identifier]) {
            (true, [1, 7]) => pvt(payload),
            (true, _) => Ok(Sentence::Other),
            (false, [1, 7]) => Ok(Sentence::Lost(Rejected::Checksum)),
            (false, _) => Err(Rejected::Checksum),
        }
    }
}

impl Ubx {
    /// Where bytes were lost, those of the next line have taken their place: it begins among the last ones, or there is
    /// nothing to go on with.
    fn resumed(&self, otherwise: Framing) -> Framing {
        let tail = self.recent.to_be_bytes();
        let last = tail.iter().rev().zip(1..);
        let mut begun = last.filter(|(byte, _)| matches!(byte, b'$' | 0xb5));
        match begun.next() {
            Some((_, count)) => Framing::Interrupted((self.recent, count)),
            None => otherwise,
        }
    }

    /// Whether the checksum of the frame that has ended is right.
    fn is_right(&self) -> bool {
        self.sums == (self.recent as u16).to_be_bytes()
    }
}

/// The last bytes, with the number of those that begin a sentence or another `NAV-PVT` within a frame.
fn begun_within(recent: u64) -> Option<(u64, u8)> {
    let [_, dollar, address @ .., end] = recent.to_be_bytes();
    let is_letter = |byte: &u8| byte.is_ascii_uppercase() || byte.is_ascii_digit();
    if dollar == b'$' && matches!(end, b',' | b'*') && address.iter().all(is_letter) {
        return Some((recent, 7));
    }
    let is_header = recent & 0xffff_ffff_ffff == 0xb562_0107_5c00;
    is_header.then_some((recent, 6))
}

/// Reads the payload of a `NAV-PVT` and its checksum.
fn pvt(payload: &[u8]) -> Result<Sentence, Rejected> {
    let number = |offset: usize| {
        let bytes = payload.get(offset..)?.first_chunk()?;
        Some(i32::from_le_bytes(*bytes))
    };
    let [
        hour_to_valid,
        nanoseconds,
        fix,
        longitude,
        latitude,
        speed,
        course,
    ] = [8, 16, 20, 24, 28, 60, 64].map(|offset| number(offset).unwrap_or_default());
    let flags3 = number(76).ok_or(Rejected::Unparsable)?.to_le_bytes();
    let [hour, minute, second, valid] = hour_to_valid.to_le_bytes();
    let [kind, flags, ..] = fix.to_le_bytes();
    let time = TimeOfDay::from_parts([hour, minute, second], nanoseconds)
        .filter(|_| valid & 2 != 0)
        .ok_or(Rejected::NoFix);
    let Ok(time) = time else {
        return Ok(Sentence::Lost(Rejected::NoFix));
    };
    if !(1..=4).contains(&kind) || flags & 1 == 0 || flags3[2] & 1 != 0 {
        return Ok(Sentence::NoFix(Some(time)));
    }
    let Ok(place) = Geodetic::new(latitude, longitude) else {
        return Ok(Sentence::Lost(Rejected::OutOfRange));
    };
    if (latitude, longitude) == (0, 0) {
        return Ok(Sentence::Lost(Rejected::NullPosition));
    }
    let degrees = |value: i32| Some(value as f32 / 1e5).filter(|x| (0.0..=360.0).contains(x));
    // The shorter form ends with the checksum here.
    let is_long = payload.len() >= 92;
    let heading = number(84)
        .and_then(degrees)
        .filter(|_| is_long && flags & 32 != 0);
    let variation = number(88).map(|value| f32::from(value as i16) * 0.01);
    Ok(Sentence::Statement(Statement {
        time: Some(time),
        place: Some(place),
        motion: Some(Motion {
            course: degrees(course),
            speed: speed as f32 / 1e3,
        }),
        heading: heading.map(|degrees| Heading {
            degrees,
            is_magnetic: false,
        }),
        variation: variation.filter(|_| is_long && valid & 8 != 0),
    }))
}

#[cfg(test)]
mod tests;
