extern crate std;
use super::*;
use crate::aoa::geodesy::Geodetic;
use crate::gateway::formats::tests::read;
use std::{format, string::String, vec::Vec};

/// 14:35:19.25 UTC.
const START: i64 = 1_756_823_719_250;
const NOWHERE: &str = "0.0, 0.0, 0.0, 0.0, GPS";

fn line(text: &str) -> Result<Reading, Rejected> {
    with(text, Config::DEFAULT)
}

fn with(text: &str, kraken: Config) -> Result<Reading, Rejected> {
    read::<Kraken>(text, &kraken)
}

/// The example with another field.
fn changed(field: usize, text: &str) -> Result<Reading, Rejected> {
    let mut fields: Vec<&str> = EXAMPLE.split(',').collect();
    fields[field] = text;
    line(&fields.join(","))
}

/// Gives one KrakenSDR line after line.
struct Lines {
    kraken: Kraken,
    config: Config,
}

impl Lines {
    fn new(config: Config) -> Self {
        Self {
            kraken: Format::EMPTY,
            config,
        }
    }

    fn push(&mut self, kept: &str, spectrum: &str) -> Result<Reading, Rejected> {
        self.kraken.begin();
        spectrum.bytes().for_each(|byte| self.kraken.rest(byte));
        match self.kraken.parse(kept.as_bytes(), &self.config)? {
            Sentence::Reading(reading) => Ok(reading),
            other => panic!("{other:?}"),
        }
    }
}

fn kept(milliseconds: i64, bearing: &str, pose: &str) -> String {
    format!("{milliseconds}, {bearing}, 9.0, -30, 433920000, UCA, 437, x, {pose}, R, R, R, R")
}

/// With a maximum so many degrees counter-clockwise, `decibels` high.
fn spectrum(top: f32, decibels: f32) -> String {
    let values: Vec<String> = (0..360)
        .map(|degree| {
            let off = from_ahead(degree as f32 - top);
            format!("{:.2}", (decibels - 0.05 * off * off).max(0.0))
        })
        .collect();
    format!(" {} ", values.join(", "))
}

/// Degrees of all bearings of a reading, clockwise, the most probable first.
fn degrees(reading: &Reading) -> Vec<f32> {
    let rays = [&reading.best]
        .into_iter()
        .chain(reading.others.iter().flatten());
    rays.map(|ray| ray.degrees).collect()
}

#[test]
fn reads_the_fields_before_the_spectrum() {
    let line = line(EXAMPLE).unwrap();
    assert_eq!(line.time, TimeOfDay::from_nmea(b"143519.25"));
    assert_eq!(degrees(&line), [297.0, 63.0]);
    // Of 437 ms, the middle.
    assert_eq!(line.latency_ms, 218);
    let place = Geodetic::new(522_296_756, -210_122_287).unwrap();
    assert_eq!(line.place, Some(place));
    assert_eq!(line.reference, Reference::Told(Some(12.5)));
    // 7.35 decibels of maximum over mean.
    assert!((line.quality - (100.0 - 100.0 / 5.433)).abs() < 0.01);
}

#[test]
fn refuses_malformed_fields() {
    let line_of_compass = changed(12, " Compass").unwrap();
    assert_eq!(line_of_compass.reference, Reference::Told(Some(12.5)));
    for (field, text, reason) in [
        (0, "1756823719", Rejected::Unparsable),
        (0, "175682371925x", Rejected::Unparsable),
        (0, "17568237192.5", Rejected::Unparsable),
        (0, "1756823719250.0", Rejected::Unparsable),
        (1, "721", Rejected::OutOfRange),
        (1, "nan", Rejected::Unparsable),
        (1, "", Rejected::Unparsable),
        (2, "-1", Rejected::OutOfRange),
        (2, "-0.1", Rejected::OutOfRange),
        (2, "", Rejected::Unparsable),
        (6, "x", Rejected::Unparsable),
        (6, "-1", Rejected::OutOfRange),
        (8, "90.0000001", Rejected::OutOfRange),
        (8, "522296756", Rejected::OutOfRange),
        (8, "1e3", Rejected::Unparsable),
        (8, "1e-", Rejected::Unparsable),
        (8, "1e-0x", Rejected::Unparsable),
        (8, "e-5", Rejected::Unparsable),
        (9, "-180.1", Rejected::OutOfRange),
        (9, "E21", Rejected::Unparsable),
        (10, "800", Rejected::OutOfRange),
        (10, "inf", Rejected::Unparsable),
    ] {
        assert_eq!(changed(field, text), Err(reason), "field {field} {text}");
    }
    let nowhere = "1756823719250,5,50,-30,1,UCA,1,x,0.0,0,nan,nan,GPS";
    let nowhere = line(nowhere).unwrap();
    assert_eq!(
        (nowhere.place, nowhere.reference),
        (None, Reference::Told(None))
    );
    for short in [
        "1756823719250,5,50",
        "1756823719250,5,50,-30,1,UCA,1,47.0,8.0,0,0,GPS",
        "1756823719250,R,R,R,R",
    ] {
        assert_eq!(line(short), Err(Rejected::Unparsable));
    }
}

