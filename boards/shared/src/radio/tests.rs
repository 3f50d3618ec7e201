extern crate std;

use byte::BytesExt;
use foxhunt::random::{Rng, SeedableRng, Xoshiro128PlusPlus};
use ieee802154::mac::{Address, FrameType, FrameVersion, Header};

use super::*;

const PACKET: Packet = Packet {
    time_ms: 0,
    radio: 12,
    tag: 0x0100_0007,
    rssi_dbm: -71,
};

#[test]
fn whole_frames_come_through_and_damaged_ones_do_not() {
    let sent = frame(PACKET);
    assert_eq!(packet(&sent), Some(PACKET));
    for place in 0..sent.len() {
        for change in 1..=255 {
            let mut damaged = sent.clone();
            damaged[place] ^= change;
            let mut frames = Frames::EMPTY;
            let came = damaged.iter().filter_map(|byte| frames.push(*byte)).count();
            assert_eq!(came, 0, "byte {place} changed by {change}");
            // The damaged one may have lost its end, and takes the next one with it, but no more.
            let twice = sent.iter().chain(&sent);
            let came: std::vec::Vec<_> = twice.filter_map(|byte| frames.push(*byte)).collect();
            assert_eq!(came.last(), Some(&sent));
        }
    }
}

#[test]
fn any_bytes_leave_the_next_frame_but_one_alone() {
    let mut rng = Xoshiro128PlusPlus::seed_from_u64(1);
    let mut frames = Frames::EMPTY;
    for _ in 0..1_000 {
        for _ in 0..rng.next_u32() % 60 {
            let _ = frames.push(rng.next_u32() as u8);
        }
        let _ = frames.push(0);
        let came = frame(PACKET).iter().find_map(|byte| frames.push(*byte));
        assert_eq!(came, Some(frame(PACKET)));
    }
}

#[test]
fn senders_are_those_that_another_reader_finds() {
    let mut rng = Xoshiro128PlusPlus::seed_from_u64(2);
    let mut found = 0;
    for _ in 0..200_000 {
        let mut bytes = [0; 24];
        for byte in &mut bytes {
            *byte = rng.next_u32() as u8;
        }
        // Mostly data, of a version that the other reader knows.
        bytes[0] = bytes[0] & 0x60 | 1;
        bytes[1] &= 0xDC;
        let length = rng.next_u32() as usize % bytes.len();
        let bytes = &bytes[..length];
        let header: Result<Header, _> = bytes.read(&mut 0);
        let expected = header.ok().filter(|header| {
            header.frame_type == FrameType::Data && header.version != FrameVersion::Ieee802154
        });
        let expected = expected
            .and_then(|header| header.source)
            .map(|source| match source {
                Address::Short(_, address) => u32::from(address.0),
                Address::Extended(_, address) => address.0 as u32,
            });
        assert_eq!(tag(bytes), expected, "{bytes:02x?}");
        found += u32::from(expected.is_some());
    }
    assert!(found > 10_000, "{found}");
}

#[test]
fn strengths_are_in_range() {
    assert_eq!(dbm(0), -92);
    assert_eq!(dbm(60), -32);
    assert_eq!(dbm(u8::MAX), i8::MAX);
}

/// A line by which bytes come in pieces of some lengths, and then none.
struct Line {
    bytes: std::vec::Vec<u8>,
    place: usize,
    piece: usize,
}

impl embedded_io_async::ErrorType for Line {
    type Error = core::convert::Infallible;
}

impl Read for Line {
    async fn read(&mut self, buffer: &mut [u8]) -> Result<usize, Self::Error> {
        embassy_futures::yield_now().await;
        let rest = &self.bytes[self.place..];
        if rest.is_empty() {
            core::future::pending::<()>().await;
        }
        let count = rest.len().min(self.piece);
        buffer[..count].copy_from_slice(&rest[..count]);
        self.place += count;
        Ok(count)
    }
}

struct Desk;

impl Board for Desk {
    fn feed(&mut self) {}

    async fn tick(&mut self) {
        core::future::pending().await
    }
}

/// What a board sends inwards that gets these bytes by two lines.
fn relayed(lines: [std::vec::Vec<u8>; 2]) -> std::vec::Vec<u8> {
    let mut pieces = [5, 3].into_iter();
    let lines = lines.map(|bytes| Line {
        bytes,
        place: 0,
        piece: pieces.next().unwrap(),
    });
    let mut sent = [0; 20_000];
    let mut room: &mut [u8] = &mut sent;
    let whole = room.len();
    let all_taken = async {
        for _ in 0..100_000 {
            embassy_futures::yield_now().await;
        }
    };
    embassy_futures::block_on(select(relay(lines, &mut room, Desk), all_taken));
    let length = whole - room.len();
    sent[..length].to_vec()
}

#[test]
fn a_board_hands_on_whole_frames_of_both_lines() {
    let of = |radio: u16, count: u32| {
        (0..count).map(move |tag| Packet {
            radio,
            tag,
            ..PACKET
        })
    };
    let line = |radio, count| {
        of(radio, count)
            .flat_map(frame)
            .collect::<std::vec::Vec<u8>>()
    };
    // The further board was switched on in the middle of a frame.
    let outer = [&frame(PACKET)[5..], &line(2, 200)].concat();
    let sent = relayed([outer, line(1, 300)]);
    let mut frames = Frames::EMPTY;
    let came = sent.iter().filter_map(|byte| frames.push(*byte));
    let came = came.filter_map(|frame| packet(&frame));
    let came: std::vec::Vec<Packet> = came.collect();
    for (radio, count) in [(1, 300), (2, 200)] {
        let own = came.iter().filter(|packet| packet.radio == radio).copied();
        assert!(own.eq(of(radio, count)), "radio {radio}");
    }
    assert_eq!(came.len(), 500);
}
