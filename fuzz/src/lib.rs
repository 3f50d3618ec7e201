//! What the fuzzers check: no input panics, and a rejected message changes nothing.
//!
//! ```sh
//! cargo xtask fuzz --seconds 600
//! ```

pub mod messages;

use crc::{CRC_32_ISO_HDLC, Crc};
use foxhunt::{
    aoa::{
        Clean, Locate, MultiTarget, Observation, Robust, clean, geodesy::Geodetic, multi, robust,
        spectrum::Spectrum,
    },
    fingerprint::{
        Encoding, Matcher, Posterior, RadioMap, Reading,
        tracker::{self, Site, Tracker, Workspace},
    },
    gateway::{
        Config, Event, FullReport, Gateway, Station, Vehicle, beacon,
        formats::{All, Finder, Formats, Kraken, Nmea},
    },
    random::{SeedableRng, Xoshiro128PlusPlus},
    snapshot::{Persist, largest},
};

/// A receiver's first words, so that bearings have a place, a time and a heading.
const START: [&str; 2] = [
    "GPRMC,115959,A,4807.038,N,01131.000,E,50.0,090.0,221126,,,A",
    "GPRMC,120000,A,4807.038,N,01131.000,E,50.0,090.0,221126,,,A",
];

/// The most lines of one input: a vehicle with few particles works on so many in a moment.
const LINES: usize = 64;

/// Adds the frame and the checksum of NMEA.
fn sentence(payload: &[u8]) -> Vec<u8> {
    let sum = payload.iter().fold(0, |sum, byte| sum ^ byte);
    [
        b"$".as_slice(),
        payload,
        format!("*{sum:02X}\r\n").as_bytes(),
    ]
    .concat()
}

/// Gives a vehicle's gateway lines made from those of `data`.
pub fn vehicle(data: &[u8], line: impl Fn(&[u8]) -> Vec<u8>) {
    told(Config::new(clean::Config::DEFAULT), data, line);
}

fn told(config: Config<clean::Config>, data: &[u8], line: impl Fn(&[u8]) -> Vec<u8>) {
    lines::<Clean<24, 8>, All>(config, data, line, |locator| {
        locator.observations().copied().collect()
    });
}

/// Gives gateways lines of a direction finder, whose name is the first line of `data`; any other text there is that of one,
/// too. Of every other line the first byte says with how much of the finder's example it begins. Once with the receiver's
/// place and heading, which the times of few lines meet; once with a told one.
pub fn finder(data: &[u8]) {
    let mut parts = data.splitn(2, |byte| *byte == b'\n');
    let [name, lines] = [(); 2].map(|()| parts.next().unwrap_or_default());
    let sum: usize = name.iter().map(|byte| usize::from(*byte)).sum();
    let mut all = Finder::ALL.iter();
    let finder = match all.find(|finder| finder.name().as_bytes() == name) {
        Some(finder) => *finder,
        None => Finder::ALL[sum % Finder::ALL.len()],
    };
    let place = Geodetic::new(481_173_000, 115_166_667).expect("it is on earth");
    let station = Station {
        place,
        heading_deg: 90.0,
    };
    for station in [None, Some(station)] {
        let mut config = Config {
            station,
            ..Config::new(clean::Config::DEFAULT)
        };
        config.formats.finder = Some(finder);
        told(config, lines, |text| {
            let (kept, text) = text.split_first().unwrap_or((&0, text));
            of_finder(finder.example().as_bytes(), usize::from(*kept), text)
        });
    }
}

/// A line of so many bytes of an example and a text; and the example with the text in it, so that the length is right, with
/// a right checksum if it ends with one.
fn of_finder(example: &[u8], kept: usize, text: &[u8]) -> Vec<u8> {
    let begun = example.get(..kept).unwrap_or(example);
    let cut = [begun, text].concat();
    let whole = [&cut, example.get(cut.len()..).unwrap_or_default()].concat();
    let whole = match (example, whole.as_slice()) {
        ([.., b'*', _, _], [first, payload @ .., _, _, _]) => {
            let mut line = sentence(payload);
            line[0] = *first;
            line
        }
        _ => [&whole, b"\r\n".as_slice()].concat(),
    };
    [&cut, b"\r\n".as_slice(), &whole].concat()
}

