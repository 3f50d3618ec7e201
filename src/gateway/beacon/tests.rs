//! The whole gateway, on a map made by hand.

extern crate std;
use super::*;
use crate::fingerprint::tracker::{Settings as Tracking, State};
use crate::fingerprint::{RadioMap, tracker::tests::map};
use crate::gateway::sentence::checksum;
use proptest::prelude::*;
use std::{format, string::String, vec::Vec};

type Gateway<'a> = BeaconGateway<'a, 2, 100, 64, 4>;

fn gateway(map: &[u8], settings: Settings) -> Gateway<'_> {
    let map = RadioMap::new(map).unwrap();
    Gateway::new(Site::new(map, Tracking::new()).unwrap(), settings)
}

fn sentence(payload: &str) -> String {
    format!("${payload}*{:02X}\r\n", checksum(payload.as_bytes()))
}

fn run(gateway: &mut Gateway<'_>, bytes: &[u8]) -> (Vec<Event>, String) {
    let mut events = Vec::new();
    let mut output = String::new();
    for byte in bytes {
        if let Some(event) = gateway.push(*byte) {
            events.push(event);
            output.push_str(gateway.report());
        }
    }
    (events, output)
}

fn packet(time_ms: u32, radio: u16, tag: u32) -> Packet {
    Packet {
        time_ms,
        radio,
        tag,
        rssi_dbm: -60,
    }
}

fn line(packet: &Packet) -> String {
    let Packet {
        time_ms,
        radio,
        tag,
        rssi_dbm,
    } = packet;
    sentence(&format!("PFOXB,{time_ms},{radio},{tag},{rssi_dbm}"))
}

fn frame(content: &[u8]) -> Vec<u8> {
    let mut bytes = [0; 32];
    let length = cobs::encode(content, &mut bytes);
    bytes[..=length].to_vec()
}

#[test]
fn both_framings_give_the_same_answers() {
    let map = map(1);
    let packets: Vec<Packet> = (0..40)
        .map(|i| packet(200 * i, (i % 4) as u16, 7))
        .collect();
    let mut lines: String = packets.iter().map(line).collect();
    lines += &sentence("PFOXQ");
    let mut frames: Vec<u8> = packets
        .iter()
        .flat_map(|packet| frame(&packet.to_frame()))
        .collect();
    frames.extend(frame(b"Q"));
    let by_lines = run(&mut gateway(&map, Settings::new()), lines.as_bytes());
    let settings = Settings::new().with_framing(Framing::Frames);
    assert_eq!(by_lines, run(&mut gateway(&map, settings), &frames));
    let (events, output) = by_lines;
    assert!(matches!(events[0], Event::Taken(Tag(7))));
    assert_eq!(events.last(), Some(&Event::Queried));
    assert!(output.contains("$PFOXT,") && output.contains(",7,"));
    assert!(output.contains("$PFOXS,41,40,1,0,0,0,0,"));
}

#[test]
fn tags_are_tracked_apart_and_the_silent_one_is_evicted() {
    let map = map(1);
    let mut gateway = gateway(&map, Settings::new());
    for (time, tag) in [(0, 1), (10, 2), (20, 1), (30, 3)] {
        run(&mut gateway, line(&packet(time, 0, tag)).as_bytes());
    }
    let tags: Vec<u32> = gateway.tags().map(|(tag, _)| tag.0).collect();
    assert_eq!(tags, [1, 3]);
    assert_eq!(gateway.counters().evicted, 1);
    run(&mut gateway, sentence("PFOXR").as_bytes());
    assert_eq!(gateway.tags().count(), 0);
}

#[test]
fn rejected_with_the_reason() {
    let map = map(1);
    let mut gateway = gateway(&map, Settings::new());
    run(&mut gateway, line(&packet(10_000, 0, 1)).as_bytes());
    run(&mut gateway, sentence("PFOXQ").as_bytes());
    for (message, reason) in [
        (sentence("PFOXB,10000,9,1,-60"), Rejected::UnknownRadio),
        (sentence("PFOXB,10000,0,1,42"), Rejected::OutOfRange),
        (sentence("PFOXB,10000,0,1,-200"), Rejected::OutOfRange),
        (sentence("PFOXB,9000,0,1,-60"), Rejected::TimeBackwards),
        (sentence("PFOXB,10000,0,1"), Rejected::Unparsable),
        (
            String::from("$PFOXB,10000,0,1,-60*00\r"),
            Rejected::Checksum,
        ),
        (format!("${}\r", "x".repeat(200)), Rejected::Overlong),
    ] {
        let before = gateway.counters().rejected(reason);
        let (events, output) = run(&mut gateway, message.as_bytes());
        assert_eq!(events, [Event::Rejected(reason)], "{message}");
        assert_eq!(gateway.counters().rejected(reason), before + 1);
        assert_eq!(output, "");
    }
    assert_eq!(gateway.tags().count(), 1);
}

#[test]
fn a_dead_radio_is_reported() {
    let map = map(1);
    let mut gateway = gateway(&map, Settings::new());
    let lines: String = (0..60)
        .map(|i| line(&packet(200 * i, (i % 3) as u16, 7)))
        .collect();
    let (_, output) = run(&mut gateway, lines.as_bytes());
    assert_eq!(output.matches("$PFOXL,5200,3,SILENT*").count(), 1);
    assert_eq!(output.matches("$PFOXL").count(), 1);
    let (_, output) = run(&mut gateway, line(&packet(12_000, 3, 7)).as_bytes());
    assert!(output.contains("$PFOXL,12000,3,HEARD*"));
}

#[test]
fn the_state_is_told() {
    let map = map(1);
    let mut gateway = gateway(&map, Settings::new());
    let lines: String = (0..8)
        .map(|i| line(&packet(250 * i, (i % 4) as u16, 7)))
        .collect();
    let (events, output) = run(&mut gateway, lines.as_bytes());
    let fix = events.iter().find_map(|event| match event {
        Event::Fix(_, fix) => Some(fix),
        _ => None,
    });
    let uncertain = fix.is_some_and(|fix| fix.state == State::Uncertain);
    assert_eq!(uncertain, output.contains("UNCERTAIN"));
}

proptest! {
    #[test]
    fn any_bytes_leave_a_gateway_that_works(bytes in proptest::collection::vec(any::<u8>(), 0..300)) {
        let map = map(1);
        for framing in [Framing::Lines, Framing::Frames] {
            let mut gateway = gateway(&map, Settings::new().with_framing(framing));
            run(&mut gateway, &bytes);
            let whole = match framing {
                Framing::Lines => format!("\r{}", line(&packet(5, 0, 7))).into_bytes(),
                Framing::Frames => [&[0], frame(&packet(5, 0, 7).to_frame()).as_slice()].concat(),
            };
            let (events, _) = run(&mut gateway, &whole);
            prop_assert_eq!(events.last(), Some(&Event::Taken(Tag(7))));
        }
    }
}
