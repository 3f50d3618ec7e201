//! Frames, alone and among sentences.

extern crate std;
use super::*;
use crate::gateway::formats::{Agrelo, Config, Nmea};
use crate::gateway::line::LineReader;
use std::{vec, vec::Vec};

/// As others have packed it by the interface description, with its values.
const PUBLISHED: [u8; 100] = [
    0xB5, 0x62, 0x01, 0x07, 0x5C, 0x00, 0x64, 0x9E, 0x2C, 0x17, 0xEA, 0x07, 0x09, 0x18, 0x0B, 0x3B,
    0x2A, 0x07, 0x19, 0x00, 0x00, 0x00, 0xF3, 0xE0, 0xF5, 0x05, 0x03, 0x01, 0xE0, 0x0E, 0x40, 0x07,
    0x8D, 0x0E, 0x87, 0xEA, 0xBA, 0x1B, 0xB9, 0x4A, 0x06, 0x00, 0xDF, 0xBE, 0x05, 0x00, 0xD2, 0x04,
    0x00, 0x00, 0x29, 0x09, 0x00, 0x00, 0x2E, 0xFB, 0xFF, 0xFF, 0xA0, 0x5B, 0x00, 0x00, 0xF4, 0xFF,
    0xFF, 0xFF, 0xC0, 0x5B, 0x00, 0x00, 0xF2, 0xEC, 0x8D, 0x00, 0x96, 0x00, 0x00, 0x00, 0xEA, 0x49,
    0x08, 0x00, 0x84, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0xF2, 0xEC, 0x8D, 0x00, 0x00, 0x00,
    0x00, 0x00, 0x3E, 0x65,
];

/// Of a receiver, as a driver of Zephyr is tested with it.
const RECEIVED: [u8; 100] = [
    0xB5, 0x62, 0x01, 0x07, 0x5C, 0x00, 0x58, 0xF9, 0x28, 0x08, 0xE6, 0x07, 0x02, 0x15, 0x0E, 0x01,
    0x19, 0x37, 0x1F, 0x00, 0x00, 0x00, 0xCA, 0x3A, 0xFA, 0xFF, 0x03, 0x01, 0xFA, 0x0E, 0x5C, 0xF2,
    0x29, 0x06, 0xFC, 0x29, 0xC6, 0x25, 0x38, 0x0E, 0x03, 0x00, 0xBA, 0x71, 0x02, 0x00, 0xEC, 0x0A,
    0x00, 0x00, 0x6B, 0x15, 0x00, 0x00, 0xF1, 0xFF, 0xFF, 0xFF, 0xFC, 0xFF, 0xFF, 0xFF, 0x0D, 0x00,
    0x00, 0x00, 0x0F, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x97, 0x01, 0x00, 0x00, 0x72, 0xD0,
    0xE0, 0x00, 0xAD, 0x00, 0x00, 0x00, 0xD2, 0x7A, 0x5B, 0x21, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00,
    0x00, 0x00, 0x1B, 0x8A,
];

/// An acknowledgement, as the integration manual of the SAM-M10Q prints it.
const ACKNOWLEDGED: [u8; 10] = [0xB5, 0x62, 0x05, 0x01, 0x02, 0x00, 0x06, 0x41, 0x4F, 0x78];

const SENTENCE: &[u8] = b"$GPHDT,274.07,T*03\r\n";

type Formats = (Nmea, Ubx, Agrelo);

/// What bytes on one port say.
fn read(bytes: &[u8]) -> Vec<Result<Sentence, Rejected>> {
    let mut reader = LineReader::<Formats>::EMPTY;
    let mut said = Vec::new();
    for byte in bytes {
        if let Some(ended) = reader.push(*byte) {
            said.push(ended.and_then(|()| reader.parse(&Config::DEFAULT)));
        }
    }
    said
}

fn used(bytes: &[u8]) -> usize {
    let is_used = |said: &Result<Sentence, Rejected>| matches!(said, Ok(Sentence::Statement(_)));
    read(bytes).iter().filter(|said| is_used(said)).count()
}

fn statement(frame: &[u8]) -> Statement {
    match read(frame)[..] {
        [Ok(Sentence::Statement(stated))] => stated,
        ref other => panic!("{other:?}"),
    }
}

