use foxhunt::aoa::{Clean, clean};
use foxhunt::gateway::{BearingReference, Config, Gateway};

use super::{Case, Digest};

pub const CASES: &[Case] = &[("gateway::a_drive_leads_to_a_fix", a_drive_leads_to_a_fix)];

/// A vehicle drives north, 100 m from one line to the next, past a source to its east.
const DRIVE: [(&str, &str); 6] = [
    (
        "GPRMC,120000.00,A,4807.0000,N,01131.0000,E,020.0,000.0,010125,,,A",
        "%045/9\r",
    ),
    (
        "GPRMC,120010.00,A,4807.0540,N,01131.0000,E,020.0,000.0,010125,,,A",
        "%053/9\r",
    ),
    (
        "GPRMC,120020.00,A,4807.1080,N,01131.0000,E,020.0,000.0,010125,,,A",
        "%066/8\r",
    ),
    (
        "GPRMC,120030.00,A,4807.1620,N,01131.0000,E,020.0,000.0,010125,,,A",
        "%077/9\r",
    ),
    (
        "GPRMC,120040.00,A,4807.2160,N,01131.0000,E,020.0,000.0,010125,,,A",
        "%089/9\r",
    ),
    (
        "GPRMC,120050.00,A,4807.2700,N,01131.0000,E,020.0,000.0,010125,,,A",
        "%104/7\r",
    ),
];

fn a_drive_leads_to_a_fix() -> Digest {
    let config = Config {
        reference: BearingReference::TrueNorth,
        max_speed_m_s: f32::INFINITY,
        ..Config::new(clean::Config::DEFAULT)
    };
    let gateway: Result<Gateway<Clean<100, 32>>, _> = Gateway::new(config);
    let Ok(mut gateway) = gateway else {
        panic!("the configuration is right");
    };
    let mut digest = Digest::new();
    let mut last_is_fix = false;
    for (sentence, bearing) in DRIVE {
        let checksum = sentence.bytes().fold(0, |sum, byte| sum ^ byte);
        let hex =
            [checksum >> 4, checksum & 15].map(|digit| b"0123456789ABCDEF"[usize::from(digit)]);
        let line = b"$"
            .iter()
            .chain(sentence.as_bytes())
            .chain(b"*")
            .chain(&hex)
            .chain(b"\r\n");
        for &byte in line.chain(bearing.as_bytes()) {
            if gateway.push(0, byte).is_some() {
                let report = gateway.vehicle().report();
                digest.add_bytes(report.as_bytes());
                last_is_fix = report.starts_with("$PFOXF");
            }
        }
    }
    assert_eq!(gateway.vehicle().counters().bearings, 6);
    assert!(last_is_fix);
    digest
}
