//! The tunnel that comes with the project: its radio map, and a minute of eight people in it.

use foxhunt::gateway::beacon::MAX_TAGS;
use foxhunt_simulation::{
    path::Path,
    people::{self, Minute},
    random::generator,
    tunnel::{Radio, Site, Tunnel},
};
use rand::{Rng, RngExt};

use super::{Recording, Scene, Walks};
use crate::{
    experiment::{SAMPLES, SURVEYED},
    radio_map::{Recipe, SiteSurvey},
};

/// The example from a seed: the published tunnel, surveyed every metre, and a minute in it, with everything that a site
/// brings.
///
/// # Panics
/// Never: the survey of this tunnel makes a map.
pub fn example(seed: u64) -> Scene {
    let mut rng = generator(seed, 0);
    let (site, map) = surveyed(&mut rng);
    let minute = Minute::draw(&site, &people::RADIO, people::OUTAGE, &mut rng);
    let recording = Recording {
        packets: minute.packets,
        truth: minute.ways.into_iter().collect(),
    };
    scene(map, recording, site)
}

/// What was recorded in the tunnel, in the order of time.
pub(super) fn scene(map: Vec<u8>, mut recording: Recording, site: Site) -> Scene {
    recording.packets.sort_by_key(|packet| packet.time_ms);
    Scene {
        map,
        recording,
        radios: site.tunnel.beacons,
        walks: Walks::Tunnel,
    }
}

/// The tunnel, and its radio map.
pub(super) fn surveyed(rng: &mut impl Rng) -> (Site, Vec<u8>) {
    let site = Tunnel::default().draw(rng);
    let places: Vec<[f64; 2]> = (0..=80).map(|x| [f64::from(x), SURVEYED]).collect();
    let survey = site.survey(&places, SAMPLES, &Radio::new(people::RADIO.noise), rng);
    let survey = SiteSurvey::of(&survey, &people::RADIOS);
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
        let place = |time| path.at(time).unwrap_or(from);
        for heard in site.walk(place, seconds, people::RATE, &people::RADIO, &mut rng) {
            (recording.packets).push(people::packet(tag, heard.time, &heard));
        }
        recording.truth.insert(tag, path);
    }
    scene(map, recording, site)
}

#[cfg(test)]
mod tests {
    use foxhunt_simulation::people::EXAMPLE_SEED;

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