/// Gives a gateway that reads the spectra of a KrakenSDR lines made from those of `data`.
pub fn spectra(data: &[u8], line: impl Fn(&[u8]) -> Vec<u8>) {
    let config = Config::new(robust::Config::DEFAULT);
    lines::<Robust<24, 8>, (Nmea, Kraken<Spectrum>)>(config, data, line, |locator| {
        locator.observations().copied().collect()
    });
}

fn lines<L: Locate, F: Formats>(
    config: Config<L::Config>,
    data: &[u8],
    line: impl Fn(&[u8]) -> Vec<u8>,
    observations: impl Fn(&L) -> Vec<Observation>,
) {
    let mut gateway: Box<Gateway<L, F, FullReport>> =
        Box::new(Gateway::new(config).expect("it is right"));
    let push = |gateway: &mut Gateway<L, F, FullReport>, bytes: &[u8]| -> Vec<Event> {
        let events = bytes.iter().filter_map(|byte| gateway.push(0, *byte));
        events.collect()
    };
    for payload in START {
        push(&mut gateway, &sentence(payload.as_bytes()));
    }
    for text in data.split(|byte| *byte == b'\n').take(LINES) {
        let state = |gateway: &Gateway<L, F, FullReport>| {
            let locator = gateway.vehicle().locator();
            let bearings = gateway.vehicle().counters().bearings;
            (locator.answer(), observations(locator), bearings)
        };
        let before = state(&gateway);
        let events = push(&mut gateway, &line(text));
        let idle = |event: &Event| {
            matches!(
                event,
                Event::Used | Event::Rejected(_) | Event::Queried | Event::Other
            )
        };
        if events.iter().all(idle) {
            assert_eq!(state(&gateway), before, "{events:?}");
        }
        assert!(gateway.vehicle().report().len() <= FullReport::BYTES);
    }
}

/// A KrakenSDR's line of which the spectrum is made of a text's bytes, over and over; and one that ends as the text says.
pub fn kraken(text: &[u8]) -> Vec<u8> {
    const FIELDS: &str =
        "1795348800000, 45, 80, -30, 1, UCA, 0, fox, 0.0, 0.0, 0, 0, GPS, R, R, R, R";
    let bytes = text.iter().chain(&[0]).cycle().take(360);
    let values: String = bytes
        .map(|byte| format!(", {}.{}", byte / 4, byte % 4))
        .collect();
    let mut cut = values.clone().into_bytes();
    cut.truncate(cut.len().saturating_sub(text.len()));
    let lines = [
        FIELDS.as_bytes(),
        values.as_bytes(),
        b"\n",
        FIELDS.as_bytes(),
        &cut,
        text,
        b"\n",
    ];
    lines.concat()
}

/// A sentence of NMEA with a right checksum, and one with any checksum.
pub fn nmea(text: &[u8]) -> Vec<u8> {
    [sentence(text), text.to_vec(), b"\r\n".to_vec()].concat()
}

/// A frame of UBX with a right checksum, a `NAV-PVT` of the text's bytes, a sentence, and the text itself.
pub fn ubx(text: &[u8]) -> Vec<u8> {
    let (header, payload) = text.split_at(text.len().min(2));
    let other = match header {
        [class, identifier] => framed(*class, *identifier, payload),
        _ => Vec::new(),
    };
    // A good fix in space at a valid time, unless the text says otherwise.
    let mut pvt = [0; 92];
    pvt[11] = 0x0f;
    pvt[20..22].copy_from_slice(&[3, 0x21]);
    for (byte, said) in pvt.iter_mut().zip(text) {
        *byte ^= said;
    }
    let pvt = framed(1, 7, &pvt);
    [
        other,
        pvt,
        sentence(b"HEHDT,90.0,T"),
        text.to_vec(),
        b"\r\n".to_vec(),
    ]
    .concat()
}

