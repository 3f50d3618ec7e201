//! Events of u-blox direction finders: boards with an array of antennas that hear Bluetooth tags.
//!
//! `+UUDF:6C1DEBA4241B,-65,26,-65,6,37,"CCF9579B21AE","",1129320`
//!
//! | field | unit, sense | taken as |
//! |---|---|---|
//! | tag: its Eddystone instance | 12 hexadecimal digits | see [`Config::tags`] |
//! | RSSI | dBm | not used |
//! | azimuth, -90 to 90 | degrees from straight ahead; see [`Config::sense`] | bearing from where the board faces |
//! | elevation, -90 to 90 | degrees | not used |
//! | RSSI of the other polarisation, or reserved | dBm | not used |
//! | channel, 0 to 39 | | not used |
//! | anchor: the board | 12 hexadecimal digits, quoted; may be empty | see [`Config::anchors`] |
//! | text of the user | quoted | not used |
//! | time since the board was switched on | milliseconds | not used: its clock is not the receiver's |
//! | counter, in later versions | | not used |
//!
//! Sources: u-connectLocate of u-blox, as the project TosiPaikka of the university of Seinajoki describes it, and programs
//! that read its events, from which the lines of the tests are.

use super::format::{Format, Layout, Reading, Reference, Sense, Sentence, Station, channel_of};
use crate::ConfigError;
use crate::config::{require, require_all};
use crate::gateway::outcome::Rejected;
use crate::gateway::sentence::{columns, fixed, turned};
use crate::gateway::sigma::{SigmaTable, preset};
use crate::math::larger;

pub(super) const EXAMPLE: &str = "+UUDF:6C1DEBA4241B,-65,26,-65,6,37,\"CCF9579B21AE\",\"\",1129320";

/// The event `+UUDF:` of u-connectLocate.
///
/// The board's time is not that of the receiver, so none is taken; it states no quality: see [`Config::quality_by_azimuth`].
#[derive(Debug)]
pub struct Ublox;

/// What the format is told.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct Config {
    /// Direction in which azimuths grow.
    pub sense: Sense,
    /// The tags that are looked for: a board reports all that it hears, and lines of others are rejected as
    /// [`Rejected::OtherTag`]. Each is a [channel](crate::aoa::Observation::channel) of its own, from 1 on. Without any, every
    /// tag is taken for the source.
    pub tags: &'static [u64],
    /// The boards by their identifiers, 12 hexadecimal digits in the field `"anchor"`, where there are several on one port
    /// or they do not move: each is a [station](crate::aoa::Observation::station) of its own, numbered from
    /// [`Self::FIRST_STATION`] on, and lines of others are rejected as [`Rejected::OtherAnchor`]. Without any, all lines
    /// are of one board on the vehicle.
    pub anchors: &'static [(u64, Station)],
    /// Whether the quality is 100 straight ahead of the board and 0 at a right angle: a flat array is the worse the
    /// further from there. Else it is 100, always: a board states none.
    pub quality_by_azimuth: bool,
    /// Standard deviations by that quality, such as [`SIGMAS`], in place of those of
    /// [`gateway::Config`](crate::gateway::Config).
    pub sigmas: Option<&'static SigmaTable>,
}

impl Config {
    /// The station of the first anchor; those below are of ports.
    pub const FIRST_STATION: u8 = 64;
    /// The most anchors.
    pub const MOST_ANCHORS: usize = 64;

    /// Every tag, clockwise, of one board, of the best quality.
    pub const DEFAULT: Self = Self {
        sense: Sense::Clockwise,
        tags: &[],
        anchors: &[],
        quality_by_azimuth: false,
        sigmas: None,
    };

    /// Checks all fields.
    ///
    /// # Errors
    /// Names the field that is out of range.
    pub const fn check(&self) -> Result<(), ConfigError> {
        require!(self.tags.len() < 256, "tags must be at most 255");
        require!(
            self.anchors.len() <= Self::MOST_ANCHORS,
            "anchors must be at most 64"
        );
        let mut rest = self.anchors;
        while let [(_, station), others @ ..] = rest {
            require_all!(station);
            rest = others;
        }
        Ok(())
    }
}

/// By the [azimuth](Config::quality_by_azimuth): 5 degrees straight ahead, an estimate, divided by the cosine of the
/// azimuth, as a flat array has it.
pub const SIGMAS: SigmaTable = preset(&[
    (100.0 / 9.0, 28.8),
    (200.0 / 9.0, 14.6),
    (300.0 / 9.0, 10.0),
    (400.0 / 9.0, 7.8),
    (600.0 / 9.0, 5.8),
    (100.0, 5.0),
]);

