//! The tunnel that comes with the project: its radio map, and a minute of eight people in it.

use foxhunt::gateway::beacon::{MAX_TAGS, Packet};
use rand::{Rng, RngExt};

use super::{Path, Recording, Scene, Walks};
use crate::{
    radio_map::{Recipe, SiteSurvey},
    simulate::generator,
    tunnel::{
        self, Radio, Site, Tunnel,
        experiment::{SAMPLES, SURVEYED},
    },
};

/// The seed of the files that come with the project.
pub const EXAMPLE_SEED: u64 = 2017;

/// Identifiers of the tunnel's radios in the map.
const RADIOS: [u32; 4] = [1, 2, 3, 4];
/// Standard deviation of a packet, in dB.
const NOISE: f64 = 4.0;
/// Rate of packets that are lost.
const LOSS: f64 = 0.05;
/// Packets of a tag that each radio hears in a second.
const RATE: f64 = 2.0;
/// The last radio is without power from when to when, in seconds.
const OUTAGE: std::ops::Range<f64> = 30.0..42.0;

/// Somebody who walks.
struct Person {
    tag: u32,
    /// By how much the tag is louder than the one of the survey, in dB.
    offset: f64,
    /// When they are where: seconds, metres along and across.
    way: &'static [(f64, [f64; 2])],
    /// While the tag is not heard, in seconds.
    unheard: std::ops::Range<f64>,
}

const NEVER: std::ops::Range<f64> = 0.0..0.0;

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

/// The example from a seed: the published tunnel, surveyed every metre, and a minute in it, with everything that a site
/// brings.
///
/// # Panics
/// Never: the survey of this tunnel makes a map.
pub fn example(seed: u64) -> Scene {
    let mut rng = generator(seed, 0);
    let (site, map) = surveyed(&mut rng);
    let mut recording = Recording::default();
    let last = RADIOS.len() - 1;
    for person in PEOPLE {
        let path = Path::new(person.way);
        let radio = Radio {
            noise: NOISE,
            offset: person.offset,
            loss: LOSS,
        };
        let [start, end] = path.times().expect("everybody has a way");
        let place = |seconds| path.at(start + seconds).unwrap_or(person.way[0].1);
        for heard in site.walk(place, end - start, RATE, &radio, &mut rng) {
            let time = start + heard.time;
            let is_dead = heard.beacon == last && OUTAGE.contains(&time);
            if !is_dead && !person.unheard.contains(&time) {
                (recording.packets).push(packet(person.tag, time, &heard));
            }
        }
        recording.truth.insert(person.tag, path);
    }
    scene(map, recording, site)
}

/// The packet of a tag, in seconds since the start.
fn packet(tag: u32, time: f64, heard: &tunnel::Packet) -> Packet {
    Packet {
        time_ms: (1e3 * time) as u32,
        radio: RADIOS[heard.beacon] as u16,
        tag,
        rssi_dbm: heard.level as i8,
    }
}

/// What was recorded in the tunnel, in the order of time.
fn scene(map: Vec<u8>, mut recording: Recording, site: Site) -> Scene {
    recording.packets.sort_by_key(|packet| packet.time_ms);
    Scene {
        map,
        recording,
        radios: site.tunnel.beacons,
        walks: Walks::Tunnel,
    }
}

/// The tunnel, and its radio map.
fn surveyed(rng: &mut impl Rng) -> (Site, Vec<u8>) {
    let site = Tunnel::default().draw(rng);
    let places: Vec<[f64; 2]> = (0..=80).map(|x| [f64::from(x), SURVEYED]).collect();
    let survey = site.survey(&places, SAMPLES, &Radio::new(NOISE), rng);
    let survey = SiteSurvey::of(&survey, &RADIOS);
    let recipe = Recipe {
        spacing_m: Some(1.0),
        ..Recipe::default()
    };
    let map = survey.map(&recipe, &mut |_| ());
    (site, map.expect("the survey is whole").bytes)
}

/// The same tunnel with as many tags as the gateway of the firmware has trackers, for so many seconds: each walks from
/// somewhere to somewhere else.
///
/// # Panics
/// Never: the survey of this tunnel makes a map.
pub fn crowd(seed: u64, seconds: f64) -> Scene {
    let mut rng = generator(seed, 0);
    let (site, map) = surveyed(&mut rng);
    let mut recording = Recording::default();
    for tag in 1..=MAX_TAGS as u32 {
        let [from, to] =
            [(); 2].map(|()| [rng.random_range(2.0..78.0), rng.random_range(1.0..2.5)]);
        let path = Path::new(&[(0.0, from), (seconds, to)]);
        let radio = Radio {
            noise: NOISE,
            offset: 0.0,
            loss: LOSS,
        };
        let place = |time| path.at(time).unwrap_or(from);
        for heard in site.walk(place, seconds, RATE, &radio, &mut rng) {
            (recording.packets).push(packet(tag, heard.time, &heard));
        }
        recording.truth.insert(tag, path);
    }
    scene(map, recording, site)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_shipped_files_are_those_of_the_seed() {
        let Scene { map, recording, .. } = example(EXAMPLE_SEED);
        let lines = recording.line_bytes();
        let same = map == include_bytes!("../../../examples/data/tunnel.map")
            && lines == include_bytes!("../../../examples/data/tunnel.packets");
        assert!(same, "remake them: cargo xtask tunnel");
    }
}
