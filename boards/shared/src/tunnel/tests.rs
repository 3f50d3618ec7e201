extern crate std;

use std::{format, string::String, vec::Vec};

use foxhunt::fingerprint::{RadioMap, tracker::Site};
use foxhunt::snapshot;
use foxhunt_gateways::corridor::{self, Gateway};

use super::*;

const MAP: &[u8] = include_bytes!("../../../../examples/data/tunnel.map");
const PACKETS: &str = include_str!("../../../../examples/data/tunnel.packets");
const QUERY: &[u8] = b"$PFOXQ*50\r\n";

std::thread_local! {
    /// The time at which the packet arrives that is being pushed: each test has its own.
    static NOW_MS: core::cell::Cell<u32> = const { core::cell::Cell::new(0) };
}

fn now_ms() -> u32 {
    NOW_MS.get()
}

fn set_now_ms(time_ms: u32) {
    NOW_MS.set(time_ms);
}

/// The packets of the recorded walk.
fn packets() -> impl Iterator<Item = Packet> {
    PACKETS.lines().filter_map(|line| {
        let fields = line.strip_prefix("$PFOXB,")?.split(['*', ',']);
        let fields: Vec<i64> = fields.map_while(|field| field.parse().ok()).collect();
        Some(Packet {
            time_ms: fields[0] as u32,
            radio: fields[1] as u16,
            tag: fields[2] as u32,
            rssi_dbm: fields[3] as i8,
        })
    })
}

fn config() -> Config<Site<'static>> {
    Config::new(Site::new(RadioMap::new(MAP).unwrap(), corridor::WALKS).unwrap())
}

/// Pushes bytes of a port, and collects the reports.
fn push<A: Application>(application: &mut A, port: usize, bytes: &[u8], reports: &mut String) {
    for byte in bytes {
        if application.push(port, *byte) {
            reports.push_str(application.report());
        }
    }
}

/// The walk with radios on two wires, and a computer that asks in the middle of their frames: what comes out is what the
/// gateway says to the sentences.
#[test]
fn radios_of_several_lines_and_a_computer_never_mix() {
    let mut alone = std::boxed::Box::new(Gateway::EMPTY);
    let mut expected = String::new();
    let mut state = std::boxed::Box::new(State::new(Gateway::EMPTY));
    let mut tunnel = Tunnel::<_, 3>::new(&mut state, config(), now_ms, &mut []);
    let mut reports = String::new();
    for (number, packet) in packets().take(2_000).enumerate() {
        for byte in sentence(&packet).bytes() {
            if alone.push(byte, &config()).is_some() {
                expected.push_str(alone.report());
            }
        }
        set_now_ms(packet.time_ms);
        // The clock of a radio says nothing.
        let frame = radio::frame(Packet {
            time_ms: 77,
            ..packet
        });
        let port = 1 + number % 2;
        let (begin, end) = frame.split_at(number % frame.len());
        push(&mut tunnel, port, begin, &mut reports);
        push(&mut tunnel, 0, &QUERY[..5], &mut reports);
        push(&mut tunnel, port, end, &mut reports);
        push(&mut tunnel, 0, b"\n", &mut reports);
    }
    // The halves of queries are lines that the gateway rejects, and nothing else.
    assert_eq!(reports, expected);
    assert!(expected.matches("$PFOXT,").count() > 300);
}

#[test]
fn a_new_map_is_taken_when_it_is_whole() {
    let mut state = std::boxed::Box::new(State::new(Gateway::EMPTY));
    let mut room = [0; corridor::MAP_BYTES];
    let mut tunnel = Tunnel::<_, 1>::new(&mut state, config(), now_ms, &mut room);
    let mut reports = String::new();
    for (number, bytes) in MAP.chunks(32).enumerate() {
        assert_eq!(tunnel.new_map(), None);
        let digits: String = bytes.iter().map(|byte| format!("{byte:02X}")).collect();
        let payload = format!("PFOXM,{},{},{digits}", 32 * number, MAP.len());
        let sum = payload.bytes().fold(0, |sum, byte| sum ^ byte);
        push(
            &mut tunnel,
            0,
            format!("${payload}*{sum:02X}\r\n").as_bytes(),
            &mut reports,
        );
    }
    assert_eq!(tunnel.new_map(), Some(MAP));
    assert!(reports.contains(",READY*"));
}

/// A board whose clock begins anew takes packets as before.
#[test]
fn time_goes_on_after_a_moment_without_power() {
    let mut buffer = std::vec![0; snapshot::largest::<State<Gateway>>()];
    let mut taken = [0; 2];
    let mut saved = Vec::new();
    for (life, taken) in taken.iter_mut().enumerate() {
        let mut state = std::boxed::Box::new(State::new(Gateway::EMPTY));
        set_now_ms(0);
        let mut tunnel = Tunnel::<_, 2>::new(&mut state, config(), now_ms, &mut []);
        if life > 0 {
            snapshot::restore(tunnel.state(), &saved).unwrap();
            tunnel.resume(300);
        }
        for packet in packets().take(1_000) {
            set_now_ms(packet.time_ms);
            push(&mut tunnel, 1, &radio::frame(packet), &mut String::new());
        }
        *taken = tunnel.state.gateway.counters().packets;
        saved = snapshot::save(tunnel.state(), &mut buffer)
            .unwrap()
            .to_vec();
    }
    assert_eq!(taken, [1_000, 2_000]);
}

#[test]
fn the_longest_sentence_fits() {
    let longest = Packet {
        time_ms: u32::MAX,
        radio: u16::MAX,
        tag: u32::MAX,
        rssi_dbm: i8::MIN,
    };
    let line = sentence(&longest);
    assert!(line.ends_with("\r\n") && line.len() < 64, "{line}");
}
