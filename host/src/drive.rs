//! A drive of a vehicle, as the bytes that its receiver and its direction finder put on the line.

use std::{
    f64::consts::TAU,
    fmt::{Display, Write},
};

use foxhunt::gateway::formats::kraken;
use rand::{Rng, RngExt};

use crate::{array, geodesy::Place};
use foxhunt_simulation::{
    path::along,
    random::{generator, normal},
    sentence::sentence,
};

/// A line of serial data with its sentences, one after the other.
///
/// The first sentences may be `$PFOXT` with the true places of the transmitters, at the end of the drive if they move:
/// gateways ignore them, and whoever replays the drive can tell how good the answer is.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Drive {
    text: String,
}

/// What the direction finder of a drive reads at one moment.
#[derive(Debug, Clone, Copy)]
pub struct Reading {
    /// When it was taken, in seconds after midnight.
    pub time: f64,
    /// Degrees clockwise from the bow.
    pub degrees: f64,
    /// 0 to 100.
    pub quality: f64,
}

/// The day of every drive, 22 November 2026, in seconds after 1970.
const DAY: f64 = 1_795_305_600.0;
const DATE: &str = "221126";
const KNOTS: f64 = 3600.0 / 1852.0;

impl Drive {
    /// Appends `$payload*hh`.
    pub fn sentence(&mut self, payload: impl Display) {
        self.text.push_str(&sentence(payload));
    }

    /// Appends the true place of a transmitter.
    pub fn truth(&mut self, place: Place) {
        self.sentence(format_args!("PFOXT,{}", place.nmea()));
    }

    /// Appends what a receiver says at `time` (seconds after midnight): RMC and GGA with the place,
    /// the speed in metres per second and the course in degrees clockwise from north.
    pub fn position(&mut self, time: f64, place: Place, speed: f64, course: f64) {
        let (clock, place, speed) = (clock(time), place.nmea(), speed * KNOTS);
        self.sentence(format_args!(
            "GPRMC,{clock},A,{place},{speed:.2},{course:.2},{DATE},,,A"
        ));
        self.sentence(format_args!(
            "GPGGA,{clock},{place},1,09,0.9,112.0,M,34.0,M,,"
        ));
    }

    /// Appends what a receiver says while it has no position.
    pub fn no_position(&mut self, time: f64) {
        self.sentence(format_args!("GPRMC,{},V,,,,,,,{DATE},,,N", clock(time)));
    }

    /// Appends the true heading, in degrees clockwise from north.
    pub fn heading(&mut self, degrees: f64) {
        self.sentence(format_args!("GPHDT,{:.2},T", degrees.rem_euclid(360.0)));
    }

    /// Appends a bearing as krakensdr_doa since July 2024 writes it, with a spectrum, without a place of its own.
    pub fn kraken(&mut self, reading: Reading) {
        /// Milliseconds that a reading takes.
        const INTERVAL: f64 = 96.0;
        const BETWEEN: &str =
            "-48.5, 433920000, UCA, 96, foxhunt, 0.0, 0.0, 0.0, 0.0, GPS, R, R, R, R";
        let milliseconds = ((DAY + reading.time) * 1e3 + 0.5 * INTERVAL).round();
        let spectrum = spectrum(&reading);
        self.line(format_args!(
            "{milliseconds}, {}",
            array::fields(&spectrum, BETWEEN)
        ));
    }

    fn line(&mut self, text: impl Display) {
        // Writing to a string does not fail.
        let _ = write!(self.text, "{text}\r\n");
    }

    /// Everything so far.
    pub fn bytes(&self) -> &[u8] {
        self.text.as_bytes()
    }
}

/// The true place of the first transmitter, if the bytes of a drive tell it.
pub fn truth(bytes: &[u8]) -> Option<Place> {
    truths(bytes).next()
}

/// The true places of all transmitters of which the bytes of a drive tell them.
pub fn truths(bytes: &[u8]) -> impl Iterator<Item = Place> {
    bytes.split(|byte| *byte == b'\n').filter_map(|line| {
        let line = str::from_utf8(line).ok()?;
        let (fields, _checksum) = line.strip_prefix("$PFOXT,")?.split_once('*')?;
        Place::from_nmea(fields)
    })
}

/// One peak on a floor, in decibels over the floor, of which the maximum is as far above the mean as the quality says. The
/// floor is a little higher from second to second: real spectra never repeat.
fn spectrum(reading: &Reading) -> Vec<f64> {
    /// Standard deviation of the power, of the widest peak.
    const WIDEST: f64 = 20.0;
    let area = TAU.sqrt();
    // The degrees of a peak without flanks that is as high and holds as much.
    let width = 3.6 * (100.0 - reading.quality.clamp(1.0, 99.5));
    let sigma = (width / area).min(WIDEST);
    let floor = ((width - sigma * area) / (360.0 - sigma * area)).max(1e-4);
    let floor = floor * (1.0 + 0.01 * (reading.time.rem_euclid(13.0)));
    let level = |degree: u16| {
        let off = (f64::from(degree) + reading.degrees + 180.0).rem_euclid(360.0) - 180.0;
        let power = floor + (1.0 - floor) * (-0.5 * (off / sigma).powi(2)).exp();
        10.0 * (power / floor).log10()
    };
    (0..360).map(level).collect()
}

