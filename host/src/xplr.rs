//! Directions measured by fixed arrays round a room, of a tag that a person carries.
//!
//! The files are those of Girolami et al. (Zenodo 7759557).

use std::{collections::BTreeMap, fs, path::Path};

use anyhow::{Context, Result};

use crate::Sight;

/// What the arrays heard of a tag at one place.
#[derive(Debug, Clone, PartialEq)]
pub struct Stop {
    /// Where the tag was, in metres.
    pub tag: [f64; 2],
    /// The readings in the order of time, each with the number of its array.
    pub sights: Vec<(u8, Sight)>,
}

/// Every stop, with readings of this sigma, in radians.
///
/// # Errors
/// If a file cannot be read.
pub fn stops(directory: &Path, sigma: f64) -> Result<Vec<Stop>> {
    let mut arrays = BTreeMap::new();
    for row in rows::<4>(&directory.join("anchors.csv"))? {
        if let [Some(array), Some(x), Some(y), Some(boresight)] = row {
            let station = arrays.len() as u8;
            arrays.insert(array as u32, (station, [x, y], boresight));
        }
    }
    let packets = rows::<3>(&directory.join("stops.csv"))?;
    let stop = |row: [Option<f64>; 4]| {
        let [Some(from), Some(until), Some(x), Some(y)] = row else {
            return None;
        };
        let sights = packets.iter().filter_map(|packet| {
            let [Some(time), Some(array), Some(azimuth)] = *packet else {
                return None;
            };
            let (station, position, boresight) = *arrays.get(&(array as u32))?;
            let sight = Sight {
                time_ms: (1e3 * time) as u32,
                position,
                bearing: (90.0 - boresight - azimuth).to_radians(),
                sigma,
            };
            (from..until).contains(&time).then_some((station, sight))
        });
        Some(Stop {
            tag: [x, y],
            sights: sights.collect(),
        })
    };
    let truth = rows::<4>(&directory.join("stops_truth.csv"))?;
    Ok(truth.into_iter().filter_map(stop).collect())
}

/// The first columns of a file of numbers, some of which are missing.
fn rows<const N: usize>(file: &Path) -> Result<Vec<[Option<f64>; N]>> {
    let text = fs::read_to_string(file).with_context(|| file.display().to_string())?;
    let number = |cell: Option<&str>| cell.and_then(|cell| cell.trim().parse().ok());
    Ok(text
        .lines()
        .skip(1)
        .map(|line| {
            let mut cells = line.split(',');
            std::array::from_fn(|_| number(cells.next()))
        })
        .collect())
}
