//! The fields before the spectrum, and what a KrakenSDR's own heading is worth.

use super::spectrum::power;
use crate::aoa::geodesy::Geodetic;
use crate::gateway::clock::TimeOfDay;
use crate::gateway::outcome::Rejected;
use crate::gateway::sentence::{columns, decimal, fixed, turned};

/// Scale of the confidence of a KrakenSDR: of the maximum of the spectrum over its mean, `m`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub enum Confidence {
    /// `10 log10(m)`, of at most 25.6.
    Decibels,
    /// `(m - 1) / 3`, of at most 1, which says no more than that `m` is at least 4.
    Fraction,
}

/// Which heading of a KrakenSDR's line holds, and when. The one by its GPS is a course or a number that somebody has
/// entered, or that nobody has: it is zero then.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub enum Heading {
    /// The one that the line names. By GPS, it holds while the KrakenSDR moves; of one that has never moved, if it has
    /// never changed and is not zero. Before a second has shown whether it moves, it holds; if it then was none, the next
    /// bearing takes the place of those that rested on it.
    Recognised,
    /// The one that the line names; by GPS only while the KrakenSDR moves.
    Vehicle,
    /// The one that the line names, always: of a fixed station, or by a receiver with two antennas.
    Station,
    /// The compass's, always, whichever the line names.
    Compass,
}