fn clock(time: f64) -> String {
    let centiseconds = (time * 100.0).round() as u64;
    let (hours, minutes) = (centiseconds / 360_000, centiseconds / 6_000 % 60);
    format!(
        "{hours:02}{minutes:02}{:02}.{:02}",
        centiseconds / 100 % 60,
        centiseconds % 100
    )
}

/// The seed of the drive that comes with the project.
pub const EXAMPLE_SEED: u64 = 2016;

/// The drive that comes with the project, from a seed: three kilometres round a transmitter, with
/// everything that a field brings.
pub fn example(seed: u64) -> Drive {
    /// Metres east and north of the start.
    const CORNERS: [[f64; 2]; 5] = [
        [0.0, 0.0],
        [640.0, 90.0],
        [980.0, 520.0],
        [1420.0, 640.0],
        [1560.0, 1380.0],
    ];
    const TRANSMITTER: [f64; 2] = [700.0, 1150.0];
    const START: Place = Place {
        latitude: 52.229_675_6,
        longitude: 21.012_228_7,
    };
    const SECONDS: usize = 184;
    /// Seconds after midnight.
    const DEPARTURE: f64 = 9.0 * 3600.0 + 1800.0;
    /// Seconds until the receiver has its first position.
    const BLIND: usize = 4;
    /// Seconds from one bearing to the next.
    const PAUSE: usize = 3;

    let mut rng = generator(seed, 0);
    let transmitter = START.offset(TRANSMITTER);
    let track = along(&CORNERS, SECONDS);
    let mut drive = Drive::default();
    drive.truth(transmitter);
    for (second, places) in track.windows(2).enumerate() {
        let time = DEPARTURE + second as f64;
        let (place, next) = (START.offset(places[0]), START.offset(places[1]));
        let heading = place.compass_degrees(next);
        if second < BLIND {
            drive.no_position(time);
        } else {
            let [east, north] = place.local(next);
            // What a good receiver errs by from second to second; its slow errors are the same for all.
            let seen = place.offset([0.5 * normal(&mut rng), 0.5 * normal(&mut rng)]);
            drive.position(time, seen, east.hypot(north), heading);
            drive.heading(heading + 0.3 * normal(&mut rng));
        }
        if second % PAUSE == 0 {
            let quality = quality(&mut rng);
            let error = sigma_degrees(quality) * normal(&mut rng);
            drive.kraken(Reading {
                time,
                degrees: place.compass_degrees(transmitter) - heading + error,
                quality,
            });
        }
    }
    drive
}

/// Most readings are good, some are not worth having.
fn quality(rng: &mut impl Rng) -> f64 {
    if rng.random_bool(0.1) {
        rng.random_range(5.0..40.0)
    } else {
        rng.random_range(50.0..98.0)
    }
}

/// Standard deviation of a bearing of this quality, in degrees, as the gateway takes it to be.
pub(crate) fn sigma_degrees(quality: f64) -> f64 {
    f64::from(kraken::SIGMAS.sigma_rad(quality as f32)).to_degrees()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_same_seed_makes_the_same_drive() {
        assert_eq!(example(1), example(1));
        assert_ne!(example(1), example(2));
    }

    #[test]
    fn the_shipped_drive_is_that_of_its_seed() {
        let shipped = include_bytes!("../../examples/data/drive.nmea");
        let same = example(EXAMPLE_SEED).bytes() == shipped;
        assert!(same, "remake it: cargo xtask drive");
    }

    #[test]
    fn a_drive_tells_the_truth() {
        let place = truth(example(1).bytes()).unwrap();
        assert!((place.latitude - 52.24).abs() < 0.01 && (place.longitude - 21.02).abs() < 0.01);
        assert_eq!(truth(b"$GPHDT,1.0,T*00\r\n"), None);
        // The lines of each transmitter alone.
        let mut drive = Drive::default();
        let other = place.offset([300.0, -200.0]);
        drive.truth(place);
        drive.truth(other);
        let bytes = [b"\xb5\x62\xff\r\n", drive.bytes()].concat();
        let found: Vec<Place> = truths(&bytes).collect();
        assert_eq!(found.len(), 2);
        for (found, place) in found.iter().zip([place, other]) {
            assert!(place.local(*found).iter().all(|metres| metres.abs() < 0.01));
        }
    }
}
