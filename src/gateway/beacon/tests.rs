//! The whole gateway, on a map made by hand.

extern crate std;
mod kinds;

use super::*;
use crate::fingerprint::Zone;
use crate::fingerprint::tracker::tests::{level, map, map_behind};
use crate::fingerprint::tracker::{self, Building, Passage, Site, State, Storey, Walls};
use crate::fingerprint::{MapError, RadioMap};
use crate::gateway::sentence::checksum;
use crate::snapshot;
use proptest::prelude::*;
use std::{format, string::String, vec::Vec};

/// A gateway and its configuration.
struct Gateway<'a> {
    state: BeaconGateway<2, 100, 64, 4>,
    config: Config<Site<'a>>,
}

fn gateway(map: &[u8], framing: Framing) -> Gateway<'_> {
    let map = RadioMap::new(map).unwrap();
    let site = Site::new(map, tracker::Config::DEFAULT).unwrap();
    Gateway {
        state: BeaconGateway::EMPTY,
        config: Config {
            framing,
            ..Config::new(site)
        },
    }
}

fn sentence(payload: &str) -> String {
    format!("${payload}*{:02X}\r\n", checksum(payload.as_bytes()))
}

fn run(gateway: &mut Gateway<'_>, bytes: &[u8]) -> (Vec<Event>, String) {
    let mut events = Vec::new();
    let mut output = String::new();
    for byte in bytes {
        if let Some(event) = gateway.state.push(*byte, &gateway.config) {
            events.push(event);
            output.push_str(gateway.state.report());
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
    let by_lines = run(&mut gateway(&map, Framing::Lines), lines.as_bytes());
    let by_frames = run(&mut gateway(&map, Framing::Frames), &frames);
    assert_eq!(by_lines, by_frames);
    let (events, output) = by_lines;
    assert!(matches!(events[0], Event::Taken { tag: 7 }));
    assert_eq!(events.last(), Some(&Event::Queried));
    assert!(output.contains("$PFOXT,") && output.contains(",7,"));
    assert!(output.contains("$PFOXS,41,40,0,1,0,0,0,0,0,0,0,0,1,0,0*"));
}

#[test]
fn tags_are_tracked_apart_and_the_silent_one_is_evicted() {
    let map = map(1);
    let mut gateway = gateway(&map, Framing::Lines);
    run(&mut gateway, line(&packet(10, 0, 2)).as_bytes());
    for time in (0..40_000).step_by(500) {
        run(&mut gateway, line(&packet(time, 0, 1)).as_bytes());
        if time < 30_000 {
            let (events, _) = run(&mut gateway, line(&packet(time, 0, 3)).as_bytes());
            assert_eq!(events, [Event::Rejected(Rejected::NoRoom)]);
        }
    }
    run(&mut gateway, line(&packet(40_000, 0, 3)).as_bytes());
    let tags: Vec<u32> = gateway.state.tags().map(|(tag, _)| tag).collect();
    assert_eq!(tags, [3, 1]);
    assert_eq!(gateway.state.counters().evicted, 1);
    run(&mut gateway, sentence("PFOXR").as_bytes());
    assert_eq!(gateway.state.tags().count(), 0);
}

#[test]
fn rejected_with_the_reason() {
    let map = map(1);
    let mut gateway = gateway(&map, Framing::Lines);
    run(&mut gateway, line(&packet(10_000, 0, 1)).as_bytes());
    run(&mut gateway, sentence("PFOXQ").as_bytes());
    for (message, reason) in [
        (sentence("PFOXB,10000,9,1,-60"), Rejected::UnknownRadio),
        (sentence("PFOXB,10000,0,1,42"), Rejected::OutOfRange),
        (sentence("PFOXB,10000,0,1,-200"), Rejected::OutOfRange),
        (sentence("PFOXB,9000,0,1,-60"), Rejected::TooOld),
        (sentence("PFOXB,10000,0,1"), Rejected::Unparsable),
        (
            String::from("$PFOXB,10000,0,1,-60*00\r"),
            Rejected::Checksum,
        ),
        (format!("${}\r", "X".repeat(200)), Rejected::Overlong),
    ] {
        let before = gateway.state.counters().rejected(reason);
        let (events, output) = run(&mut gateway, message.as_bytes());
        assert_eq!(events, [Event::Rejected(reason)], "{message}");
        assert_eq!(gateway.state.counters().rejected(reason), before + 1);
        assert_eq!(output, "");
    }
    assert_eq!(gateway.state.tags().count(), 1);
}

#[test]
fn a_silent_radio_is_reported() {
    let map = map(1);
    let mut gateway = gateway(&map, Framing::Lines);
    let lines: String = (0..60)
        .map(|i| line(&packet(200 * i, (i % 3) as u16, 7)))
        .collect();
    let (_, output) = run(&mut gateway, lines.as_bytes());
    assert_eq!(output.matches("$PFOXL,5200,3,SILENT*").count(), 1);
    assert_eq!(output.matches("$PFOXL").count(), 1);
    let (_, output) = run(&mut gateway, line(&packet(12_000, 3, 7)).as_bytes());
    assert!(output.contains("$PFOXL,12000,3,HEARD*"));
}

/// Two people walk to and fro; one of four radios hangs elsewhere, or its antenna is damaged.
#[test]
fn a_radio_that_was_moved_is_reported_and_the_fixes_stay_right() {
    let map = map(1);
    for (wrong, turned, loss_db) in [
        (None, false, 0.0),
        (Some(2), true, 0.0),
        (Some(2), false, 15.0),
        (Some(0), true, 0.0),
    ] {
        let mut gateway = gateway(&map, Framing::Lines);
        let mut output = String::new();
        let mut rng = Xoshiro128PlusPlus::seed_from_u64(4);
        let mut late = (0.0, 0.0);
        for half in 0..1_200u32 {
            for tag in 0..2 {
                let phase = (half + 60 * tag) % 120;
                let x = 0.5 * (60.0 - (60.0 - phase as f32).abs()) + 5.0;
                for radio in 0..4 {
                    let is_wrong = wrong == Some(radio);
                    let at = if is_wrong && turned { 40.0 - x } else { x };
                    let loss_db = if is_wrong { loss_db } else { 0.0 };
                    let noise = 2.0 * crate::random::normal(&mut rng);
                    let rssi = level(radio, at) - loss_db + noise;
                    let payload = format!("PFOXB,{},{radio},{tag},{rssi:.0}", 500 * half);
                    let (events, said) = run(&mut gateway, sentence(&payload).as_bytes());
                    output += &said;
                    if half > 600
                        && let [Event::Fix { fix, .. }] = events[..]
                    {
                        let off = fix.position_at(500 * half)[0] - x;
                        late = (late.0 + off * off, late.1 + 1.0);
                    }
                }
            }
        }
        let told: Vec<&str> = (output.split("$PFOXL,").skip(1))
            .map(|line| line.split([',', '*']).skip(1).take(2).last().unwrap())
            .collect();
        assert_eq!(told, wrong.map_or(&[][..], |_| &["MOVED"]));
        let rmse = crate::math::sqrt(late.0 / late.1);
        assert!(rmse < 3.0, "{wrong:?} {rmse}");
    }
}

#[test]
fn a_tag_that_takes_the_stairs_is_reported_on_the_other_floor() {
    let losses_db = [[0.0, 0.0, 15.0, 15.0], [15.0, 15.0, 0.0, 0.0]];
    let maps = losses_db.map(|loss_db| map_behind(loss_db, 1));
    let [lowest, above] = maps.each_ref().map(|map| RadioMap::new(map).unwrap());
    let building = Building {
        lowest: Site::new(lowest, tracker::Config::DEFAULT).unwrap(),
        above: &[Storey {
            map: above,
            walls: Walls::None,
        }],
        passages: &[Passage {
            place: Zone {
                id: 0,
                floor: 0,
                corners: &[[15.0, -1.0], [25.0, -1.0], [25.0, 1.0], [15.0, 1.0]],
            },
            floors: &[0, 1],
            seconds: 5.0,
        }],
    };
    let config = Config::new(building);
    config.check().unwrap();
    let mut state = BuildingGateway::<2, 200, 82, 4, 1>::EMPTY;
    let mut told = Vec::new();
    for half in 0..120u32 {
        let floor = usize::from(half >= 60);
        for radio in 0..4 {
            let rssi = level(radio, 20.0) - losses_db[floor][usize::from(radio)];
            let payload = format!("PFOXB,{},{radio},7,{rssi:.0}", 500 * half);
            for byte in sentence(&payload).bytes() {
                if let Some(Event::Fix { .. }) = state.push(byte, &config) {
                    told.push(String::from(state.report()));
                }
            }
        }
    }
    let floor_of = |report: &String| {
        let (fields, _) = report.split_once('*').unwrap();
        let mut fields = fields.rsplit(',');
        let probability: f32 = fields.next().unwrap().parse().unwrap();
        (fields.next().unwrap() == "1", probability)
    };
    let floors: Vec<_> = told.iter().map(floor_of).collect();
    let (before, after) = (&floors[20..50], &floors[floors.len() - 30..]);
    assert!(
        before.iter().all(|(upper, p)| !upper && *p > 0.9),
        "{told:?}"
    );
    assert!(
        after.iter().all(|(upper, p)| *upper && *p > 0.9),
        "{told:?}"
    );
}

#[test]
fn a_survey_has_every_packet_of_the_tag_that_stands_there() {
    let map = map(1);
    let mut gateway = gateway(&map, Framing::Lines);
    let mut said = |message: &str| run(&mut gateway, message.as_bytes());
    let (events, output) = said(&sentence("PFOXV,7,12.5,-0.25,2"));
    let spot = Spot {
        tag: 7,
        place: [12.5, -0.25],
        floor: 2,
    };
    assert_eq!(
        (&events[..], &output[..]),
        (&[Event::Survey(Some(spot))][..], "")
    );
    // A radio that the map lacks, too: there may be no right map yet.
    for radio in [1, 900] {
        let (_, output) = said(&line(&packet(500, radio, 7)));
        let reading = sentence(&format!("PFOXV,12.500,-0.250,2,{radio},-60"));
        assert!(output.starts_with(&reading), "{output}");
    }
    assert_eq!(said(&line(&packet(600, 1, 8))).1, "");
    assert_eq!(said(&sentence("PFOXV")).0, [Event::Survey(None)]);
    assert_eq!(said(&line(&packet(700, 1, 7))).1, "");
    for (fields, reason) in [
        ("7,1,2", Rejected::Unparsable),
        ("7,1,,0", Rejected::Unparsable),
        ("7,1000001,0,0", Rejected::OutOfRange),
        ("7,0,0,256", Rejected::OutOfRange),
        ("-7,0,0,0", Rejected::OutOfRange),
    ] {
        let (events, _) = said(&sentence(&format!("PFOXV,{fields}")));
        assert_eq!(events, [Event::Rejected(reason)], "{fields}");
    }
}

/// Sends the piece of a map that begins at `offset`: the level of the first radio at the first point of the map that is whole
/// then, and the answer.
fn send(
    gateway: &mut Gateway<'_>,
    map: &[u8],
    offset: usize,
    buffer: &mut [u8],
) -> (Result<Option<f32>, NewMapError>, String) {
    let bytes = &map[offset..map.len().min(offset + MapPiece::BYTES)];
    let digits: String = bytes.iter().map(|byte| format!("{byte:02x}")).collect();
    let piece = sentence(&format!("PFOXM,{offset},{},{digits}", map.len()));
    let (events, _) = run(gateway, piece.as_bytes());
    let [Event::MapPiece(piece)] = events[..] else {
        panic!("{events:?}");
    };
    let taken = gateway.state.take_map(&piece, buffer);
    let level = taken.map(|map| map.map(|map| map.moments(0, 0).unwrap().mean_dbm));
    (level, String::from(gateway.state.report()))
}

#[test]
fn a_new_map_is_taken_when_all_of_it_has_come() {
    let (old, new) = (map(1), map_behind([3.0; 4], 1));
    let mut gateway = gateway(&old, Framing::Lines);
    let mut buffer = std::vec![0; 600];
    let offsets: Vec<usize> = (0..new.len()).step_by(MapPiece::BYTES).collect();
    let last = *offsets.last().unwrap();
    for offset in offsets {
        let (map, answer) = send(&mut gateway, &new, offset, &mut buffer);
        let received = (offset + MapPiece::BYTES).min(new.len());
        if offset == last {
            assert_eq!(map, Ok(Some(level(0, 0.0) - 3.0)));
            assert!(answer.starts_with(&format!("$PFOXM,{received},{received},READY*")));
        } else {
            assert_eq!(map, Ok(None));
            assert!(answer.starts_with(&format!("$PFOXM,{received},{},MORE*", new.len())));
            // What does not follow changes nothing, and what should have come is asked for.
            let other = if received == last {
                MapPiece::BYTES
            } else {
                last
            };
            let (again, answer) = send(&mut gateway, &new, other, &mut buffer);
            assert_eq!(again, Err(NewMapError::Order));
            assert!(answer.starts_with(&format!("$PFOXM,{received},")));
        }
    }
}

#[test]
fn a_new_map_that_cannot_be_used_is_refused() {
    let map_of = crate::fingerprint::tracker::tests::map;
    let old = map_of(1);
    let mut gateway = gateway(&old, Framing::Lines);
    let mut damaged = old.clone();
    damaged[100] ^= 1;
    let large = map_of(2);
    for (map, room, reason) in [
        (&damaged, 600, NewMapError::Map(MapError::Checksum)),
        (&large, 2_000, NewMapError::Map(MapError::Points)),
        (&old, 64, NewMapError::Room),
    ] {
        let mut buffer = std::vec![0; room];
        let sent = (0..map.len()).step_by(MapPiece::BYTES);
        let answers = sent.map(|offset| send(&mut gateway, map, offset, &mut buffer));
        let refused: Vec<_> = answers.filter(|(taken, _)| taken.is_err()).collect();
        assert_eq!(refused[0].0, Err(reason));
        assert!(refused[0].1.contains(",REFUSED*"), "{}", refused[0].1);
    }
    for fields in ["0,9,", "0,9,0", "0,9,0g", "0,9", "-1,9,00"] {
        let (events, _) = run(
            &mut gateway,
            sentence(&format!("PFOXM,{fields}")).as_bytes(),
        );
        assert!(matches!(events[..], [Event::Rejected(_)]), "{fields}");
    }
}

#[test]
fn a_plane_does_not_fit_a_line() {
    let (row, plane) = (map(1), map(2));
    let site = Site::new(RadioMap::new(&row).unwrap(), tracker::Config::DEFAULT).unwrap();
    let config = Config::new(site);
    for (map, expected) in [(&row, Ok(true)), (&plane, Err(NewMapError::Axes))] {
        let mut state = BeaconGateway::<2, 100, 128, 4, 1>::EMPTY;
        let mut buffer = std::vec![0; 2_000];
        let mut last = Ok(false);
        for (number, bytes) in map.chunks(MapPiece::BYTES).enumerate() {
            let offset = number * MapPiece::BYTES;
            let digits: String = bytes.iter().map(|byte| format!("{byte:02x}")).collect();
            let piece = sentence(&format!("PFOXM,{offset},{},{digits}", map.len()));
            for byte in piece.bytes() {
                if let Some(Event::MapPiece(piece)) = state.push(byte, &config) {
                    last = state.take_map(&piece, &mut buffer).map(|map| map.is_some());
                }
            }
        }
        assert_eq!(last, expected);
    }
}

#[test]
fn an_uncertain_fix_is_reported_as_such() {
    let map = map(1);
    let mut gateway = gateway(&map, Framing::Lines);
    let lines: String = (0..8)
        .map(|i| line(&packet(250 * i, (i % 4) as u16, 7)))
        .collect();
    let (events, output) = run(&mut gateway, lines.as_bytes());
    let fix = events.iter().find_map(|event| match event {
        Event::Fix { fix, .. } => Some(fix),
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
            let mut gateway = gateway(&map, framing);
            run(&mut gateway, &bytes);
            let whole = match framing {
                Framing::Lines => format!("\r{}", line(&packet(5, 0, 7))).into_bytes(),
                Framing::Frames => [&[0], frame(&packet(5, 0, 7).to_frame()).as_slice()].concat(),
            };
            let (events, _) = run(&mut gateway, &whole);
            prop_assert_eq!(events.last(), Some(&Event::Taken { tag: 7 }));
        }
    }

    #[test]
    fn the_counts_of_the_status_add_up(
        messages in proptest::collection::vec((0..8, any::<u16>()), 0..60)
    ) {
        let map = map(1);
        let mut gateway = gateway(&map, Framing::Lines);
        for (kind, number) in messages {
            let time_ms = 100 * u32::from(number);
            let message = match kind {
                0 => sentence("PFOXQ"),
                1 => sentence("PFOXR"),
                2 => sentence("GPHDT,1,T"),
                3 => format!("$PFOXB,{number}*00\r"),
                4 => format!("{number}\n\r\n"),
                5 => sentence(&format!("PFOXB,{number}")),
                _ => line(&packet(time_ms, number % 5, u32::from(number % 3))),
            };
            run(&mut gateway, message.as_bytes());
        }
        let (_, output) = run(&mut gateway, sentence("PFOXQ").as_bytes());
        let (_, status) = output.rsplit_once("$PFOXS,").unwrap();
        let (counts, _) = status.split_once('*').unwrap();
        let counts: Vec<u32> = counts.split(',').map(|count| count.parse().unwrap()).collect();
        prop_assert_eq!(counts[0], counts[1..12].iter().sum::<u32>(), "{}", status);
    }

    #[test]
    fn a_restored_gateway_goes_on_as_if_nothing_had_happened(
        packets in proptest::collection::vec((0..400u32, 0..4u16, 0..3u32), 0..40)
    ) {
        let map = map(1);
        let mut first = gateway(&map, Framing::Lines);
        let mut time_ms = 0;
        let mut lines = packets.iter().map(|(after, radio, tag)| {
            time_ms += after;
            line(&packet(time_ms, *radio, *tag))
        });
        let before: String = lines.by_ref().take(packets.len() / 2).collect();
        run(&mut first, before.as_bytes());
        let mut buffer = std::vec![0; snapshot::largest::<BeaconGateway<2, 100, 64, 4>>()];
        let bytes = snapshot::save(&first.state, &mut buffer).unwrap();
        let mut second = gateway(&map, Framing::Lines);
        snapshot::restore(&mut second.state, bytes).unwrap();
        let after: String = lines.chain([sentence("PFOXQ")]).collect();
        prop_assert_eq!(run(&mut first, after.as_bytes()), run(&mut second, after.as_bytes()));
    }
}