fn framed(class: u8, identifier: u8, payload: &[u8]) -> Vec<u8> {
    let mut frame = vec![0xb5, 0x62, class, identifier];
    frame.extend((payload.len() as u16).to_le_bytes());
    frame.extend(payload);
    let mut sums = [0u8; 2];
    for byte in &frame[2..] {
        sums[0] = sums[0].wrapping_add(*byte);
        sums[1] = sums[1].wrapping_add(sums[0]);
    }
    frame.extend(sums);
    frame
}

/// A map of three points and two beacons.
fn small_map() -> Vec<u8> {
    let mut bytes = b"FXRM\x02\x01\x02\x00\x03\x00\x01\x00".to_vec();
    for number in [0.0f32, 0.0, 1.0] {
        bytes.extend(number.to_le_bytes());
    }
    bytes.extend([0; 10]);
    bytes.extend(1.0f32.to_le_bytes());
    bytes.extend([0, 0, 0, 0, 16, 0]);
    for beacon in 0..2u8 {
        bytes.extend([beacon, 0, 0, 0, 255, -90i8 as u8]);
    }
    bytes.push(0b111);
    bytes.extend([8, 100, 8, 120, 12, 130, 4, 130, 63, 120, 1, 100]);
    sealed(bytes)
}

fn sealed(mut bytes: Vec<u8>) -> Vec<u8> {
    let sum = Crc::<u32>::new(&CRC_32_ISO_HDLC).checksum(&bytes);
    bytes.extend(sum.to_le_bytes());
    bytes
}

/// Gives a tunnel's gateway messages made from `data`.
pub fn beacons(framing: beacon::Framing, data: &[u8], message: impl Fn(&[u8]) -> Vec<u8>) {
    let map = small_map();
    let map = RadioMap::new(&map).expect("the map is right");
    let site = Site::new(map, tracker::Config::DEFAULT).expect("it holds moments");
    let config = beacon::Config {
        framing,
        ..beacon::Config::new(site)
    };
    let mut gateway = Box::new(beacon::BeaconGateway::<2, 24, 4, 2>::EMPTY);
    for text in data.split(|byte| *byte == b'\n').take(LINES) {
        let state = |gateway: &beacon::BeaconGateway<2, 24, 4, 2>| {
            let tags = gateway.tags().map(|(tag, tracker)| (tag, tracker.fix()));
            (tags.collect::<Vec<_>>(), gateway.counters().packets)
        };
        let before = state(&gateway);
        let mut events = Vec::new();
        for byte in message(text) {
            events.extend(gateway.push(byte, &config));
            assert!(gateway.report().len() <= 2560);
        }
        let rejected = |event: &beacon::Event| matches!(event, beacon::Event::Rejected(_));
        if events.iter().all(rejected) {
            assert_eq!(state(&gateway), before, "{events:?}");
        }
    }
}

/// A packet's sentence with a right checksum, and one with any checksum.
pub fn beacon_line(text: &[u8]) -> Vec<u8> {
    [
        sentence(&[b"PFOXB,", text].concat()),
        text.to_vec(),
        b"\r\n".to_vec(),
    ]
    .concat()
}

/// A frame with a right checksum, and one with any checksum.
pub fn beacon_frame(text: &[u8]) -> Vec<u8> {
    let content = sealed([b"\xb1", text].concat());
    let mut frame = vec![0; cobs::max_encoding_length(content.len()) + 1];
    let length = cobs::encode(&content, &mut frame);
    frame.truncate(length + 1);
    [&[0], frame.as_slice(), text, &[0]].concat()
}

