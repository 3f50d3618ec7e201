//! Sentences of navigation receivers and compasses: NMEA 0183, and two of their makers' own.
//!
//! | sentence | field | unit, sense | taken as |
//! |---|---|---|---|
//! | `$--RMC` | 1 time | `hhmmss`, decimals | UTC |
//! | | 2 status, 12 mode | `A`; not `N`; `M`, `S` if [configured](super::Config::simulated) | whether there is a position |
//! | | 3 to 6 place | `ddmm.m`, `N` or `S`, `dddmm.m`, `E` or `W` | latitude, longitude, to 1e-7 degree |
//! | | 7 speed | knots | speed over ground |
//! | | 8 course | degrees clockwise from true north | course over ground |
//! | | 10, 11 variation | degrees, `E` (clockwise) or `W` | what magnetic headings lack |
//! | `$--GGA` | 1 time, 2 to 5 place | as RMC | the same |
//! | | 6 quality | 1 to 6 and 9; 7 manual, 8 simulated if configured | whether there is a position |
//! | `$--VTG` | 1 course, 5 speed, 9 mode | as RMC | course and speed over ground, at the time of the sentences before |
//! | `$--HDT` | 1 heading | degrees clockwise from true north | true heading |
//! | `$--THS` | 1 heading, 2 mode | the same; `A`, `E`; `M`, `S` if configured; not `V` | true heading |
//! | `$--HDG` | 1 heading | degrees clockwise from north as the sensor has it | magnetic heading, with the next |
//! | | 2, 3 error of the compass; 4, 5 variation | degrees, `E` or `W` | added; without a variation, that of RMC holds |
//! | `$--HDM` | 1 heading | degrees clockwise from magnetic north | magnetic heading |
//! | `$PASHR` | 1 time, 2 heading, 3 `T` | as RMC; degrees clockwise from true north | true heading at its own time |
//! | `$PTNTHTM` | 1 heading, 2 status | degrees clockwise from true north (the compass is told its error and the variation); `M`, `N`, `O` | true heading |
//! | `$PFOXQ`, `$PFOXR` | | | the host's own: see [`gateway`](crate::gateway) |
//!
//! All others, and AIS, which begins with `!`, are left to others. Sources: NMEA 0183 as "NMEA Revealed" of gpsd describes
//! it, and for `$PTNTHTM` gpsd's `driver_nmea0183.c`; for `$PASHR` the manual of the OxTS RT3000.
//!
//! The fields stay bytes until they are exact integers: an f32 would lose half a metre of a longitude. A time has exactly
//! six digits before its point, a latitude four and a longitude five: an eight-bit checksum alone lets one in 256 damaged
//! sentences pass, and where a byte is lost every digit has another place.
//!
//! Read here and not by a crate, because every `no_std` parser of NMEA leaves panics in the firmware that links
//! it (float parsing, slices of strings). The tests hold this one to what the `nmea` crate reads.

use super::format::{Format, Heading, Layout, Motion, Sentence, Statement};
use crate::gateway::clock::TimeOfDay;
use crate::gateway::outcome::Rejected;
use crate::gateway::sentence::{self, decimal};

const METRES_PER_SECOND_PER_KNOT: f32 = 1852.0 / 3600.0;

/// The sentences of NMEA 0183, and those of the gateway's own host.
#[derive(Debug)]
pub struct Nmea;

/// Refuses what was not measured, by the mode that a sentence states.
fn measured(mode: Option<&[u8]>, simulated: bool) -> Result<(), Rejected> {
    match mode {
        Some(b"M" | b"S") if !simulated => Err(Rejected::Simulated),
        _ => Ok(()),
    }
}

impl Format for Nmea {
    /// Whether what was not measured is used.
    type Config = bool;
    const DEFAULT: bool = false;
    /// The standard says 82 bytes, receivers send up to 102.
    const LAYOUT: Layout = Layout {
        longest: 120,
        begins: |byte| matches!(byte, b'$' | b'!'),
        continues: |byte| byte.is_ascii_uppercase(),
        interrupts: true,
        holds: |_, byte| matches!(byte, b'%' | b'!'),
        ..Layout::TEXT
    };
    const EMPTY: Self = Self;

    fn parse(&mut self, line: &[u8], simulated: &bool) -> Result<Sentence, Rejected> {
        parse(line, *simulated)
    }
}

