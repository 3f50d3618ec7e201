//! People in a tunnel, or in a building, as a scenario tells.

use std::fmt::Write;

use foxhunt::gateway::beacon::Packet;
use foxhunt_simulation::{path::Path, people, random::generator};

use super::{
    Recording, Scene,
    example::{scene, surveyed},
};
use crate::building::{Building, FLOORS};

/// The tunnel that comes with the project, drawn from a seed, and people in it: a tag and a way each.
///
/// # Panics
/// Never: the survey of this tunnel makes a map.
pub fn tunnel(seed: u64, people: &[(u32, Path)]) -> Scene {
    let mut rng = generator(seed, 0);
    let (site, map) = surveyed(&mut rng);
    let mut recording = Recording::default();
    for (tag, path) in people {
        let (Some([start, end]), Some(first)) = (path.times(), path.held(0.0)) else {
            continue;
        };
        let place = |seconds| path.held(start + seconds).unwrap_or(first);
        for heard in site.walk(place, end - start, people::RATE, &people::RADIO, &mut rng) {
            (recording.packets).push(people::packet(*tag, start + heard.time, &heard));
        }
        recording.truth.insert(*tag, path.clone());
    }
    scene(map, recording, site)
}

/// A simulated building.
#[derive(Debug, Clone, PartialEq)]
pub struct Floors {
    /// Its survey as CSV, with the floors.
    pub survey: String,
    /// What its beacons heard of the tags 1, 2 and so on, and where those were on their floors.
    pub recording: Recording,
}

/// A building of three floors, its survey, and people who walk in it for so many seconds.
pub fn building(seed: u64, people: u32, seconds: f64) -> Floors {
    let mut rng = generator(seed, 0);
    let building = Building::draw(&mut rng);
    let mut survey = String::from("floor,x,y,beacon,rssi\n");
    for floor in 0..FLOORS {
        let measured = building.survey(floor, &mut rng);
        for ([x, y], samples) in measured.places.iter().zip(&measured.samples) {
            for (beacon, levels) in (1..).zip(samples) {
                for level in levels {
                    writeln!(survey, "{floor},{x},{y},{beacon},{level}")
                        .expect("a string takes all");
                }
            }
        }
    }
    let mut recording = Recording::default();
    for tag in 1..=people {
        let walk = building.walk(seconds, &mut rng);
        recording
            .packets
            .extend(walk.packets.iter().map(|heard| Packet {
                time_ms: (1e3 * heard.time) as u32,
                radio: heard.beacon as u16 + 1,
                tag,
                rssi_dbm: heard.level as i8,
            }));
        let steps = (0..).map(f64::from).zip(&walk.places);
        let corners: Vec<_> = steps
            .map(|(step, place)| (0.5 * step, place.position))
            .collect();
        recording.truth.insert(tag, Path::new(&corners));
    }
    recording.packets.sort_by_key(|packet| packet.time_ms);
    Floors { survey, recording }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::radio_map::SiteSurvey;

    #[test]
    fn a_building_has_a_survey_of_each_floor() {
        let Floors { survey, recording } = building(1, 2, 60.0);
        assert_eq!(SiteSurvey::floors(survey.as_bytes()).unwrap().len(), FLOORS);
        assert_eq!(recording.truth.len(), 2);
        assert!(recording.packets.len() > 1_000);
        assert_eq!(building(1, 2, 60.0).recording, recording);
    }

    #[test]
    fn people_are_heard_while_they_walk() {
        let path = Path::along(&[[10.0, 1.2], [70.0, 1.2]], 2.0, 5.0);
        let Scene { recording, .. } = tunnel(1, &[(7, path)]);
        let times: Vec<u32> = recording.packets.iter().map(|one| one.time_ms).collect();
        assert!(times.iter().all(|time| (5_000..36_000).contains(time)));
        assert!(times.len() > 100 && recording.packets.iter().all(|one| one.tag == 7));
    }
}
