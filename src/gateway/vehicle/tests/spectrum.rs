//! Lines of a KrakenSDR with their spectra.

use super::*;
use crate::aoa::robust::{self, Correlation, Errors};
use crate::aoa::spectrum::Spectrum;
use crate::aoa::{Channels, Robust};
use crate::gateway::formats::{Agrelo, Kraken, Nmea};
use crate::gateway::report::FullReport;

type Whole<L> = Gateway<L, (Nmea, Agrelo, Kraken<Spectrum>), FullReport>;

const BY_NORTH: Config<robust::Config> = Config {
    reference: BearingReference::TrueNorth,
    max_speed_m_s: f32::INFINITY,
    ..Config::new(robust::Config {
        errors: Errors {
            correlation: Correlation::NONE,
            ..Errors::DEFAULT
        },
        ..robust::Config::DEFAULT
    })
};

fn robust(reference: BearingReference) -> Whole<Robust<256, 64>> {
    Gateway::new(Config {
        reference,
        ..BY_NORTH
    })
    .unwrap()
}

/// A line taken on the equator, so many metres east of the meridian, with peaks at compass degrees, `decibels` high.
fn line(number: i64, east: f64, peaks: &[(f32, f32)]) -> String {
    // Not on the meridian: that is nowhere.
    let longitude = (east + 1000.0) / 111_319.49;
    let mut line = format!(
        "{}, 0, 80.0, -30, 433920000, UCA, 0, fox, 0.0000000, {longitude:.7}, 0, 0, Compass, R, R, R, R",
        NOON + 1000 * number
    );
    for degree in 0..360 {
        // Counter-clockwise from where the array looks.
        let compass = 360.0 - degree as f32;
        let level = peaks.iter().fold(0.0_f32, |level, (at, decibels)| {
            let off = (compass - at + 540.0).rem_euclid(360.0) - 180.0;
            level.max(decibels - 0.5 * off * off)
        });
        line += &format!(", {level:.2}");
    }
    line + " \n"
}

fn push<L: Locate>(gateway: &mut Whole<L>, text: &str) -> Vec<Event> {
    text.bytes()
        .filter_map(|byte| gateway.push(0, byte))
        .collect()
}

#[test]
fn frequencies_are_channels() {
    let mut config = BY_NORTH;
    config.formats.kraken.frequencies_hz = &[433_920_000, 868_300_000];
    let mut gateway = Whole::<Channels<2, Robust<256, 64>>>::new(config).unwrap();
    // One source in the north, one in the south, in turns; a third one is none of them.
    for number in 0..80 {
        let east = 20.0 * number as f64;
        let (hertz, north) = [
            ("433920000", 900.0),
            ("868300000", -700.0),
            ("446000000", 300.0),
        ][number % 3];
        let compass = (800.0 - east).atan2(north).to_degrees().rem_euclid(360.0) as f32;
        let text = line(number as i64, east, &[(compass, 40.0)]);
        push(&mut gateway, &text.replace("433920000", hertz));
    }
    let identities = (0..).map_while(|i| Some(gateway.vehicle().locator().source(i)?.identity));
    assert_eq!(identities.collect::<Vec<_>>(), [1, 2]);
    push(&mut gateway, "$PFOXQ*50\r\n");
    for number in [1, 2] {
        let of_source = format!("$PFOXM,{number},");
        assert!(
            gateway.vehicle().report().contains(&of_source),
            "{}",
            gateway.vehicle().report()
        );
    }
    assert_eq!(
        gateway
            .vehicle()
            .counters()
            .rejected(Rejected::OtherFrequency),
        26
    );
}

