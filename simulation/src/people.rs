//! Eight people in a tunnel for a minute, each with a tag.

use alloc::vec::Vec;
use core::ops::Range;

use foxhunt::gateway::beacon::Packet;
use rand::Rng;

use crate::{
    path::Path,
    tunnel::{self, Radio, Site},
};

/// The seed of the tunnel that comes with the project, and of the minute that was recorded in it.
pub const EXAMPLE_SEED: u64 = 2017;

/// Identifiers of the tunnel's radios in the map.
pub const RADIOS: [u32; 4] = [1, 2, 3, 4];
/// How a radio hears a tag like that of the survey.
pub const RADIO: Radio = Radio {
    noise: 4.0,
    offset: 0.0,
    loss: 0.05,
};
/// Packets of a tag that each radio hears in a second.
pub const RATE: f64 = 2.0;
/// From when to when the last radio is without power, in seconds.
pub const OUTAGE: Range<f64> = 30.0..42.0;

/// Somebody who walks.
struct Person {
    tag: u32,
    /// By how much the tag is louder than the one of the survey, in dB.
    offset: f64,
    /// When they are where: seconds, metres along and across.
    way: &'static [(f64, [f64; 2])],
    /// While the tag is not heard, in seconds.
    unheard: Range<f64>,
}

const NEVER: Range<f64> = 0.0..0.0;

const PEOPLE: [Person; 8] = [
    Person {
        tag: 101,
        offset: 0.0,
        way: &[(0.0, [2.0, 1.2]), (60.0, [74.0, 1.2])],
        unheard: NEVER,
    },
    Person {
        tag: 102,
        offset: 0.0,
        way: &[(0.0, [78.0, 2.2]), (60.0, [30.0, 2.2])],
        unheard: NEVER,
    },
    // Stands at work.
    Person {
        tag: 103,
        offset: 0.0,
        way: &[(0.0, [40.0, 1.2]), (60.0, [40.0, 1.2])],
        unheard: NEVER,
    },
    // Another make of tag.
    Person {
        tag: 104,
        offset: 8.0,
        way: &[
            (0.0, [10.0, 1.2]),
            (20.0, [32.0, 1.2]),
            (30.0, [32.0, 1.2]),
            (60.0, [64.0, 1.2]),
        ],
        unheard: NEVER,
    },
    // On a bicycle, to the end and back.
    Person {
        tag: 105,
        offset: 0.0,
        way: &[
            (0.0, [5.0, 1.75]),
            (28.0, [75.0, 1.75]),
            (32.0, [75.0, 1.75]),
            (60.0, [5.0, 1.75]),
        ],
        unheard: NEVER,
    },
    // Is driven on, in a cab that lets nothing out.
    Person {
        tag: 106,
        offset: 0.0,
        way: &[
            (0.0, [8.0, 2.2]),
            (18.0, [22.0, 2.2]),
            (22.0, [58.0, 2.2]),
            (60.0, [77.0, 2.2]),
        ],
        unheard: 18.0..22.0,
    },
    // Comes in later.
    Person {
        tag: 107,
        offset: 0.0,
        way: &[(12.0, [80.0, 1.2]), (60.0, [20.0, 1.2])],
        unheard: NEVER,
    },
    // Goes to and fro.
    Person {
        tag: 108,
        offset: 0.0,
        way: &[
            (0.0, [54.0, 2.2]),
            (15.0, [70.0, 2.2]),
            (30.0, [54.0, 2.2]),
            (45.0, [70.0, 2.2]),
            (60.0, [54.0, 2.2]),
        ],
        unheard: NEVER,
    },
];

/// What the radios heard, and where everybody was.
#[derive(Debug, Clone, PartialEq)]
pub struct Minute {
    /// In the order of time.
    pub packets: Vec<Packet>,
    /// The way of each tag.
    pub ways: Vec<(u32, Path)>,
}

impl Minute {
    /// Draws what radios like `radio` hear, of which the last one has no power during `outage`.
    pub fn draw(site: &Site, radio: &Radio, outage: Range<f64>, rng: &mut impl Rng) -> Self {
        let mut packets = Vec::new();
        let mut ways = Vec::new();
        let last = RADIOS.len() - 1;
        for person in PEOPLE {
            let path = Path::new(person.way);
            let radio = Radio {
                offset: radio.offset + person.offset,
                ..*radio
            };
            let [start, end] = path.times().unwrap_or_default();
            let place = |seconds| path.at(start + seconds).unwrap_or(person.way[0].1);
            for heard in site.walk(place, end - start, RATE, &radio, rng) {
                let time = start + heard.time;
                let is_dead = heard.beacon == last && outage.contains(&time);
                if !is_dead && !person.unheard.contains(&time) {
                    packets.push(packet(person.tag, time, &heard));
                }
            }
            ways.push((person.tag, path));
        }
        packets.sort_by_key(|packet: &Packet| packet.time_ms);
        Self { packets, ways }
    }
}

/// The packet of a tag, in seconds since the start.
pub fn packet(tag: u32, time: f64, heard: &tunnel::Packet) -> Packet {
    Packet {
        time_ms: (1e3 * time) as u32,
        radio: RADIOS[heard.beacon] as u16,
        tag,
        rssi_dbm: heard.level as i8,
    }
}