impl Format for Ublox {
    type Config = Config;
    const DEFAULT: Config = Config::DEFAULT;
    /// With two texts of 30 characters.
    const LAYOUT: Layout = Layout {
        longest: 160,
        begins: |byte| byte == b'+',
        holds: |_, byte| byte == b'%',
        ..Layout::TEXT
    };
    const EMPTY: Self = Self;

    #[inline(never)]
    fn parse(&mut self, line: &[u8], config: &Config) -> Result<Sentence, Rejected> {
        let fields = line.strip_prefix(b"+UUDF:").ok_or(Rejected::Unparsable)?;
        let columns: [&[u8]; 9] = columns(fields).ok_or(Rejected::Unparsable)?;
        let [tag, _rssi, azimuth, _, _, _, anchor, _, time] = columns;
        let known: usize = columns.iter().map(|column| column.len() + 1).sum();
        // What is left after the time and its comma.
        let counter = fields.get(known..);
        let are_digits = |text: &[u8]| !text.is_empty() && text.iter().all(u8::is_ascii_digit);
        if !are_digits(time) || !counter.is_none_or(are_digits) {
            return Err(Rejected::Unparsable);
        }
        let tag = identifier(tag).ok_or(Rejected::Unparsable)?;
        let channel = channel_of(tag, config.tags).ok_or(Rejected::OtherTag)?;
        let azimuth = fixed(azimuth, 0).ok_or(Rejected::Unparsable)?;
        if !(-90..=90).contains(&azimuth) {
            return Err(Rejected::OutOfRange);
        }
        let degrees = match config.sense {
            Sense::Clockwise => azimuth as f32,
            Sense::CounterClockwise => -azimuth as f32,
        };
        let quality = if config.quality_by_azimuth {
            100.0 - degrees.abs() * (100.0 / 90.0)
        } else {
            100.0
        };
        let quality = larger(quality, 0.0);
        let mut reading = Reading::new(turned(degrees), quality, config.sigmas)?;
        reading.channel = channel;
        if !config.anchors.is_empty() {
            let (station, anchor) = anchor_of(anchor, config.anchors)?;
            reading.station = Some(station);
            reading.place = Some(anchor.place);
            reading.reference = Reference::Bow(Some(anchor.heading_deg));
        }
        Ok(Sentence::Reading(reading))
    }
}

/// The anchor of a quoted identifier, and its station.
fn anchor_of(
    text: &[u8],
    anchors: &'static [(u64, Station)],
) -> Result<(u8, &'static Station), Rejected> {
    let [b'"', id @ .., b'"'] = text else {
        return Err(Rejected::Unparsable);
    };
    let id = identifier(id);
    let mut stations = (Config::FIRST_STATION..).zip(anchors);
    let anchor = stations.find(|(_, (known, _))| Some(*known) == id);
    let (number, (_, station)) = anchor.ok_or(Rejected::OtherAnchor)?;
    Ok((number, station))
}

/// Twelve hexadecimal digits.
#[inline(never)]
fn identifier(text: &[u8]) -> Option<u64> {
    let digit = |digit: &u8| char::from(*digit).to_digit(16);
    let value = text
        .iter()
        .try_fold(0, |sum, next| Some(sum << 4 | u64::from(digit(next)?)));
    value.filter(|_| text.len() == 12)
}

#[cfg(test)]
mod tests {
    extern crate std;
    use super::*;
    use crate::aoa::geodesy::Geodetic;
    use crate::gateway::formats::tests::read;

    /// In the form of the manual, and of boards in use.
    const NINE: &str = EXAMPLE;
    const LEFT: &str = "+UUDF:6C1DEBA41845,-56,-11,20,0,39,\"6C1DEBA79D14\",\"\",746675";
    const TEN: &str = "+UUDF:F4CE5FC91A6A,-50,-12,20,0,20,\"CD84C98B935D\",\"a,b\",238777,40871";

    fn degrees(line: &str) -> Result<f32, Rejected> {
        read::<Ublox>(line, &Config::DEFAULT).map(|line| line.best.degrees)
    }

