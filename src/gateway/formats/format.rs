//! What a format is, and what a set of formats is.

use crate::ConfigError;
use crate::aoa::geodesy::Geodetic;
use crate::config::require_within;
use crate::gateway::clock::TimeOfDay;
use crate::gateway::outcome::Rejected;
use crate::gateway::sigma::SigmaTable;

/// What a line says.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Sentence {
    /// What a receiver or a compass says.
    Statement(Statement),
    /// The receiver has no position at this time, or its sentence states nothing.
    NoFix(Option<TimeOfDay>),
    /// A sentence that should have stated a time is of no use for this reason: what follows and states none has none.
    Lost(Rejected),
    /// A bearing.
    Reading(Reading),
    /// The host asks for a report.
    Query,
    /// The host looks for another source.
    Restart,
    /// A sentence for others.
    Other,
}

/// What a receiver or a compass states of the vehicle.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Statement {
    pub time: Option<TimeOfDay>,
    pub place: Option<Geodetic>,
    pub motion: Option<Motion>,
    pub heading: Option<Heading>,
    /// Of magnetic north from true north: degrees clockwise.
    pub variation: Option<f32>,
}

impl Statement {
    pub const NOTHING: Self = Self {
        time: None,
        place: None,
        motion: None,
        heading: None,
        variation: None,
    };
}

/// Where the bow points.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Heading {
    /// Clockwise.
    pub degrees: f32,
    /// They count from magnetic north, not from true north.
    pub is_magnetic: bool,
}

/// How a vehicle moves over ground.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Motion {
    /// Degrees clockwise from true north; not known to a receiver that stands.
    pub course: Option<f32>,
    /// Metres per second.
    pub speed: f32,
}

/// A bearing as its line gives it, or several that exclude each other.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Reading {
    /// When, if the line says so.
    pub time: Option<TimeOfDay>,
    /// How long before that time it was taken.
    pub latency_ms: u32,
    /// 0 to 100.
    pub quality: f32,
    /// The most probable bearing.
    pub best: Ray,
    /// The other ones.
    pub others: [Option<Ray>; 2],
    /// Where, if the line says so.
    pub place: Option<Geodetic>,
    /// What the bearings count from.
    pub reference: Reference,
    /// By which antenna array, if there are several on one port.
    pub station: Option<u8>,
    /// Which of the sources that the format was told of it is of, from 1 on; 0 if it was told of none.
    pub channel: u8,
    /// So many readings of this line so far stated a heading that was none.
    pub retracted: u32,
}

/// One of the bearings of a reading.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ray {
    /// Clockwise from the bow or from north, within 0 and 360.
    pub degrees: f32,
    /// Standard deviation, where the format knows it.
    pub sigma_rad: Option<f32>,
    /// Of being the right one, if one of the reading's is.
    pub probability: f32,
}

/// What the bearings of a line count from. Headings are in degrees clockwise from true north, within 0 and 360.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Reference {
    /// The line leaves it open: [`gateway::Config::reference`](crate::gateway::Config::reference) tells it. If that is the
    /// bow, this is the line's own heading, if it has one.
    Told(Option<f32>),
    /// The bow or the front of the array, with its heading, if it is known with the line.
    Bow(Option<f32>),
    /// True north: no heading is added.
    North,
}

impl Reading {
    /// One bearing without time or place, which leaves open what it counts from.
    ///
    /// # Errors
    /// When the angle is not from 0 to 360 degrees or the quality not from 0 to 100.
    pub fn new(
        degrees: f32,
        quality: f32,
        sigmas: Option<&'static SigmaTable>,
    ) -> Result<Self, Rejected> {
        if (0.0..=360.0).contains(&degrees) && (0.0..=100.0).contains(&quality) {
            Ok(Self {
                time: None,
                latency_ms: 0,
                quality,
                best: Ray {
                    degrees,
                    sigma_rad: sigmas.map(|table| table.sigma_rad(quality)),
                    probability: 1.0,
                },
                others: [None; 2],
                place: None,
                reference: Reference::Told(None),
                station: None,
                channel: 0,
                retracted: 0,
            })
        } else {
            Err(Rejected::OutOfRange)
        }
    }
}

/// The number of one of some identifiers, from 1 on; 0 if there are none. `None` if it is not among them.
pub fn channel_of<T: PartialEq>(own: T, all: &[T]) -> Option<u8> {
    if all.is_empty() {
        return Some(0);
    }
    let place = all.iter().position(|one| *one == own)?;
    u8::try_from(place + 1).ok()
}

/// Direction in which the angles of a direction finder grow: builds of the KrakenSDR differ, and so do mountings of a
/// u-blox board.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub enum Sense {
    /// Clockwise, as on a compass.
    Clockwise,
    /// Counter-clockwise, as in mathematics.
    CounterClockwise,
}

/// A direction finder that does not move.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct Station {
    /// Where it stands.
    pub place: Geodetic,
    /// Where relative bearings of 0 point, in degrees clockwise from true north.
    pub heading_deg: f32,
}

impl Station {
    /// Checks all fields.
    ///
    /// # Errors
    /// Names the field that is out of range.
    pub const fn check(&self) -> Result<(), ConfigError> {
        require_within!(self: heading_deg 0.0..=360.0);
        Ok(())
    }
}

/// What a format is told whose lines leave nothing open but what their quality means.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct ByQuality {
    /// Standard deviations by the quality, in place of those of [`gateway::Config`](crate::gateway::Config).
    pub sigmas: Option<&'static SigmaTable>,
}

impl ByQuality {
    /// Checks all fields.
    ///
    /// # Errors
    /// None: every value is right.
    pub const fn check(&self) -> Result<(), ConfigError> {
        Ok(())
    }
}

