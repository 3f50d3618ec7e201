//! Positions that are wrong for seconds and confirm each other: at the start, and in the middle of a drive.

use super::*;
use std::boxed::Box;

type Whole = Vehicle<Clean<200, 64>>;

const DEFAULT: Config<clean::Config> = Config::new(clean::Config::DEFAULT);

/// Degrees and minutes of a place so many metres east and north of where the drive begins.
fn place([east, north]: [f64; 2]) -> String {
    let of = |degrees: f64, minutes: f64| (degrees + (minutes / 60.0).floor(), minutes % 60.0);
    let (latitude, north) = of(48.0, 7.0 + north / 1_852.0);
    let (longitude, east) = of(11.0, 31.0 + east / 1_240.0);
    format!("{latitude:02}{north:07.4},N,{longitude:03}{east:07.4},E")
}

/// 15 m/s to the east, past a source 900 m ahead and 400 m to the left: what receiver and finder say each second.
fn second(at: u32, off: f64) -> String {
    let east = 15.0 * f64::from(at);
    let position = place([east, off]);
    let clock = format!("12{:02}{:02}", at / 60, at % 60);
    let relative = (-400.0f64)
        .atan2(900.0 - east)
        .to_degrees()
        .rem_euclid(360.0);
    sentence(&format!(
        "GPRMC,{clock},A,{position},29.16,090.0,221126,,,A"
    )) + &format!("%{:03}/8\r", relative as u32)
}

/// The gateway after so many seconds, of which some have positions so many metres off to the north.
fn drive(seconds: u32, wrong: core::ops::Range<u32>, off: f64) -> Box<Whole> {
    let mut vehicle = Box::new(Whole::EMPTY);
    for at in 0..seconds {
        let off = if wrong.contains(&at) { off } else { 0.0 };
        for byte in second(at, off).bytes() {
            vehicle.push(0, byte, &DEFAULT);
        }
    }
    vehicle
}

/// Metres from the fix to the source.
fn error(vehicle: &Whole) -> Option<f32> {
    let minutes = |degrees: f64, minutes: f64| ((degrees + minutes / 60.0) * 1e7) as i32;
    let latitude = minutes(48.0, 7.0 + 400.0 / 1_852.0);
    let source = Geodetic::new(latitude, minutes(11.0, 31.0 + 900.0 / 1_240.0)).unwrap();
    let [x, y] = vehicle.locator().fix()?.position;
    let [east, north] = vehicle.plane()?.to_local(source).ok()?;
    Some((x - east).hypot(y - north))
}

/// In the plane, and beyond it.
const OFF: [f64; 3] = [300.0, 3_000.0, 300_000.0];

#[test]
fn a_wrong_first_position_is_left_even_with_a_fix() {
    for off in OFF {
        // There is none yet: three bearings are enough.
        let vehicle = drive(120, 0..15, off);
        assert!(error(&vehicle).unwrap() < 30.0, "{off}");
        assert_eq!(vehicle.counters().bearings, 117);
        // There is: after 20 s. The first right position waits, so that its bearing has the one before.
        let wrong = drive(41, 0..40, off);
        assert!(wrong.locator().fix().is_some());
        let lasts = drive(61, 0..40, off);
        assert_eq!(lasts.locator().fix(), wrong.locator().fix());
        assert_eq!(drive(62, 0..40, off).locator().fix(), None);
        let vehicle = drive(120, 0..40, off);
        assert!(error(&vehicle).unwrap() < 60.0, "{off}");
        let counters = vehicle.counters();
        let reasons = [Rejected::OutOfRange, Rejected::Unconfirmed];
        let strays: u32 = reasons.map(|reason| counters.rejected(reason)).iter().sum();
        // And the first position, and the first right one.
        assert_eq!(strays, 20 + 2, "{off}");
    }
}

#[test]
fn a_lapse_costs_its_bearings_and_no_more() {
    for off in OFF {
        let vehicle = drive(120, 60..75, off);
        // The first has no position, and the last wrong one is believed until the next right one is confirmed.
        assert_eq!(vehicle.counters().bearings, 119 - 15, "{off}");
        let (found, without) = (error(&vehicle), error(&drive(120, 0..0, 0.0)));
        assert!(found.unwrap() < 10.0 + without.unwrap(), "{off}: {found:?}");
    }
}

#[test]
fn several_stations_are_not_one_that_jumps() {
    let mut vehicle = Box::new(Whole::EMPTY);
    for second in 0..20 {
        let north = if second % 2 == 0 { 0 } else { 20 };
        let line = format!(
            "N0CALL>APRS:@1200{second:02}h48{north:02}.00N/01131.00E\\000/000/{:03}/729\r\n",
            45 + north
        );
        for byte in line.bytes() {
            vehicle.push(0, byte, &DEFAULT);
        }
    }
    assert_eq!(vehicle.counters().bearings, 20);
}