/// Checks the sentence `$payload*hh` and reads it.
#[inline(never)]
fn parse(line: &[u8], simulated: bool) -> Result<Sentence, Rejected> {
    let Some(payload) = sentence::checked(line, b"$!") else {
        return refused(line.get(1..7), Rejected::Checksum);
    };
    match payload {
        b"PFOXQ" => return Ok(Sentence::Query),
        b"PFOXR" => return Ok(Sentence::Restart),
        _ => {}
    }
    // Two letters of the talker, three of the sentence, a comma, the fields.
    let Some((address, fields)) = payload.split_at_checked(6) else {
        return Ok(Sentence::Other);
    };
    let stated = match address {
        b"PASHR," => pashr(fields),
        b"PTNTHT" => ptnthtm(fields),
        _ if line.starts_with(b"!") => Ok(Sentence::Other),
        [b'P', ..] => Ok(Sentence::Other),
        [_, _, b'R', b'M', b'C', b','] => rmc(fields, simulated),
        [_, _, b'G', b'G', b'A', b','] => gga(fields, simulated),
        [_, _, b'V', b'T', b'G', b','] => vtg(fields, simulated),
        [_, _, b'H', b'D', b'T', b','] => hdt(fields),
        [_, _, b'T', b'H', b'S', b','] => ths(fields, simulated),
        [_, _, b'H', b'D', b'G', b','] => hdg(fields),
        [_, _, b'H', b'D', b'M', b','] => hdm(fields),
        _ => Ok(Sentence::Other),
    };
    stated.or_else(|reason| refused(Some(address), reason))
}

/// A sentence that is refused for a reason: one that states times leaves those after it without one.
fn refused(address: Option<&[u8]>, reason: Rejected) -> Result<Sentence, Rejected> {
    match address {
        Some([_, _, b'R', b'M', b'C', b','] | [_, _, b'G', b'G', b'A', b',']) => {
            Ok(Sentence::Lost(reason))
        }
        _ => Err(reason),
    }
}

#[inline(never)]
fn rmc(fields: &[u8], simulated: bool) -> Result<Sentence, Rejected> {
    let columns: [&[u8]; 8] = sentence::columns(fields).ok_or(Rejected::Unparsable)?;
    let [clock, status, place @ .., speed, course] = columns;
    let time = time(clock)?;
    let variation = [9, 10].map(|place| field(fields, place).unwrap_or_default());
    let mode = field(fields, 11);
    if time.is_none() || status != b"A" || mode == Some(b"N") {
        return no_fix(time);
    }
    measured(mode, simulated)?;
    Ok(Sentence::Statement(Statement {
        time,
        place: Some(sentence::place(place)?),
        motion: motion(course, speed)?,
        // Some state one that is none, such as 999.9.
        variation: eastward(variation).unwrap_or_default(),
        heading: None,
    }))
}

#[inline(never)]
fn gga(fields: &[u8], simulated: bool) -> Result<Sentence, Rejected> {
    let columns: [&[u8]; 6] = sentence::columns(fields).ok_or(Rejected::Unparsable)?;
    let [clock, place @ .., quality] = columns;
    let time = time(clock)?;
    match quality {
        _ if time.is_none() => return no_fix(time),
        b"0" | b"" => return no_fix(time),
        b"7" | b"8" if !simulated => return Err(Rejected::Simulated),
        [b'1'..=b'9'] => {}
        _ => return Err(Rejected::Unparsable),
    }
    Ok(Sentence::Statement(Statement {
        time,
        place: Some(sentence::place(place)?),
        ..Statement::NOTHING
    }))
}

/// A field that older receivers leave out, by its place.
// Not unrolled at every call.
#[inline(never)]
fn field(fields: &[u8], place: usize) -> Option<&[u8]> {
    fields.split(|byte| *byte == b',').nth(place)
}

/// A sentence that should have stated a position.
fn no_fix(time: Option<TimeOfDay>) -> Result<Sentence, Rejected> {
    if time.is_some() {
        Ok(Sentence::NoFix(time))
    } else {
        Err(Rejected::NoFix)
    }
}

#[inline(never)]
fn vtg(fields: &[u8], simulated: bool) -> Result<Sentence, Rejected> {
    let [course, _, _, _, speed] = sentence::columns(fields).ok_or(Rejected::Unparsable)?;
    let mode = field(fields, 8);
    let motion = motion(course, speed)?;
    if motion.is_none() || mode == Some(b"N") {
        return Ok(Sentence::NoFix(None));
    }
    measured(mode, simulated)?;
    Ok(Sentence::Statement(Statement {
        motion,
        ..Statement::NOTHING
    }))
}

/// `heading,T`
fn hdt(fields: &[u8]) -> Result<Sentence, Rejected> {
    match sentence::columns(fields) {
        Some([degrees, b"T"]) => heading(degrees, None, false),
        _ => Err(Rejected::Unparsable),
    }
}

