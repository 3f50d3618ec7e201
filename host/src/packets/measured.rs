//! Measured walks, and the maps on which they are tracked.

use std::path::Path as Directory;

use anyhow::Result;
use foxhunt::gateway::beacon::Packet;

use foxhunt_simulation::path::Path;

use super::{Recording, Scene, Walks};
use crate::{
    radio_map::{Recipe, SiteSurvey},
    tetam, walks,
};

/// Milliseconds from one true place to the next.
const STEP_MS: f64 = 250.0;

/// A walk of the data set in `directory`, such as [`tetam::WALKS`].
///
/// Walks that keep to a corridor are tracked along its middle, on a map of one row or one column; the others on a map of the
/// whole floor.
///
/// # Errors
/// When there is no such walk, or the files are not of that form.
pub fn measured(directory: &Directory, name: &str) -> Result<Scene> {
    let survey = tetam::survey(directory)?;
    let walk = tetam::walk(directory, name)?;
    let receivers = tetam::receivers(directory)?;
    let identifiers: Vec<u32> = (0..survey.beacons() as u32).collect();
    let (lattice, _) = walks::lattice(&walk.truth)?;
    let recipe = Recipe {
        sources: identifiers
            .iter()
            .copied()
            .zip(receivers.iter().copied())
            .collect(),
        ..Recipe::on(lattice)
    };
    let map = SiteSurvey::of(&survey, &identifiers)
        .map(&recipe, &mut |_| ())?
        .bytes;

    let mut path = Path::default();
    let mut recording = Recording::default();
    let mut next_ms = 0.0;
    for (heard, place) in walk.packets.iter().zip(walk.truth) {
        let time_ms = 1e3 * heard.time;
        if time_ms >= next_ms {
            path.push(heard.time, place);
            next_ms = time_ms + STEP_MS;
        }
        recording.packets.push(Packet {
            time_ms: time_ms as u32,
            radio: heard.beacon as u16,
            tag: TAG,
            rssi_dbm: heard.level.clamp(-128.0, 127.0) as i8,
        });
    }
    recording.truth.insert(TAG, path);
    Ok(Scene {
        map,
        recording,
        radios: receivers,
        walks: Walks::Floor,
    })
}

/// There is one.
const TAG: u32 = 1;

#[cfg(test)]
mod tests {
    use super::*;
    use foxhunt::fingerprint::RadioMap;

    #[test]
    fn every_walk_lies_on_its_map() {
        // The data set is not part of the project.
        let Some(data) = std::env::var_os("FOXHUNT_DATA") else {
            return;
        };
        for name in tetam::WALKS {
            let scene = measured(&Directory::new(&data).join("tetam"), name).unwrap();
            let map = RadioMap::new(&scene.map).unwrap();
            assert_eq!(map.beacons(), 12);
            assert!((0..map.lattice().points()).all(|point| map.is_possible(point)));
            let [low, high] =
                [0, map.lattice().points() - 1].map(|point| map.lattice().position(point));
            for (_, place) in scene.recording.truth[&TAG].corners() {
                let along = low[0] as f64 - 0.5..=high[0] as f64 + 0.5;
                assert!(along.contains(&place[0]), "{name} {place:?}");
            }
        }
    }
}
