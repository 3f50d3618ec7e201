use core::fmt::Write;

use foxhunt::aoa::{Clean, Robust, clean, robust};
use foxhunt::gateway::{
    BearingRecord, BearingReference, Config, Event, FullReport, Gateway, formats,
};
use foxhunt::math;

use super::{Case, Digest};

pub const CASES: &[Case] = &[
    ("gateway::a_drive_leads_to_a_fix", a_drive_leads_to_a_fix),
    (
        "gateway::lines_of_every_kind_lead_to_a_fix",
        lines_of_every_kind_lead_to_a_fix,
    ),
];

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

/// A receiver on the first port, finders on the others.
type Hunt = Gateway<Robust<64, 16>, formats::All, FullReport, 3>;

/// A line, or a frame.
type Line = heapless::Vec<u8, 4_096>;

/// With the checksum of a sentence.
pub(super) fn sentence(payload: core::fmt::Arguments<'_>) -> Line {
    let mut text = heapless::String::<128>::new();
    text.write_fmt(payload).expect("a sentence is short");
    let checksum = text.bytes().fold(0, |sum, byte| sum ^ byte);
    let mut line = Line::new();
    write!(line, "${text}*{checksum:02X}\r\n").expect("there is room");
    line
}

/// A position of a u-blox receiver: a tenth of a millisecond after the second.
fn frame(second: u8, latitude_e7: i32, longitude_e7: i32, valid: u8) -> Line {
    let mut frame = [0; 100];
    frame[..6].copy_from_slice(&[0xb5, 0x62, 0x01, 0x07, 92, 0]);
    let mut put = |offset: usize, bytes: &[u8]| {
        let field = frame.get_mut(6 + offset..).unwrap_or_default();
        field
            .iter_mut()
            .zip(bytes)
            .for_each(|(to, from)| *to = *from);
    };
    put(8, &[12, 0, second, valid]);
    put(16, &100_000_i32.to_le_bytes());
    put(20, &[3, 0x21]);
    put(24, &longitude_e7.to_le_bytes());
    put(28, &latitude_e7.to_le_bytes());
    put(60, &20_000_i32.to_le_bytes());
    put(64, &100_000_i32.to_le_bytes());
    put(84, &150_000_i32.to_le_bytes());
    put(88, &(-250_i16).to_le_bytes());
    let sums = frame[2..98].iter().fold([0u8; 2], |[a, b], byte| {
        let a = a.wrapping_add(*byte);
        [a, b.wrapping_add(a)]
    });
    frame[98..].copy_from_slice(&sums);
    Line::from_slice(&frame).expect("there is room")
}

/// What the receiver says at a second, while the vehicle goes north by 20 m.
fn of_receiver(second: u8, latitude_e7: i32) -> Line {
    let minutes = 6 * (latitude_e7 - 480_000_000);
    let (whole, rest) = (minutes / 10_000_000, minutes / 100 % 100_000);
    match second % 6 {
        0 | 3 => frame(second, latitude_e7, 115_166_667, 15),
        1 => sentence(format_args!(
            "GPRMC,1200{second:02}.00,A,48{whole:02}.{rest:05},N,01131.00000,E,38.9,001.2,010125,3.1,W,A"
        )),
        2 => sentence(format_args!(
            "GNGGA,1200{second:02}.00,48{whole:02}.{rest:05},N,01131.00000,E,1,08,0.9,545.4,M,46.9,M,,"
        )),
        4 => sentence(format_args!(
            "GPRMC,1200{second:02},A,48{whole:02}.{rest:05},N,01131.00000,E,38.9,358.8,010125,,,D"
        )),
        // Where it cannot be.
        _ => sentence(format_args!(
            "GPGGA,1200{second:02},4{:03}.00000,N,01131.00000,E,1,08,0.9,545.4,M,46.9,M,,",
            900 + u16::from(second)
        )),
    }
}

/// What a compass says.
fn of_compass(second: u8) -> Line {
    match second % 5 {
        0 => sentence(format_args!("HCHDG,358.5,1.0,E,2.5,W")),
        1 => sentence(format_args!("HCHDM,002.1,M")),
        2 => sentence(format_args!("GPVTG,000.9,T,,M,38.8,N,71.9,K,A")),
        3 => sentence(format_args!("GPTHS,359.4,A")),
        _ => sentence(format_args!("PASHR,1200{second:02}.500,000.4,T")),
    }
}