    #[test]
    fn reads_nine_fields_and_ten() {
        assert_eq!(degrees(NINE), Ok(26.0));
        assert_eq!(degrees(LEFT), Ok(349.0));
        assert_eq!(degrees(TEN), Ok(348.0));
        let other_way = Config {
            sense: Sense::CounterClockwise,
            ..Config::DEFAULT
        };
        let line = read::<Ublox>(TEN, &other_way).unwrap();
        assert_eq!(
            (line.best.degrees, line.quality, line.time),
            (12.0, 100.0, None)
        );
    }

    #[test]
    fn quality_falls_with_the_azimuth() {
        let config = Config {
            quality_by_azimuth: true,
            ..Config::DEFAULT
        };
        for (azimuth, quality) in [("0", 100.0), ("45", 50.0), ("-45", 50.0), ("-90", 0.0)] {
            let line = std::format!("+UUDF:6C1DEBA4241B,-65,{azimuth},-65,6,37,\"\",\"\",1");
            let line = read::<Ublox>(&line, &config).unwrap();
            assert!((line.quality - quality).abs() < 1e-4, "{azimuth}");
        }
    }

    #[test]
    fn only_the_wanted_tag_is_read() {
        let config = Config {
            tags: &[1, 0x6c1d_eba4_241b],
            ..Config::DEFAULT
        };
        assert_eq!(read::<Ublox>(NINE, &config).unwrap().channel, 2);
        assert_eq!(read::<Ublox>(TEN, &config), Err(Rejected::OtherTag));
    }

    #[test]
    fn anchors_are_stations() {
        const fn anchor(id: u64, heading_deg: f32) -> (u64, Station) {
            let Ok(place) = Geodetic::new(481_000_000, 115_000_000) else {
                panic!("it is on earth");
            };
            (id, Station { place, heading_deg })
        }
        const ANCHORS: [(u64, Station); 2] = [
            anchor(0xccf9_579b_21ae, 90.0),
            anchor(0xcd84_c98b_935d, 180.0),
        ];
        let config = Config {
            anchors: &ANCHORS,
            ..Config::DEFAULT
        };
        for (line, station, boresight_deg) in [(NINE, 64, 90.0), (TEN, 65, 180.0)] {
            let line = read::<Ublox>(line, &config).unwrap();
            assert_eq!(line.station, Some(station));
            assert_eq!(line.reference, Reference::Bow(Some(boresight_deg)));
        }
        let other = NINE.replace("CCF9579B21AE", "CCF9579B21AF");
        assert_eq!(read::<Ublox>(&other, &config), Err(Rejected::OtherAnchor));
        let none = NINE.replace("CCF9579B21AE", "");
        assert_eq!(read::<Ublox>(&none, &config), Err(Rejected::OtherAnchor));
        let alone = read::<Ublox>(NINE, &Config::DEFAULT).unwrap();
        assert_eq!(
            (alone.place, alone.reference),
            (None, Reference::Told(None))
        );
    }

    #[test]
    fn refuses_malformed_lines() {
        for line in [
            "+UUDF:",
            "+UUDFP:6C1DEBA4241B,-65,26,-65,6,37,\"\",\"\",1",
            "+UUDF:6C1DEBA4241B,-65,26,-65,6,37,\"\",\"\"",
            "+UUDF:6C1DEBA4241B,-65,26,-65,6,37,\"\",\"\",1,2,3",
            "+UUDF:6C1DEBA4241B,-65,26,-65,6,37,\"\",\"\",1,",
            "+UUDF:6C1DEBA4241B,-65,26,-65,6,37,\"\",\",1,2",
            "+UUDF:6C1DEBA4241,-65,26,-65,6,37,\"\",\"\",1",
            "+UUDF:6C1DEBA4241G,-65,26,-65,6,37,\"\",\"\",1",
            "+UUDF:6C1DEBA4241B,-65,2.6,-65,6,37,\"\",\"\",x",
        ] {
            assert_eq!(degrees(line), Err(Rejected::Unparsable), "{line}");
        }
        let line = "+UUDF:6C1DEBA4241B,-65,91,-65,6,37,\"\",\"\",1";
        assert_eq!(degrees(line), Err(Rejected::OutOfRange));
    }

    #[test]
    fn sigmas_follow_the_cosine_of_the_azimuth() {
        for degrees in [0.0_f32, 15.0, 30.0, 50.0, 60.0, 70.0, 80.0] {
            let quality = 100.0 - degrees / 0.9;
            let exact = 5.0 / degrees.to_radians().cos();
            let got = SIGMAS.sigma_rad(quality).to_degrees();
            assert!((got / exact - 1.0).abs() < 0.05, "{degrees}: {got} {exact}");
        }
    }
}
