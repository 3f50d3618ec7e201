//! Directions measured by fixed arrays round a room, of a tag that a person carries.
//!
//! The files are those of Girolami et al. (Zenodo 7759557).

use std::{collections::BTreeMap, fs, path::Path};

use anyhow::{Context, Result};

use foxhunt_simulation::Sight;

/// What the arrays heard of a tag at one place.
#[derive(Debug, Clone, PartialEq)]
pub struct Stop {
    /// Where the tag was, in metres.
    pub tag: [f64; 2],
    /// The readings in the order of time, each with the number of its array.
    pub sights: Vec<(u8, Sight)>,
}

/// What the arrays heard of a tag that is carried along.
#[derive(Debug, Clone, PartialEq)]
pub struct Walk {
    /// Seconds and places, between which the tag is carried straight on.
    way: Vec<(f64, [f64; 2])>,
    /// The readings in the order of time, each with the number of its array.
    pub sights: Vec<(u8, Sight)>,
}

impl Walk {
    /// Where the tag is, where that is known.
    pub fn tag(&self, seconds: f64) -> Option<[f64; 2]> {
        let pairs = self.way.windows(2);
        let mut legs = pairs.filter_map(|pair| <&[_; 2]>::try_from(pair).ok());
        let [(from, start), (until, end)] =
            legs.find(|[(from, _), (until, _)]| (*from..=*until).contains(&seconds))?;
        let part = (seconds - from) / (until - from).max(1e-9);
        Some([0, 1].map(|d| start[d] + part * (end[d] - start[d])))
    }
}

/// Every stop, with readings of this sigma, in radians.
///
/// # Errors
/// If a file cannot be read.
pub fn stops(directory: &Path, sigma: f64) -> Result<Vec<Stop>> {
    let sights = sights(directory, "stops.csv", |_| sigma)?;
    let stop = |row: [Option<f64>; 4]| {
        let [Some(from), Some(until), Some(x), Some(y)] = row else {
            return None;
        };
        let within = |(time, _, _): &&(f64, u8, Sight)| (from..until).contains(time);
        let sights = sights.iter().filter(within);
        Some(Stop {
            tag: [x, y],
            sights: sights.map(|(_, array, sight)| (*array, *sight)).collect(),
        })
    };
    let truth = rows::<4>(&directory.join("stops_truth.csv"))?;
    Ok(truth.into_iter().filter_map(stop).collect())
}

/// The walk of this name, with readings of a sigma in radians that may depend on the direction from the boresight.
///
/// # Errors
/// If a file cannot be read.
pub fn walk(directory: &Path, name: &str, sigma: impl Fn(f64) -> f64) -> Result<Walk> {
    let truth = rows::<4>(&directory.join(format!("{name}_truth.csv")))?;
    let mut way = Vec::new();
    for row in truth {
        if let [Some(from), until, Some(x), Some(y)] = row {
            way.push((from, [x, y]));
            way.extend(until.map(|until| (until, [x, y])));
        }
    }
    let sights = sights(directory, &format!("{name}.csv"), sigma)?;
    Ok(Walk {
        way,
        sights: (sights.into_iter())
            .map(|(_, array, sight)| (array, sight))
            .collect(),
    })
}

/// All readings of a file: seconds, the number of the array, and the bearing.
fn sights(
    directory: &Path,
    file: &str,
    sigma: impl Fn(f64) -> f64,
) -> Result<Vec<(f64, u8, Sight)>> {
    let mut arrays = BTreeMap::new();
    for row in rows::<4>(&directory.join("anchors.csv"))? {
        if let [Some(array), Some(x), Some(y), Some(boresight)] = row {
            let station = arrays.len() as u8;
            arrays.insert(array as u32, (station, [x, y], boresight));
        }
    }
    let packets = rows::<3>(&directory.join(file))?;
    let one = |packet: [Option<f64>; 3]| {
        let [Some(time), Some(array), Some(azimuth)] = packet else {
            return None;
        };
        let (station, position, boresight) = *arrays.get(&(array as u32))?;
        let sight = Sight {
            time_ms: (1e3 * time) as u32,
            position,
            bearing: (90.0 - boresight - azimuth).to_radians(),
            sigma: sigma(azimuth.to_radians()),
        };
        Some((time, station, sight))
    };
    Ok(packets.into_iter().filter_map(one).collect())
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
