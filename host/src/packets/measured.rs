//! Measured walks, and the maps on which they are tracked.

use std::path::Path as Directory;

use anyhow::{Context, Result};
use foxhunt::{
    fingerprint::{Encoding, Lattice},
    gateway::beacon::Packet,
};

use super::{Path, Recording, Scene, Walks};
use crate::{
    radio_map::{Options, SiteSurvey},
    survey::Survey,
    tetam,
};

/// Milliseconds from one true place to the next.
const STEP_MS: f64 = 250.0;
/// Everywhere on the floor counts as surveyed.
const REACH: f64 = 5.0;

/// A walk of the data set in `directory`, one of [`tetam::WALKS`].
///
/// Straight walks are tracked along the middle of their corridor, on a map of one row; x is along it, also where it runs
/// along the y of the data set. The others are tracked on a map of the whole floor.
///
/// # Errors
/// When the files are not there, or not of that form.
pub fn measured(directory: &Directory, name: &str) -> Result<Scene> {
    let survey = tetam::survey(directory)?;
    let walk = tetam::walk(directory, name)?;
    let receivers = tetam::receivers(directory)?;
    let (origin, columns, rows) = match name {
        "straight_01" => ([-0.2, 8.46], 22, 1),
        "straight_02" => ([-0.2, 4.36], 22, 1),
        "straight_03" => ([-0.5, 11.5], 20, 1),
        _ => ([-0.25, -0.5], 22, 20),
    };
    let turned = |[x, y]: [f64; 2]| match name {
        "straight_03" => [y, x],
        _ => [x, y],
    };
    let survey = Survey {
        places: survey.places.into_iter().map(turned).collect(),
        samples: survey.samples,
    };
    let identifiers: Vec<u32> = (0..survey.beacons() as u32).collect();
    let lattice = Lattice::new(origin, 1.0, columns, rows).context("the lattice is impossible")?;
    let options = Options {
        reach: Some(REACH),
        ..Options::default()
    };
    let map =
        SiteSurvey::of(&survey, &identifiers).radio_map(&lattice, Encoding::Moments, &options)?;

    let mut path = Path::default();
    let mut recording = Recording::default();
    let mut next_ms = 0.0;
    for (heard, place) in walk.packets.iter().zip(walk.truth) {
        let time_ms = 1e3 * heard.time;
        if time_ms >= next_ms {
            path.push(heard.time, turned(place));
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
        radios: receivers.into_iter().map(turned).collect(),
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
            assert!((0..map.lattice().points()).all(|point| map.is_surveyed(point)));
            let [low, high] =
                [0, map.lattice().points() - 1].map(|point| map.lattice().position(point));
            for (_, place) in scene.recording.truth[&TAG].corners() {
                let along = low[0] as f64 - 0.5..=high[0] as f64 + 0.5;
                assert!(along.contains(&place[0]), "{name} {place:?}");
            }
        }
    }
}
