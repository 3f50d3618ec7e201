//! Bearings measured in rooms: those of robots on fixed transmitters, and those of fixed arrays on a tag at rest.

use std::path::Path;

use anyhow::Result;
use foxhunt_host::{measured::Measured, reference::Square, xplr};
use foxhunt_simulation::{Sight, faults::Faults};

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
    let mut cases = Vec::new();
    for stop in xplr::stops(data, SIGMAS[1].to_radians())? {
        let step = stop.sights.len().div_ceil(PACKETS).max(1);
        let sights = stop.sights.iter().map(|(_, sight)| *sight);
        let sights: Vec<Sight> = sights.step_by(step).collect();
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
