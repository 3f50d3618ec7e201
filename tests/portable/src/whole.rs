//! A whole drive and a whole walk: every report of the gateways of the firmwares.

use foxhunt_gateways::{plain, tunnel};

use super::{Case, Digest};

pub const CASES: &[Case] = &[("whole::drive", drive), ("whole::walk", walk)];

/// The bytes that the vehicle's receiver and direction finder put on the line.
const DRIVE: &[u8] = include_bytes!("../../../examples/data/drive.nmea");

/// What the radios of a tunnel hear.
const WALK: &[u8] = include_bytes!("../../../examples/data/tunnel.packets");

fn drive() -> Digest {
    let mut gateway = plain::Gateway::EMPTY;
    let mut digest = Digest::new();
    let mut fixes = 0;
    for &byte in DRIVE {
        if gateway.push(0, byte, &plain::CONFIG).is_some() {
            digest.add_bytes(gateway.report().as_bytes());
            fixes += u32::from(gateway.report().starts_with("$PFOXF"));
        }
    }
    assert!(fixes > 20);
    digest
}

fn walk() -> Digest {
    let mut gateway = tunnel::Gateway::EMPTY;
    let mut digest = Digest::new();
    let mut fixes = 0;
    for &byte in WALK {
        if gateway.push(byte, &tunnel::LINES).is_some() {
            digest.add_bytes(gateway.report().as_bytes());
            fixes += u32::from(gateway.report().starts_with("$PFOXT"));
        }
    }
    assert!(fixes > 20);
    digest
}