/// The fields of a line.
pub(super) struct Fields<'a> {
    /// Time, bearing, confidence, power, frequency, array, latency, and the beginning of the station.
    head: [&'a [u8]; 8],
    /// Latitude, longitude, GPS heading, compass heading, and which of them, without blanks about them.
    pose: [&'a [u8]; 5],
}

/// Of [`Fields::head`].
const TIME: usize = 0;
const BEARING: usize = 1;
const CONFIDENCE: usize = 2;
const FREQUENCY: usize = 4;
const LATENCY: usize = 6;

impl<'a> Fields<'a> {
    /// The first seven are at the beginning, those of the pose at the end but for the reserved ones: between them is a
    /// name, with whatever is in it.
    #[inline(never)]
    pub fn of(line: &'a [u8]) -> Option<Self> {
        let mut rest = line;
        let mut pose = [&[] as &[u8]; 5];
        for field in pose.iter_mut().rev() {
            *field = last(&mut rest)?;
        }
        let head = columns(rest)?;
        Some(Self { head, pose })
    }

    pub fn time(&self) -> Result<TimeOfDay, Rejected> {
        /// Of 13 characters no number with a sign or a point is as large.
        const LEAST: i64 = 1_000_000_000_000;
        let text = trim(self.head[TIME]);
        let time = fixed(text, 0).filter(|time| text.len() == 13 && *time >= LEAST);
        time.map(TimeOfDay::from_epoch).ok_or(Rejected::Unparsable)
    }

    /// Degrees within 0 and 360, one way round or the other.
    pub fn bearing(&self) -> Result<f32, Rejected> {
        let degrees = decimal(trim(self.head[BEARING])).ok_or(Rejected::Unparsable)?;
        angle(degrees)
    }

    pub fn frequency_hz(&self) -> Result<Option<u32>, Rejected> {
        let hertz = fixed(trim(self.head[FREQUENCY]), 0).ok_or(Rejected::Unparsable)?;
        Ok(u32::try_from(hertz).ok())
    }

    pub fn latency_ms(&self) -> Result<u32, Rejected> {
        let latency = fixed(trim(self.head[LATENCY]), 0).ok_or(Rejected::Unparsable)?;
        u32::try_from(latency).map_err(|_| Rejected::OutOfRange)
    }

    /// By the confidence.
    pub fn quality(&self, scale: Option<Confidence>) -> Result<f32, Rejected> {
        /// Of 360 values of which all but one are zero, and rounded.
        const LARGEST_DECIBELS: f32 = 25.6;
        /// Of a confidence on no known scale: as little as any that is used by default.
        const UNKNOWN: f32 = 50.0;
        let confidence = decimal(trim(self.head[CONFIDENCE])).ok_or(Rejected::Unparsable)?;
        let scale = scale.unwrap_or(if confidence <= 1.0 {
            Confidence::Fraction
        } else {
            Confidence::Decibels
        });
        let mean = match scale {
            _ if confidence < 0.0 => return Err(Rejected::OutOfRange),
            Confidence::Fraction if confidence <= 1.0 => 1.0 / (1.0 + 3.0 * confidence),
            Confidence::Decibels if confidence <= LARGEST_DECIBELS => power(-100.0 * confidence),
            _ => return Ok(UNKNOWN),
        };
        Ok(100.0 - 100.0 * mean)
    }

    /// Where the line says that it was taken, unless nowhere, and at which heading.
    pub fn pose(
        &self,
        time: TimeOfDay,
        rule: Heading,
        own: &mut Own,
    ) -> Result<Option<(Geodetic, Option<f32>)>, Rejected> {
        let [latitude, longitude, gps, compass, main] = self.pose;
        let (Some(latitude), Some(longitude)) = (degrees_e7(latitude)?, degrees_e7(longitude)?)
        else {
            return Ok(None);
        };
        if (latitude, longitude) == (0, 0) {
            return Ok(None);
        }
        let place = Geodetic::new(latitude, longitude).map_err(|_| Rejected::OutOfRange)?;
        let by_compass = rule == Heading::Compass || main == b"Compass";
        let text = if by_compass { compass } else { gps };
        let heading = match decimal(text) {
            Some(degrees) => Some(angle(degrees)?),
            None if is_none(text) => None,
            None => return Err(Rejected::Unparsable),
        };
        let holds = by_compass || rule == Heading::Station;
        let heading = heading.filter(|degrees| holds || own.holds(time, place, *degrees, rule));
        Ok(Some((place, heading)))
    }
}

/// Whether the heading by a KrakenSDR's GPS is worth anything, judged by where it has been.
#[derive(Debug)]
pub(super) struct Own {
    /// When, where and at which heading it was judged last; a second apart at least, for its place may be as old.
    last: Option<(TimeOfDay, Geodetic, f32)>,
    motion: Motion,
    /// It has moved, or its heading has changed.
    is_vehicle: bool,
    /// Readings by a heading that may be none.
    doubtful: u32,
    /// Such readings of which that has just turned out.
    retracted: u32,
}

#[derive(Debug, Clone, Copy, PartialEq)]
enum Motion {
    Unknown,
    Stands,
    Moves,
}

impl Own {
    pub const EMPTY: Self = Self {
        last: None,
        motion: Motion::Unknown,
        is_vehicle: false,
        doubtful: 0,
        retracted: 0,
    };

    /// How many readings so far, and this is told once, rested on a heading that was none.
    pub fn retracted(&mut self) -> u32 {
        core::mem::take(&mut self.retracted)
    }

    #[inline(never)]
    fn holds(&mut self, time: TimeOfDay, place: Geodetic, heading: f32, rule: Heading) -> bool {
        /// In milliseconds.
        const SOON: i32 = 1_000;
        /// A clock that goes back so far was set.
        const SET: i32 = -4_000;
        const LEAST_SPEED_M_S: f32 = 1.5;
        let (last_time, last_place, last_heading) =
            *self.last.get_or_insert((time, place, heading));
        let elapsed = time.since(last_time);
        self.is_vehicle |= heading != last_heading;
        if !(SET..SOON).contains(&elapsed) {
            let stands = last_place.is_within(place, LEAST_SPEED_M_S * (1e-3 * elapsed as f32));
            self.motion = if stands {
                Motion::Stands
            } else {
                Motion::Moves
            };
            self.is_vehicle |= !stands;
            self.last = Some((time, place, heading));
        }
        match self.motion {
            Motion::Unknown => {
                self.doubtful += u32::from(heading == 0.0);
                true
            }
            Motion::Moves => {
                self.doubtful = 0;
                true
            }
            Motion::Stands => {
                let holds = rule == Heading::Recognised && !self.is_vehicle && heading != 0.0;
                self.retracted = core::mem::take(&mut self.doubtful);
                holds
            }
        }
    }
}

/// An angle of up to two turns either way, within 0 and 360 degrees.
#[inline(never)]
fn angle(degrees: f32) -> Result<f32, Rejected> {
    if degrees.abs() <= 720.0 {
        Ok(turned(degrees))
    } else {
        Err(Rejected::OutOfRange)
    }
}

/// A coordinate; `None` where there is none.
#[inline(never)]
fn degrees_e7(text: &[u8]) -> Result<Option<i32>, Rejected> {
    const PLACES: u32 = 7;
    if is_none(text) {
        return Ok(None);
    }
    // Python writes what is below a ten-thousandth with an exponent.
    let value = match text {
        [digits @ .., b'e', b'-', b'0', exponent @ b'0'..=b'9'] => {
            match PLACES.checked_sub(u32::from(exponent - b'0')) {
                Some(places) => fixed(digits, places),
                None => fixed(digits, 0).map(|_| 0),
            }
        }
        _ => fixed(text, PLACES),
    };
    let value = value.ok_or(Rejected::Unparsable)?;
    i32::try_from(value)
        .map(Some)
        .map_err(|_| Rejected::OutOfRange)
}

/// Whether a number is missing.
fn is_none(text: &[u8]) -> bool {
    text == b"None" || text == b"nan"
}

/// Takes off the last field that is not reserved, and the comma before it.
#[inline(never)]
fn last<'a>(rest: &mut &'a [u8]) -> Option<&'a [u8]> {
    loop {
        let mut parts = rest.rsplitn(2, |byte| *byte == b',');
        let field = trim(parts.next()?);
        *rest = parts.next()?;
        if field != b"R" {
            return Some(field);
        }
    }
}

/// Takes the blanks off both ends of a field. Once in flash is enough, and not unrolled.
#[inline(never)]
fn trim(mut field: &[u8]) -> &[u8] {
    while let [b' ', rest @ ..] | [rest @ .., b' '] = field {
        field = rest;
    }
    field
}