#[test]
fn bearings_are_the_peaks() {
    let mut gateway = robust(BearingReference::TrueNorth);
    let events = push(&mut gateway, &line(0, 0.0, &[(30.3, 20.0), (200.0, 22.0)]));
    assert!(matches!(events[..], [Event::NotObservable(_)]));
    let mut seen: Vec<f32> = (gateway.vehicle().locator().observations())
        .map(|o| o.bearing().compass_degrees())
        .collect();
    seen.sort_by(f32::total_cmp);
    let [direct, reflected] = seen[..] else {
        panic!("{seen:?}");
    };
    assert!(
        (direct - 30.3).abs() < 0.1 && (reflected - 200.0).abs() < 0.1,
        "{seen:?}"
    );
    // The best is what was used.
    let best = gateway.vehicle().observation().unwrap();
    assert!((best.bearing().compass_degrees() - 200.0).abs() < 0.1);
    assert_eq!(gateway.vehicle().counters().bearings, 1);

    // By a heading: the array's axis is the car's.
    let mut gateway = robust(BearingReference::Relative);
    let turned = line(0, 0.0, &[(30.0, 20.0)]).replace("0, 0, Compass", "0, 90.0, Compass");
    push(&mut gateway, &turned);
    let bearing = gateway
        .vehicle()
        .observation()
        .unwrap()
        .bearing()
        .compass_degrees();
    assert!((bearing - 120.0).abs() < 0.1, "{bearing}");
}

#[test]
fn a_plain_locator_gets_the_largest_peak() {
    let config = Config {
        reference: BearingReference::TrueNorth,
        ..CONFIG
    };
    let mut gateway: Whole<Clean<60, 16>> = Gateway::new(config).unwrap();
    push(&mut gateway, &line(0, 0.0, &[(30.0, 20.0), (200.0, 18.0)]));
    let mut seen = gateway.vehicle().locator().observations();
    let (Some(one), None) = (seen.next(), seen.next()) else {
        panic!("one line, one bearing");
    };
    assert!((one.bearing().compass_degrees() - 30.0).abs() < 0.1);
}

#[test]
fn a_drive_among_reflections_leads_to_a_fix() {
    let mut gateway = robust(BearingReference::TrueNorth);
    let mut last = None;
    for i in 0..12 {
        let east = 100.0 * f64::from(i);
        // The source is 800 m to the north of 600 m; the reflection is the higher one of every other line.
        let direct = (600.0 - east as f32)
            .atan2(800.0)
            .to_degrees()
            .rem_euclid(360.0);
        let reflected = (100.0 + 53.0 * i as f32) % 360.0;
        let higher = if i % 2 == 0 { 21.0 } else { 19.0 };
        let text = line(i64::from(i), east, &[(direct, 20.0), (reflected, higher)]);
        last = push(&mut gateway, &text).pop();
    }
    let Some(Event::Fix(fix)) = last else {
        panic!("{last:?}")
    };
    assert_eq!(fix.bearings, 12);
    assert!(fix.ellipse(0.95).contains([600.0, 800.0]), "{fix:?}");
}

#[test]
fn a_line_without_its_spectrum_changes_nothing() {
    let whole = line(0, 0.0, &[(30.0, 20.0)]);
    let ended = |end: &str| whole.replace(", 0.00 \n", end);
    for (text, reason) in [
        (ended("\n"), Rejected::Unparsable),
        (ended(", 0.00, 0.00\n"), Rejected::Unparsable),
        (ended(", nan\n"), Rejected::Unparsable),
        (ended(", -1.00\n"), Rejected::Unparsable),
        (
            kraken(NOON, 30.0, "0.0, 1.0, 0, 0, GPS"),
            Rejected::Unparsable,
        ),
        (line(0, 0.0, &[]), Rejected::LowQuality),
    ] {
        let mut gateway = robust(BearingReference::TrueNorth);
        assert_eq!(push(&mut gateway, &text), [Event::Rejected(reason)]);
        assert_eq!(gateway.vehicle().locator().observations().len(), 0);
        assert_eq!(gateway.vehicle().observation(), None);
        // The next is whole.
        assert!(matches!(
            push(&mut gateway, &whole)[..],
            [Event::NotObservable(_)]
        ));
    }
    // Other finders' lines have none.
    let mut gateway = robust(BearingReference::TrueNorth);
    let other = format!("{}%030/9\r", rmc("120000"));
    assert!(matches!(
        push(&mut gateway, &other)[..],
        [Event::Used, Event::NotObservable(_)]
    ));
}