#[test]
fn numbers_are_as_python_writes_them() {
    for (text, degrees_e7) in [
        ("-5e-05", -500),
        ("1.2e-05", 120),
        ("9.99e-06", 100),
        ("1e-09", 0),
        ("0.1", 1_000_000),
    ] {
        let place = changed(9, text).unwrap().place.unwrap();
        assert_eq!(place.longitude_e7(), degrees_e7, "{text}");
    }
    assert_eq!(changed(8, "None").unwrap().place, None);
    assert_eq!(changed(8, " nan").unwrap().place, None);
    let headings = [("None", None), ("-12.5", Some(347.5)), ("372", Some(12.0))];
    for (text, heading) in headings {
        assert_eq!(
            changed(10, text).unwrap().reference,
            Reference::Told(heading)
        );
    }
    for (text, bearing) in [("-30", 330.0), ("390.0", 30.0), ("360", 0.0)] {
        assert_eq!(changed(1, text).unwrap().best.degrees, bearing, "{text}");
    }
}

#[test]
fn a_station_has_any_name() {
    let reading = line(EXAMPLE);
    for name in [
        "",
        " ",
        "car, north",
        "12\" mast",
        "a,b,c,d",
        "R",
        "GPS",
        "\u{fc}",
    ] {
        assert_eq!(changed(7, name), reading, "{name}");
    }
}

#[test]
fn the_quality_is_how_far_the_maximum_is_above_the_mean() {
    let quality = |confidence: &str, scale| {
        let kept = kept(START, "5", NOWHERE).replace("9.0", confidence);
        let confidence = scale;
        let config = Config {
            confidence,
            ..Config::DEFAULT
        };
        with(&kept, config).map(|reading| reading.quality.round())
    };
    let (decibels, fraction) = (Some(Confidence::Decibels), Some(Confidence::Fraction));
    assert_eq!(quality("0", decibels), Ok(0.0));
    assert_eq!(quality("10.0", decibels), Ok(90.0));
    assert_eq!(quality("25.5634", None), Ok(100.0));
    assert_eq!(quality("1.00", None), Ok(75.0));
    assert_eq!(quality("0.91", fraction), Ok(73.0));
    // On no known scale it says nothing, and the reading is used all the same.
    for scale in [None, decibels, fraction] {
        assert_eq!(quality("159", scale), Ok(50.0));
    }
    // The spectrum knows better.
    let mut lines = Lines::new(Config::DEFAULT);
    let needle = lines.push(&kept(START, "5", NOWHERE), &spectrum(355.0, 500.0));
    assert!(needle.unwrap().quality > 95.0);
    let flat = lines.push(&kept(START + 1, "5", NOWHERE), &spectrum(355.0, 0.0));
    assert!(flat.unwrap().quality < 0.1);
}

#[test]
fn sigmas_are_those_of_the_width() {
    let sigma = |decibels: &str| {
        let kept = kept(START, "90", NOWHERE).replace("9.0", decibels);
        let reading = with(&kept, Config::DOA_2024).unwrap();
        reading.best.sigma_rad.unwrap().to_degrees()
    };
    for (decibels, degrees) in [("25.5", 2.0), ("10.0", 6.0), ("7.0", 7.0), ("2.5", 8.5)] {
        assert!((sigma(decibels) - degrees).abs() < 0.05, "{decibels}");
    }
    let none = Config {
        sigmas: None,
        ..Config::DEFAULT
    };
    assert_eq!(with(EXAMPLE, none).unwrap().best.sigma_rad, None);
}