/// Opens a map of any bytes, with a right checksum, and asks it everything.
pub fn radio_map(data: &[u8]) {
    let _ = RadioMap::new(data);
    let bytes = sealed([b"FXRM\x02", data].concat());
    let Ok(map) = RadioMap::new(&bytes) else {
        return;
    };
    let Ok(map) = map.limited(1024, 64) else {
        return;
    };
    for beacon in 0..=map.beacons() {
        map.beacon(beacon);
        for point in [0, 1, map.lattice().points(), usize::MAX] {
            map.moments(beacon, point);
            map.log_density(beacon, -60.0, point);
        }
    }
    let config = foxhunt::fingerprint::Config::DEFAULT;
    let scan = [-60.0, 0.0, -128.0].map(|rssi_dbm| Reading {
        beacon: 0,
        rssi_dbm,
    });
    let mut posterior = Box::new(Posterior::<1024>::EMPTY);
    if let Ok(matcher) = Matcher::new(map, &config) {
        let _ = matcher.locate(&scan, &mut posterior);
    }
    let site = Site::new(map, tracker::Config::DEFAULT);
    assert_eq!(map.encoding() == Encoding::Moments, site.is_ok());
    if let Ok(site) = site {
        let mut workspace = Box::new(Workspace::<24, 1024>::EMPTY);
        let mut tracker = Tracker::<24, 64>::EMPTY;
        let mut rng = Xoshiro128PlusPlus::seed_from_u64(1);
        for time_ms in [0, 500, 1_000] {
            for beacon in [0, 1, 0] {
                let rssi_dbm = -60.0;
                let packet = Reading { beacon, rssi_dbm };
                let _ = tracker.push(time_ms, packet, &site, &mut workspace, &mut rng);
            }
            if let Some(fix) = tracker.flush(&site, &mut workspace, &mut rng) {
                assert!(fix.position.iter().all(|x| x.is_finite()), "{fix:?}");
            }
        }
    }
}

/// Gives gateways snapshots made from `data`.
pub fn snapshot(data: &[u8]) {
    let Some((which, data)) = data.split_first() else {
        return;
    };
    match which % 3 {
        0 => forged::<Clean<12, 6>>(clean::Config::DEFAULT, data),
        1 => forged::<Robust<12, 6>>(robust::Config::DEFAULT, data),
        _ => {
            let config = multi::Config::new(robust::Config::DEFAULT);
            forged::<MultiTarget<2, Robust<12, 6>, 6>>(config, data);
        }
    }
}

/// Restores a snapshot of a drive with some of its bytes replaced: by every three of `data`, a place and what stands there.
fn forged<L: Locate + Persist>(locator: L::Config, data: &[u8]) {
    let config = Config::new(locator);
    let new = || Box::new(Vehicle::<L, All, FullReport>::EMPTY);
    let saved = |vehicle: &Vehicle<L, All, FullReport>| {
        let mut buffer = vec![0; largest::<Vehicle<L, All, FullReport>>()];
        let bytes = vehicle.snapshot(&mut buffer);
        bytes.expect("the buffer is large enough").to_vec()
    };
    let mut driven = new();
    let drive = |vehicle: &mut Vehicle<L, All, FullReport>, seconds: std::ops::Range<u32>| {
        for second in seconds {
            let time = format!("GPRMC,1200{second:02},A,4807.038,N,01131.{second:02}");
            let place = sentence(format!("{time},E,50.0,090.0,221126,,,A").as_bytes());
            let bearing = format!("%{:03}/8\r", 300 - 4 * second);
            for byte in place.iter().chain(bearing.as_bytes()) {
                vehicle.push(0, *byte, &config);
            }
        }
    };
    drive(&mut driven, 0..12);

    let mut vehicle = new();
    let before = saved(&vehicle);
    assert!(vehicle.restore(data).is_err() || data.starts_with(&saved(&vehicle)));
    let mut bytes = saved(&driven);
    bytes.truncate(bytes.len() - 4);
    let (changes, _) = data.as_chunks();
    for [low, high, value] in changes {
        // The header is checked by the tests: a wrong one would end everything here.
        let place = 16 + usize::from(u16::from_le_bytes([*low, *high]));
        if let Some(byte) = bytes.get_mut(place) {
            *byte = *value;
        }
    }
    let bytes = sealed(bytes);
    if vehicle.restore(&bytes).is_err() {
        assert_eq!(saved(&vehicle), before);
        return;
    }
    // Every restored state can be saved and restored again.
    for seconds in [12..20, 20..24] {
        let bytes = saved(&vehicle);
        let mut again = new();
        again.restore(&bytes).expect("it was saved");
        assert_eq!(saved(&again), bytes);
        drive(&mut vehicle, seconds);
    }
}