/// What a finder says of a source so many degrees to the right of the bow: every kind in turn.
fn of_finder(kind: u8, second: u8, degrees: f32) -> Line {
    let mut line = Line::new();
    let (whole, second_ms) = (degrees as u16, 1_000 * u64::from(second));
    // 12:00 UTC of the first of January 2025.
    let time_ms = 1_735_732_800_000 + second_ms + 300;
    let written = match kind % 6 {
        0 => write!(line, "%{whole:03}/{}\r", 5 + second % 5),
        1 => write!(
            line,
            "C{:04}960084{time_ms:015}\r\n",
            (10.0 * degrees) as u16
        ),
        2 => write!(
            line,
            "N0CALL>APRS,WIDE1-1:@1200{second:02}h4806.{:02}N/01131.00E\\088/036/{whole:03}/729\r\n",
            1_079 * u32::from(second) / 1_000
        ),
        3 => write!(
            line,
            "+UUDF:6C1DEBA4241B,-65,{},-65,6,37,\"CCF9579B21AE\",\"\",{second}\r\n",
            i32::from(whole) - if whole > 180 { 360 } else { 0 }
        ),
        // Without a place, and with a spectrum or without.
        4 => writeln!(
            line,
            "{time_ms}, {degrees:.1}, 9.5, -30, 433920000, UCA, 437, fox, None, None, None, nan, GPS, R, R, R, R"
        ),
        _ => {
            let begun = write!(
                line,
                "{time_ms}, {whole}, 9.5, -30, 433920000, UCA, 300, fo,x, 0.0, 0.0, 0.0, 0.0, GPS, R, R, R, R"
            );
            begun
                .and_then(|()| {
                    (0..360_u16).try_for_each(|degree| {
                        let off = math::wrap((f32::from(degree) + degrees).to_radians());
                        let level = 20.0 - 25.0 * off * off + 0.01 * f32::from(second);
                        write!(line, ", {:.2}", if level > 0.0 { level } else { 0.0 })
                    })
                })
                .and_then(|()| line.write_str(" \n"))
        }
    };
    written.expect("there is room");
    line
}

/// Lines that are of no use, each for another reason.
const USELESS: [&[u8]; 8] = [
    b"%400/9\r",
    b"%045/1\r",
    b"$GPHDT,12.0,T*00\r\n",
    b"\0\0nonsense\r\n",
    b"$GPRMC,115",
    b"%045/9999999999999\r",
    b"$GPGSV,1*78\r\n",
    b"$PFOXQ*50\r\n",
];

/// Adds what every line leads to.
fn give(hunt: &mut Hunt, digest: &mut Digest, port: usize, line: &[u8]) -> u32 {
    let mut fixes = 0;
    for &byte in line {
        if let Some(event) = hunt.push(port, byte) {
            let vehicle = hunt.vehicle();
            fixes += u32::from(matches!(event, Event::Fix(_)));
            digest.add_shown(&(event, vehicle.observation(), vehicle.time_ms()));
            digest.add_bytes(vehicle.report().as_bytes());
            digest.add_bytes(vehicle.line(port));
        }
    }
    fixes
}

/// A vehicle goes north past a source, 700 m to its east, that finders of every kind hear.
fn lines_of_every_kind_lead_to_a_fix() -> Digest {
    let mut digest = Digest::new();
    let config = Config {
        report_interval_ms: 0,
        max_age_ms: 3_000,
        ..Config::new(robust::Config::DEFAULT)
    };
    let mut hunt = Hunt::new(config).expect("the configuration is right");
    let mut fixes = 0;
    for second in 0..48_u8 {
        let latitude_e7 = 481_000_000 + 1_798 * i32::from(second);
        let line = of_receiver(second, latitude_e7);
        give(&mut hunt, &mut digest, 0, &line);
        give(&mut hunt, &mut digest, 0, &of_compass(second));
        let ahead = 600.0 - 20.0 * f32::from(second);
        let degrees = math::atan2(700.0, ahead).to_degrees();
        for (port, kind) in [(1, second / 2), (2, second / 2 + 3)] {
            let line = of_finder(kind, second, degrees);
            fixes += give(&mut hunt, &mut digest, port, &line);
        }
        if let Some(line) = USELESS.get(usize::from(second / 4)) {
            give(&mut hunt, &mut digest, usize::from(second % 3), line);
        }
        let record = BearingRecord {
            quality: 90.0,
            ..BearingRecord::new(degrees)
        };
        let config = *hunt.config();
        let event = hunt.vehicle_mut().push_record(2, &record, &config);
        digest.add_shown(&(event, hunt.vehicle().receiver(), hunt.vehicle().place()));
    }
    give(&mut hunt, &mut digest, 0, b"$PFOXQ*50\r\n$PFOXR*53\r\n");
    let vehicle = hunt.vehicle();
    digest.add_shown(&(vehicle.counters(), vehicle.plane()));
    for port in 0..4 {
        digest.add_shown(&vehicle.port_counters(port));
    }
    assert!(
        fixes > 10,
        "{fixes} {:?} {}",
        vehicle.counters(),
        vehicle.report()
    );
    digest
}