/// With a byte of the payload changed, and the checksum with it.
fn changed(changes: &[(usize, u8)]) -> Vec<u8> {
    let mut payload = PUBLISHED[6..98].to_vec();
    for (offset, byte) in changes {
        payload[*offset] = *byte;
    }
    framed(1, 7, &payload)
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

#[test]
fn reads_a_position_with_time_and_motion() {
    let stated = statement(&PUBLISHED);
    let time = TimeOfDay::from_nmea(b"115942.100");
    assert_eq!(stated.time, time);
    assert_eq!(
        stated.place,
        Some(Geodetic::new(465_234_567, 244_123_456).unwrap())
    );
    let motion = stated.motion.unwrap();
    assert_eq!((motion.course, motion.speed), (Some(93.012_34), 23.488));
    assert_eq!((stated.heading, stated.variation), (None, None));

    let stated = statement(&RECEIVED);
    // A little before the second that it states.
    assert_eq!(stated.time, TimeOfDay::from_nmea(b"140125.000"));
    assert_eq!(stated.motion.unwrap().speed, 0.015);
}

#[test]
fn reads_heading_and_variation_where_they_are_valid() {
    // 45 degrees; 4.5 degrees to the west.
    let heading = 4_500_000i32.to_le_bytes();
    let variation = (-450i16).to_le_bytes();
    let mut changes = vec![(88, variation[0]), (89, variation[1])];
    changes.extend((84..88).zip(heading));
    let stated = statement(&changed(&changes));
    assert_eq!((stated.heading, stated.variation), (None, None));
    changes.extend([(11, 0x0f), (21, 0x21)]);
    let stated = statement(&changed(&changes));
    let heading = stated.heading.unwrap();
    assert_eq!((heading.degrees, heading.is_magnetic), (45.0, false));
    assert!((stated.variation.unwrap() + 4.5).abs() < 1e-6);
    // Before protocol 15 there was neither.
    let short = framed(1, 7, &changed(&changes)[6..90]);
    let stated = statement(&short);
    assert_eq!((stated.heading, stated.variation), (None, None));
}

#[test]
fn refuses_what_is_no_position() {
    let time = TimeOfDay::from_nmea(b"115942.100");
    for (changes, expected) in [
        (&[(20, 0)], Sentence::NoFix(time)),
        (&[(20, 5)], Sentence::NoFix(time)),
        (&[(21, 0)], Sentence::NoFix(time)),
        (&[(78, 1)], Sentence::NoFix(time)),
        (&[(11, 1)], Sentence::Lost(Rejected::NoFix)),
        (&[(8, 24)], Sentence::Lost(Rejected::NoFix)),
        (&[(31, 0x7f)], Sentence::Lost(Rejected::OutOfRange)),
    ] {
        assert_eq!(read(&changed(changes)), [Ok(expected)], "{changes:?}");
    }
    let mut zero = vec![];
    zero.extend((24..32).map(|offset| (offset, 0)));
    let null = Sentence::Lost(Rejected::NullPosition);
    assert_eq!(read(&changed(&zero)), [Ok(null)]);
    assert_eq!(read(&framed(1, 7, &[0; 40])), [Err(Rejected::Unparsable)]);
    let mut wrong = PUBLISHED;
    wrong[99] ^= 1;
    assert_eq!(read(&wrong), [Ok(Sentence::Lost(Rejected::Checksum))]);
}

#[test]
fn other_frames_are_for_others() {
    let long = framed(2, 0x15, &[b'$'; 2_000]);
    for frame in [&ACKNOWLEDGED[..], &long, &framed(0x0a, 4, b"\r\n%045/7\r")] {
        let bytes = [frame, SENTENCE, &PUBLISHED].concat();
        let said = read(&bytes);
        assert_eq!(said.len(), 3);
        assert_eq!(said[0], Ok(Sentence::Other));
        assert_eq!(used(&bytes), 2);
    }
}

#[test]
fn frames_are_followed_up_to_4096_bytes() {
    let longest = framed(2, 0x15, &[7; 4_088]);
    assert_eq!(longest.len(), 4_096);
    let said = read(&[&longest, SENTENCE].concat());
    assert_eq!(said[0], Ok(Sentence::Other));
    let longer = framed(2, 0x15, &[7; 4_089]);
    let said = read(&[&longer, SENTENCE].concat());
    assert_eq!(said[0], Err(Rejected::Unparsable));
    assert_eq!(used(&[&longer, SENTENCE].concat()), 1);
}

#[test]
fn sentences_and_frames_take_turns_on_one_port() {
    let bytes = [
        SENTENCE,
        &PUBLISHED,
        SENTENCE,
        &RECEIVED,
        &ACKNOWLEDGED,
        SENTENCE,
    ]
    .concat();
    assert_eq!(used(&bytes.repeat(9)), 5 * 9);
    // A sentence that lost its end.
    let cut = [&SENTENCE[..12], &PUBLISHED, SENTENCE].concat();
    assert_eq!(used(&cut), 2);
    // What begins as a frame goes on is none by itself.
    let said = read(&[&PUBLISHED, &b"b\r\n"[..], SENTENCE].concat());
    assert!(matches!(
        said[..],
        [Ok(_), Err(Rejected::Unparsable), Ok(Sentence::Statement(_))]
    ));
    // A line of a direction finder after a frame.
    let bearing = [&PUBLISHED[..], b"%045/7\r"].concat();
    assert!(matches!(read(&bearing)[1], Ok(Sentence::Reading(_))));
}

#[test]
fn a_query_is_heard_in_a_frame_that_lost_its_end() {
    // What follows looks like a length of 2,562.
    let bytes = [&ACKNOWLEDGED[..5], b"\n$PFOXQ*50\r\n"].concat();
    let said = read(&bytes);
    assert_eq!(said, [Err(Rejected::Checksum), Ok(Sentence::Query)]);
}

#[test]
fn a_damaged_frame_costs_no_sentence_and_no_other_frame() {
    let long = framed(1, 0x35, &[7; 1_000]);
    for frame in [&PUBLISHED[..], &long, &ACKNOWLEDGED] {
        let own = usize::from(frame.len() == 100);
        for lost in 1..frame.len() {
            // So many bytes are lost at the end, or from the middle, or one byte is wrong.
            let cut = &frame[..frame.len() - lost];
            let gap = [
                &frame[..frame.len() - lost],
                &frame[frame.len() - lost / 2..],
            ]
            .concat();
            let mut wrong = frame.to_vec();
            wrong[lost] ^= 0x20;
            for damaged in [cut, &gap, &wrong] {
                let bytes = [damaged, SENTENCE, SENTENCE, &PUBLISHED, SENTENCE].concat();
                assert_eq!(used(&bytes), 4, "{lost} of {}", frame.len());
                let frames = [damaged, &PUBLISHED, &PUBLISHED].concat();
                let found = used(&frames);
                assert!((2..=2 + own).contains(&found), "{lost} of {}", frame.len());
            }
        }
    }
}