#[test]
fn the_sense_is_told_by_the_spectrum() {
    let both = |lines: &mut Lines, milliseconds: i64, bearing: &str, top: f32| {
        // Every spectrum is another.
        let text = spectrum(top, 20.0 + 0.01 * milliseconds as f32);
        let reading = lines.push(&kept(START + milliseconds, bearing, NOWHERE), &text);
        degrees(&reading.unwrap())
    };
    let unknown = |lines: &mut Lines, milliseconds: i64, bearing: &str| {
        let reading = lines.push(&kept(START + milliseconds, bearing, NOWHERE), "");
        degrees(&reading.unwrap())
    };
    let mut lines = Lines::new(Config::DEFAULT);
    assert_eq!(unknown(&mut lines, 0, "60"), [60.0, 300.0]);
    assert_eq!(unknown(&mut lines, 0, "10"), [10.0]);
    assert_eq!(unknown(&mut lines, 0, "11"), [11.0, 349.0]);
    // Ahead and behind either will do.
    assert_eq!(both(&mut lines, 1, "2", 357.0), [2.0]);
    assert_eq!(unknown(&mut lines, 2, "60"), [60.0, 300.0]);
    assert_eq!(both(&mut lines, 3, "60", 60.0), [300.0]);
    assert_eq!(unknown(&mut lines, 4, "60"), [300.0, 60.0]);
    assert_eq!(both(&mut lines, 5, "61", 60.0), [299.0]);
    // Known now, with and without a spectrum or where that is not of the bearing.
    assert_eq!(unknown(&mut lines, 6, "60"), [300.0]);
    assert_eq!(both(&mut lines, 7, "60", 100.0), [300.0]);
    // One that tells otherwise may be damaged; several are right.
    assert_eq!(both(&mut lines, 8, "60", 300.0), [300.0, 60.0]);
    for milliseconds in 9..20 {
        both(&mut lines, milliseconds, "60", 300.0);
    }
    assert_eq!(both(&mut lines, 20, "60", 300.0), [60.0]);
    assert_eq!(unknown(&mut lines, 21, "60"), [60.0]);
    // However long it was known, as soon as it is outweighed.
    for milliseconds in 22..27 {
        both(&mut lines, milliseconds, "60", 60.0);
    }
    assert_eq!(both(&mut lines, 27, "60", 60.0), [300.0]);
    // Whoever knows the build need not ask.
    for (config, degrees) in [(Config::DOA_2023, 300.0), (Config::SUITE_2026, 60.0)] {
        assert_eq!(unknown(&mut Lines::new(config), 0, "60"), [degrees]);
    }
}

#[test]
fn a_spectrum_counts_once() {
    let mut lines = Lines::new(Config::DEFAULT);
    let mut push = |milliseconds: i64, top: f32| {
        let kept = kept(START + milliseconds, "60", NOWHERE);
        lines.push(&kept, &spectrum(top, 20.0)).map(|_| ())
    };
    assert_eq!(push(0, 300.0), Ok(()));
    assert_eq!(push(0, 300.0), Ok(()));
    assert_eq!(push(400, 300.0), Err(Rejected::Frozen));
    assert_eq!(push(400, 300.0), Err(Rejected::Frozen));
    // Several channels take turns.
    for (milliseconds, top) in [(500, 10.0), (500, 20.0), (500, 30.0)] {
        assert_eq!(push(milliseconds, top), Ok(()));
    }
    for top in [300.0, 10.0, 20.0, 30.0] {
        assert_eq!(push(900, top), Err(Rejected::Frozen));
    }
    // Only so many are known.
    assert_eq!(push(1_000, 40.0), Ok(()));
    assert_eq!(push(1_000, 300.0), Ok(()));
}

/// The headings of lines at places on a meridian, in 1e-4 degrees, which are 11 m.
fn headings(config: Config, heading: &str, places: &[(i64, i64)]) -> Vec<Option<f32>> {
    let mut lines = Lines::new(config);
    let line = |(milliseconds, place): &(i64, i64)| {
        let pose = format!("48.{place:04}, 11.5, {heading}");
        let reading = lines.push(&kept(START + milliseconds, "60", &pose), "");
        match reading.unwrap().reference {
            Reference::Told(heading) => heading,
            other => panic!("{other:?}"),
        }
    };
    places.iter().map(line).collect()
}

