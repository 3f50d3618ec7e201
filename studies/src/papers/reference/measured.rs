//! Bearings measured in rooms: those of robots on fixed transmitters, and those of fixed arrays on a tag at rest.

use std::{collections::BTreeMap, path::Path};

use anyhow::{Context, Result};
use foxhunt_host::{Sight, faults::Faults, measured::Measured, reference::Square};

use super::cases::{Case, faults};

const SETS: [(&str, &str); 2] = [("los", "los_set_a.csv"), ("nlos", "nlos_set_a.csv")];
const TRANSMITTERS: [&str; 3] = ["tx2", "tx3", "tx4"];
/// Sigmas of the bearings, in degrees: of those of robots, and of those of fixed arrays.
const SIGMAS: [f64; 2] = [3.0, 10.0];
/// As many packets of a stop are enough.
const PACKETS: usize = 100;

/// Every transmitter of both sets.
pub fn rooms(data: &Path) -> Result<Vec<Case>> {
    let mut cases = Vec::new();
    for (set, file) in SETS {
        for transmitter in TRANSMITTERS {
            let bearings = Measured::read(&data.join(file), transmitter)?.bearings;
            let sights: Vec<Sight> = bearings
                .into_iter()
                .map(|(position, degrees)| sight(position, degrees, SIGMAS[0]))
                .collect();
            cases.extend(with_faults(&format!("{set}.{transmitter}"), &sights));
        }
    }
    Ok(cases)
}

/// Every stop of the tag, with the packets of all arrays: those of one alone have no range.
pub fn stops(data: &Path) -> Result<Vec<Case>> {
    let mut arrays = BTreeMap::new();
    for row in rows::<4>(&data.join("anchors.csv"))? {
        if let [Some(array), Some(x), Some(y), Some(boresight)] = row {
            arrays.insert(array as u32, ([x, y], boresight));
        }
    }
    let packets = rows::<6>(&data.join("stops.csv"))?;
    let mut cases = Vec::new();
    for row in rows::<4>(&data.join("stops_truth.csv"))? {
        let [Some(from), Some(until), ..] = row else {
            continue;
        };
        let mut sights = Vec::new();
        for packet in &packets {
            if let [Some(time), Some(array), Some(azimuth), ..] = *packet
                && (from..until).contains(&time)
                && let Some((position, boresight)) = arrays.get(&(array as u32))
            {
                sights.push(sight(*position, 90.0 - boresight - azimuth, SIGMAS[1]));
            }
        }
        let sights: Vec<Sight> = (sights.iter().copied())
            .step_by(sights.len().div_ceil(PACKETS).max(1))
            .collect();
        cases.extend(with_faults("stops", &sights));
    }
    cases.sort_by(|a, b| a.group.cmp(&b.group));
    Ok(cases)
}

/// The same bearings, taken to have each kind of fault.
fn with_faults(name: &str, sights: &[Sight]) -> Vec<Case> {
    let case = |(kind, faults): (&str, Faults)| {
        Some(Case {
            group: format!("{name}.{kind}"),
            sights: sights.to_vec(),
            faults,
            square: Square::round(sights)?,
        })
    };
    faults().into_iter().filter_map(case).collect()
}

fn sight(position: [f64; 2], degrees: f64, sigma: f64) -> Sight {
    Sight {
        time_ms: 0,
        position,
        bearing: degrees.to_radians(),
        sigma: sigma.to_radians(),
    }
}

/// The first columns of a file of numbers, some of which are missing.
fn rows<const N: usize>(file: &Path) -> Result<Vec<[Option<f64>; N]>> {
    let text = std::fs::read_to_string(file).with_context(|| file.display().to_string())?;
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
