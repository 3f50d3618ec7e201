//! Lines of every build of the KrakenSDR's software, with default settings.
//!
//! The files are not part of the project: the tests read them from `kraken` in the directory that `FOXHUNT_DATA` names.

use std::fs;
use std::path::PathBuf;

use foxhunt::aoa::spectrum::Spectrum;
use foxhunt::aoa::{Observation, Robust, robust};
use foxhunt::gateway::formats::{Formats, Kraken, Nmea};
use foxhunt::gateway::{Config, Event, Gateway, Rejected, ShortReport};

type Whole<F> = Gateway<Robust<64, 64>, F, ShortReport>;

/// Text of a file, or what is skipped without it.
fn read(name: &str) -> Option<String> {
    let Some(data) = std::env::var_os("FOXHUNT_DATA") else {
        println!("{name} skipped: FOXHUNT_DATA does not name the directory of the measured data");
        return None;
    };
    let path = PathBuf::from(data).join("kraken").join(name);
    Some(fs::read_to_string(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display())))
}

fn gateway<F: Formats>() -> Box<Whole<F>> {
    Box::new(Gateway::new(Config::new(robust::Config::DEFAULT)).unwrap())
}

/// What one line leads to.
fn push<F: Formats>(gateway: &mut Whole<F>, line: &str) -> Event {
    let bytes = line.bytes().chain(*b"\n");
    let mut events = bytes.filter_map(|byte| gateway.push(0, byte));
    let event = events.next().expect("a line has an event");
    assert_eq!(events.next(), None);
    event
}

fn is_used(event: &Event) -> bool {
    matches!(event, Event::Fix(_) | Event::NotObservable(_))
}

fn compass(observation: &Observation) -> f32 {
    observation.bearing().compass_degrees()
}

fn apart(a: f32, b: f32) -> f32 {
    ((a - b + 540.0).rem_euclid(360.0) - 180.0).abs()
}

/// The files by their names, without the end.
const BUILDS: [&str; 7] = [
    "doa2022_mobile",
    "doa2023_mobile",
    "doa2024_mobile",
    "doa2024_static",
    "suite2026_compass",
    "suite2026_mobile",
    "suite2026_static",
];
const METHODS: [&str; 5] = [
    "bartlett_clean",
    "music_clean",
    "bartlett_reflected",
    "capon_reflected",
    "music_reflected",
];

/// Every line is used, and the clean ones tell the truth: the source is 40 degrees to the left, half a degree more in each.
fn all_lines_are_used<F: Formats>() {
    for build in BUILDS {
        for method in METHODS {
            let Some(text) = read(&format!("{build}_{method}.csv")) else {
                return;
            };
            let mut gateway = gateway::<F>();
            let heading = match build {
                "doa2024_static" | "suite2026_static" => 45.0,
                "suite2026_compass" => 359.9,
                _ => 0.0,
            };
            for (line, text) in (0u8..).zip(text.lines()) {
                let place = format!("{build} {method}, line {line}");
                let event = push(&mut gateway, text);
                assert!(is_used(&event), "{place}: {event:?}");
                let seen = gateway.vehicle().observation().unwrap();
                let truth = heading - 40.0 - 0.5 * f32::from(line);
                let error = apart(compass(&seen), truth);
                if method.ends_with("clean") {
                    assert!(error <= 1.5, "{place}: {error}");
                }
                // Polled again.
                let again = push(&mut gateway, text);
                assert_eq!(again, Event::Rejected(Rejected::Duplicate), "{place}");
                assert!(error <= 30.0, "{place}: {error}");
            }
            let counters = gateway.vehicle().counters();
            assert_eq!((counters.lines, counters.bearings), (20, 10));
        }
    }
}

#[test]
fn every_build_is_used_by_default() {
    all_lines_are_used::<(Nmea, Kraken)>();
}

#[test]
fn every_build_is_used_by_default_with_its_spectra() {
    all_lines_are_used::<(Nmea, Kraken<Spectrum>)>();
}

/// What is odd about each line of `edges.csv`, and what becomes of it as a first line: by its fields, and by its spectrum.
const EDGES: [(&str, Option<Rejected>, Option<Rejected>); 12] = [
    ("nothing", None, None),
    ("a power without decimals", None, None),
    ("-5e-05 degrees east", None, None),
    ("1.2e-05 degrees east", None, None),
    ("433920000.0 hertz", None, None),
    ("a name with a comma", None, None),
    ("a name with a quote", None, None),
    ("no name", None, None),
    ("a heading of -12.5 degrees", None, None),
    (
        "no heading",
        Some(Rejected::NoHeading),
        Some(Rejected::NoHeading),
    ),
    ("no blank at its end", None, None),
    ("359 values", None, Some(Rejected::Unparsable)),
];

fn outcome(event: Event) -> Option<Rejected> {
    match event {
        Event::Rejected(reason) => Some(reason),
        event => {
            assert!(is_used(&event));
            None
        }
    }
}

#[test]
fn every_edge_has_its_outcome() {
    let Some(text) = read("edges.csv") else {
        return;
    };
    let lines: Vec<&str> = text.lines().filter(|line| !line.is_empty()).collect();
    assert_eq!(lines.len(), EDGES.len());
    let mut together = gateway::<(Nmea, Kraken)>();
    for (place, (line, (what, by_fields, by_spectrum))) in lines.iter().zip(EDGES).enumerate() {
        let first = outcome(push(&mut gateway::<(Nmea, Kraken)>(), line));
        assert_eq!(first, by_fields, "{what}");
        let first = outcome(push(&mut gateway::<(Nmea, Kraken<Spectrum>)>(), line));
        assert_eq!(first, by_spectrum, "{what}");
        // They all have one spectrum, but for the last, which has none and is far from the first.
        let repeated = match place {
            0 => None,
            11 => Some(Rejected::OutOfRange),
            _ => Some(Rejected::Frozen),
        };
        assert_eq!(outcome(push(&mut together, line)), repeated, "{what}");
    }
}

#[test]
fn a_line_from_a_forum_is_used() {
    let Some(text) = read("field.csv") else {
        return;
    };
    // Its confidence is on no known scale, its spectrum is cut, and so its sense is not known.
    let mut gateway = gateway::<(Nmea, Kraken)>();
    let line = text.lines().next().unwrap();
    assert!(is_used(&push(&mut gateway, line)));
    let seen = gateway.vehicle().locator().observations();
    assert_eq!(seen.len(), 2);
}