#[test]
fn a_heading_holds_as_it_is_known() {
    let of = |heading| Config {
        heading,
        ..Config::DEFAULT
    };
    let standing = [(0, 0), (500, 0), (1_000, 0), (1_500, 0)];
    let [drives, stops] = [
        [(0, 0), (1_000, 1), (2_000, 2)],
        [(0, 0), (1_000, 1), (2_000, 1)],
    ];
    let (fixed, zero) = ("45.0, 90.0, GPS", "0.0, 90.0, GPS");
    let here = Some(45.0);
    // Somebody has entered it, or nobody has.
    assert_eq!(headings(Config::DEFAULT, fixed, &standing), [here; 4]);
    let unproven = [Some(0.0), Some(0.0), None, None];
    assert_eq!(headings(Config::DEFAULT, zero, &standing), unproven);
    for heading in [Heading::Recognised, Heading::Vehicle] {
        assert_eq!(headings(of(heading), fixed, &drives), [here; 3]);
        assert_eq!(headings(of(heading), zero, &drives), [Some(0.0); 3]);
        assert_eq!(headings(of(heading), fixed, &stops), [here, here, None]);
    }
    assert_eq!(headings(of(Heading::Vehicle), fixed, &standing)[3], None);
    // 11 m in ten seconds may be noise, 22 m are none.
    let slow = [(0, 0), (10_000, 1), (20_000, 3)];
    let told = headings(of(Heading::Vehicle), fixed, &slow);
    assert_eq!(told, [here, None, here]);
    assert_eq!(
        headings(of(Heading::Station), zero, &standing),
        [Some(0.0); 4]
    );
    for rule in [of(Heading::Compass), Config::DEFAULT] {
        let named = "0.0, 90.0, Compass";
        assert_eq!(headings(rule, named, &standing), [Some(90.0); 4]);
    }
    assert_eq!(
        headings(of(Heading::Compass), zero, &standing),
        [Some(90.0); 4]
    );
}

#[test]
fn a_made_up_heading_is_told_once() {
    let mut lines = Lines::new(Config::DEFAULT);
    let mut retracted = |milliseconds: i64| {
        let pose = "48.1, 11.5, 0.0, 0.0, GPS";
        let reading = lines.push(&kept(START + milliseconds, "60", pose), "");
        reading.unwrap().retracted
    };
    assert_eq!(
        [0, 400, 800, 1_200, 1_600].map(&mut retracted),
        [0, 0, 0, 3, 0]
    );
}

#[test]
fn the_interval_may_be_told() {
    let config = Config {
        interval_ms: Some(500),
        ..Config::SUITE_2026
    };
    assert_eq!(with(EXAMPLE, config).unwrap().latency_ms, 250);
    let long = Config {
        interval_ms: Some(60_001),
        ..config
    };
    assert_eq!(long.check().unwrap_err().field(), "interval_ms");
    let longest = Config {
        interval_ms: Some(60_000),
        frequencies_hz: &[1; 255],
        ..config
    };
    assert_eq!(longest.check(), Ok(()));
}

#[test]
fn only_the_wanted_frequencies_are_read() {
    let at = |text: &str, frequencies_hz| {
        let config = Config {
            frequencies_hz,
            ..Config::DEFAULT
        };
        with(text, config).map(|reading| reading.channel)
    };
    assert_eq!(at(EXAMPLE, &[]), Ok(0));
    assert_eq!(at(EXAMPLE, &[433_920_000]), Ok(1));
    assert_eq!(at(EXAMPLE, &[1, 433_920_000]), Ok(2));
    let fraction = EXAMPLE.replace("433920000", "433920000.0");
    assert_eq!(at(&fraction, &[433_920_000]), Ok(1));
    assert_eq!(at(EXAMPLE, &[433_920_001]), Err(Rejected::OtherFrequency));
    let huge = EXAMPLE.replace("433920000", "4339200000000");
    assert_eq!(at(&huge, &[1]), Err(Rejected::OtherFrequency));
    // Nothing else of such a line matters, nor does it change what is known of our own.
    let broken = "1756823719250,x,50,-30,446000000,UCA,1,x,0,0,0,0,GPS";
    assert_eq!(at(broken, &[433_920_000]), Err(Rejected::OtherFrequency));
    let unnamed = "1756823719250,5,50,-30,UHF,UCA,1,x,0,0,0,0,GPS";
    assert_eq!(at(unnamed, &[1]), Err(Rejected::Unparsable));
    for frequencies_hz in [&[1; 256][..], &[433_920_000, 0]] {
        let config = Config {
            frequencies_hz,
            ..Config::DEFAULT
        };
        assert_eq!(config.check().unwrap_err().field(), "frequencies_hz");
    }
}

#[test]
fn the_temper_is_checked() {
    for temper in [0.0, 11.0, f32::NAN] {
        let config = Config {
            temper,
            ..Config::DEFAULT
        };
        assert_eq!(config.check().unwrap_err().field(), "temper");
    }
}