/// How the lines of a format are found among bytes.
#[derive(Debug, Clone, Copy)]
pub struct Layout {
    /// Most bytes of a line, of which no more than a line reader's buffer are kept.
    pub longest: u16,
    /// Fields, ended by commas, that are kept; what follows goes to [`Format::rest`].
    pub fields: u8,
    /// Whether lines are binary frames, which no line end ends.
    pub is_framed: bool,
    /// Whether a line begins with this byte.
    pub begins: fn(u8) -> bool,
    /// Whether this may be the second byte of a line: if not, the line is of the next format that begins as it does.
    pub continues: fn(u8) -> bool,
    /// Whether the first byte of a line begins one also in the middle of another line, whose end was lost.
    pub interrupts: bool,
    /// Whether that other line, of which these bytes are kept so far, may hold this byte: then it begins none.
    pub holds: fn(&[u8], u8) -> bool,
}

impl Layout {
    /// A line of text that nothing begins yet, of which all fields are kept.
    pub const TEXT: Self = Self {
        longest: 0,
        fields: u8::MAX,
        is_framed: false,
        begins: |_| false,
        continues: |_| true,
        interrupts: false,
        holds: |_, _| false,
    };
}

/// What a byte means to a binary frame.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Framing {
    /// The frame goes on.
    More,
    /// It has ended.
    End,
    /// It is none.
    None,
    /// Another line has begun in it: with so many of these bytes, of which the lowest is the last.
    Interrupted((u64, u8)),
}

/// A form of lines. A value of the type is what is known of the line at hand beyond the bytes that are kept.
pub trait Format {
    /// What it is told.
    type Config: 'static;
    /// What it is told by default.
    const DEFAULT: Self::Config;
    /// How lines are found.
    const LAYOUT: Layout;
    /// Nothing is known; all bits are zero.
    const EMPTY: Self;

    /// A line begins.
    fn begin(&mut self) {}

    /// Takes a byte after the fields that are kept.
    fn rest(&mut self, _byte: u8) {}

    /// Takes a byte of a binary frame after the first.
    fn frame(&mut self, _byte: u8) -> Framing {
        Framing::None
    }

    /// Reads the kept bytes of a line that has ended.
    ///
    /// # Errors
    /// Why the line is of no use.
    fn parse(&mut self, line: &[u8], config: &Self::Config) -> Result<Sentence, Rejected>;
}

/// A format that has a part in the configuration `C` of all formats.
pub trait Told<C>: Format {
    /// That part; `None` if its lines are not heard.
    fn told(all: &C) -> Option<&Self::Config>;
}

/// What a line reader asks of a set, whose formats count from 1; 0 is none of them.
pub trait Set<C> {
    /// Nothing is known; all bits are zero.
    const EMPTY: Self;
    /// Whether any reads what follows the fields that are kept.
    const RESTS: bool;
    /// Whether any has binary frames.
    const FRAMED: bool;

    /// The format of a line that begins with this byte, among those after another.
    fn which(byte: u8, after: u8) -> u8;

    /// How its lines are found.
    fn layout(which: u8) -> Option<&'static Layout>;

    /// See [`Format::begin`].
    fn begin(&mut self, which: u8);

    /// See [`Format::rest`].
    fn rest(&mut self, which: u8, byte: u8);

    /// See [`Format::frame`].
    fn frame(&mut self, which: u8, byte: u8) -> Framing;

    /// See [`Format::parse`].
    ///
    /// # Errors
    /// Why the line is of no use.
    fn parse(&mut self, which: u8, line: &[u8], config: &C) -> Result<Sentence, Rejected>;
}

macro_rules! set {
    ($(($format:ident $place:tt $number:literal))+) => {
        impl<C, $($format: Told<C>),+> Set<C> for ($($format,)+) {
            const EMPTY: Self = ($($format::EMPTY,)+);
            const RESTS: bool = false $(|| $format::LAYOUT.fields < u8::MAX)+;
            const FRAMED: bool = false $(|| $format::LAYOUT.is_framed)+;

            fn which(byte: u8, after: u8) -> u8 {
                $(if $number > after && ($format::LAYOUT.begins)(byte) {
                    return $number;
                })+
                0
            }

            fn layout(which: u8) -> Option<&'static Layout> {
                match which {
                    $($number => Some(&$format::LAYOUT),)+
                    _ => None,
                }
            }

            fn begin(&mut self, which: u8) {
                match which {
                    $($number => self.$place.begin(),)+
                    _ => {}
                }
            }

            fn rest(&mut self, which: u8, byte: u8) {
                match which {
                    $($number => self.$place.rest(byte),)+
                    _ => {}
                }
            }

            fn frame(&mut self, which: u8, byte: u8) -> Framing {
                match which {
                    $($number => self.$place.frame(byte),)+
                    _ => Framing::None,
                }
            }

            fn parse(&mut self, which: u8, line: &[u8], config: &C) -> Result<Sentence, Rejected> {
                match which {
                    $($number => {
                        let told = $format::told(config).ok_or(Rejected::OtherFinder)?;
                        self.$place.parse(line, told)
                    })+
                    _ => Err(Rejected::Unparsable),
                }
            }
        }
    };
}

/// Makes the first of these formats a set, the first two, and so on.
macro_rules! sets {
    ([$($before:tt)*]) => {};
    ([$($before:tt)*] $next:tt $($format:tt)*) => {
        set!($($before)* $next);
        sets!([$($before)* $next] $($format)*);
    };
}

sets! {
    []
    (A 0 1) (B 1 2) (D 2 3) (E 3 4) (F 4 5) (G 5 6)
    (H 6 7) (I 7 8) (J 8 9) (K 9 10) (L 10 11) (M 11 12)
}
