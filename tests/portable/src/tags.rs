use foxhunt::{
    fingerprint::{
        RadioMap,
        tracker::{self, Site, Walls},
    },
    gateway::beacon::{BeaconGateway, Config, Event, Spot},
};

use super::{Case, Digest, gateway::sentence};

pub const CASES: &[Case] = &[(
    "tags::a_gateway_tracks_records_a_survey_and_takes_a_new_map",
    a_gateway_tracks_records_a_survey_and_takes_a_new_map,
)];

static MOMENTS: &[u8] = include_bytes!("../data/tunnel.moments");
static LEVELS: &[u8] = include_bytes!("../data/tunnel.levels");

type Gateway = BeaconGateway<2, 100, 80, 4, 1>;

/// The gateway, its map, and what it has said.
struct Board {
    gateway: Gateway,
    digest: Digest,
}

impl Board {
    /// Hands a sentence to the gateway, and returns what it led to.
    fn hear(&mut self, bytes: &[u8], map: RadioMap<'_>) -> Event {
        let config = config(map);
        let mut events = bytes
            .iter()
            .filter_map(|byte| self.gateway.push(*byte, &config));
        let event = events.next().expect("a sentence ends");
        self.digest.add_bytes(self.gateway.report().as_bytes());
        event
    }

    /// Two tags walk for so many seconds, each as the map says where it is.
    fn walk(&mut self, seconds: core::ops::Range<u32>, map: RadioMap<'_>) {
        for time_ms in (1_000 * seconds.start..1_000 * seconds.end).step_by(500) {
            for (tag, point) in [(7, 10 + time_ms / 1_000), (8, 70 - time_ms / 1_000)] {
                for beacon in 0..map.beacons() {
                    let there = map.moments(beacon, point as usize).expect("surveyed");
                    let radio = map.beacon(beacon).expect("counted").identifier;
                    let rssi_dbm = there.mean_dbm as i8;
                    let packet = format_args!("PFOXB,{time_ms},{radio},{tag},{rssi_dbm}");
                    let event = self.hear(&sentence(packet), map);
                    assert!(matches!(event, Event::Taken { .. } | Event::Fix { .. }));
                }
            }
        }
    }

    /// Sends a map in pieces; whether it has come whole.
    fn receive(&mut self, new: &[u8], buffer: &mut [u8; 1_024], map: RadioMap<'_>) -> bool {
        let mut is_whole = false;
        for (number, bytes) in new.chunks(32).enumerate() {
            let mut digits = heapless::String::<64>::new();
            for byte in bytes {
                use core::fmt::Write;
                write!(digits, "{byte:02X}").expect("32 bytes");
            }
            let offset = 32 * number;
            let piece = sentence(format_args!("PFOXM,{offset},{},{digits}", new.len()));
            let Event::MapPiece(piece) = self.hear(&piece, map) else {
                panic!("a piece of a map");
            };
            is_whole = matches!(self.gateway.take_map(&piece, buffer), Ok(Some(_)));
            self.digest.add_bytes(self.gateway.report().as_bytes());
        }
        is_whole
    }
}

fn config(map: RadioMap<'_>) -> Config<Site<'_>> {
    Config::new(Site {
        map,
        config: tracker::Config::TUNNEL,
        walls: Walls::None,
    })
}

/// A map that is too long is refused, and the gateway goes on; another takes the place of its own.
fn a_gateway_tracks_records_a_survey_and_takes_a_new_map() -> Digest {
    let map = RadioMap::new(MOMENTS).expect("the map is whole");
    let mut board = Board {
        gateway: Gateway::EMPTY,
        digest: Digest::new(),
    };
    board.walk(0..15, map);
    let spot = Spot {
        tag: 7,
        place: [12.5, 0.25],
        floor: 0,
    };
    let surveyed = board.hear(&sentence(format_args!("PFOXV,7,12.5,0.25,0")), map);
    assert_eq!(surveyed, Event::Survey(Some(spot)));
    board.walk(15..16, map);
    assert_eq!(
        board.hear(&sentence(format_args!("PFOXV")), map),
        Event::Survey(None)
    );
    let mut buffer = [0; 1_024];
    assert!(!board.receive(LEVELS, &mut buffer, map));
    board.walk(16..18, map);
    assert!(board.receive(MOMENTS, &mut buffer, map));
    let new = buffer.get(..MOMENTS.len()).unwrap_or_default();
    let new = RadioMap::new(new).expect("it was checked");
    board.gateway.restart();
    board.walk(18..30, new);
    assert_eq!(
        board.hear(&sentence(format_args!("PFOXQ")), new),
        Event::Queried
    );
    board.digest
}