/// `heading,mode`
fn ths(fields: &[u8], simulated: bool) -> Result<Sentence, Rejected> {
    match sentence::columns(fields) {
        Some([_, b"V"]) => Ok(Sentence::NoFix(None)),
        Some([degrees, mode @ [b'A' | b'E' | b'M' | b'S']]) => {
            measured(Some(mode), simulated)?;
            heading(degrees, None, false)
        }
        _ => Err(Rejected::Unparsable),
    }
}

/// `heading,M`
fn hdm(fields: &[u8]) -> Result<Sentence, Rejected> {
    match sentence::columns(fields) {
        Some([degrees, b"M"]) => heading(degrees, None, true),
        _ => Err(Rejected::Unparsable),
    }
}

/// `heading,error of the compass,side,variation,side`
fn hdg(fields: &[u8]) -> Result<Sentence, Rejected> {
    let [degrees, error, side, variation, variation_side] =
        sentence::columns(fields).ok_or(Rejected::Unparsable)?;
    let error = eastward([error, side])?;
    let variation = eastward([variation, variation_side])?;
    let mut stated = heading(degrees, None, true)?;
    if let Sentence::Statement(Statement {
        heading: Some(heading),
        variation: stated,
        ..
    }) = &mut stated
    {
        heading.degrees += error.unwrap_or(0.0);
        *stated = variation;
    }
    Ok(stated)
}

/// `time,heading,T,...`; other sentences of this name begin with letters.
fn pashr(fields: &[u8]) -> Result<Sentence, Rejected> {
    match sentence::columns(fields) {
        Some([clock, degrees, b"T"]) => match time(clock)? {
            None => Ok(Sentence::NoFix(None)),
            time => heading(degrees, time, false),
        },
        _ => Ok(Sentence::Other),
    }
}

/// The last letter of its name, and `heading,status,...`, of which alarms are no heading.
fn ptnthtm(fields: &[u8]) -> Result<Sentence, Rejected> {
    match sentence::columns(fields) {
        Some([b"M", degrees, [b'M'..=b'O']]) => heading(degrees, None, false),
        Some([b"M", ..]) => Ok(Sentence::NoFix(None)),
        _ => Ok(Sentence::Other),
    }
}

/// Nothing where no degrees are stated.
#[inline(never)]
fn heading(
    degrees: &[u8],
    time: Option<TimeOfDay>,
    is_magnetic: bool,
) -> Result<Sentence, Rejected> {
    if degrees.is_empty() {
        return Ok(Sentence::NoFix(None));
    }
    Ok(Sentence::Statement(Statement {
        time,
        heading: Some(Heading {
            degrees: angle(degrees)?,
            is_magnetic,
        }),
        ..Statement::NOTHING
    }))
}

/// Degrees to the east, from degrees and `E` or `W`; neither is stated by a receiver that does not know.
#[inline(never)]
fn eastward([degrees, side]: [&[u8]; 2]) -> Result<Option<f32>, Rejected> {
    if degrees.is_empty() {
        return Ok(None);
    }
    let degrees = angle(degrees)?;
    match side {
        _ if degrees > 180.0 => Err(Rejected::OutOfRange),
        b"E" => Ok(Some(degrees)),
        b"W" => Ok(Some(-degrees)),
        _ => Err(Rejected::Unparsable),
    }
}

#[inline(never)]
fn time(text: &[u8]) -> Result<Option<TimeOfDay>, Rejected> {
    if text.is_empty() {
        return Ok(None);
    }
    TimeOfDay::from_nmea(text)
        .map(Some)
        .ok_or(Rejected::Unparsable)
}

#[inline(never)]
fn motion(course: &[u8], speed: &[u8]) -> Result<Option<Motion>, Rejected> {
    if speed.is_empty() {
        return Ok(None);
    }
    let knots = decimal(speed).ok_or(Rejected::Unparsable)?;
    let course = if course.is_empty() {
        None
    } else {
        Some(angle(course)?)
    };
    Ok(Some(Motion {
        course,
        speed: knots * METRES_PER_SECOND_PER_KNOT,
    }))
}

fn angle(degrees: &[u8]) -> Result<f32, Rejected> {
    let degrees = decimal(degrees).ok_or(Rejected::Unparsable)?;
    if (0.0..=360.0).contains(&degrees) {
        Ok(degrees)
    } else {
        Err(Rejected::OutOfRange)
    }
}

#[cfg(test)]
mod tests;
