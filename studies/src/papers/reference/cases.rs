//! What is compared, and the tracks of it.

use foxhunt_host::{reference::Square, simulate, tracks::Track};
use foxhunt_simulation::{Sight, faults::Faults, random};

/// Bearings, and what is known of them.
pub struct Case {
    /// What they are, and their faults: dotted, for the figures.
    pub group: String,
    pub sights: Vec<Sight>,
    pub faults: Faults,
    /// Where the source is sought.
    pub square: Square,
}

impl Case {
    /// So many cells a side of a grid take a second or two.
    pub fn finest(&self) -> usize {
        match self.sights.len() {
            0..=20 => 1024,
            _ => 512,
        }
    }
}

/// Each kind of fault with its name.
pub fn faults() -> [(&'static str, Faults); 5] {
    let faults = |outlier_rate, mirrored_rate, degrees: f64| Faults {
        outlier_rate,
        mirrored_rate,
        bias_sigma: degrees.to_radians(),
    };
    [
        ("clean", faults(0.0, 0.0, 0.0)),
        ("outliers30", faults(0.3, 0.0, 0.0)),
        ("mirrored50", faults(0.0, 0.5, 0.0)),
        ("mixed", faults(0.1, 0.2, 0.0)),
        ("bias3", faults(0.0, 0.0, 3.0)),
    ]
}

/// Every track with each kind of fault.
pub fn tracks(runs: u64, seed: u64) -> Vec<Case> {
    let mut cases = Vec::new();
    for track in Track::all() {
        for (name, faults) in faults() {
            cases.extend((0..runs).filter_map(|run| {
                let mut sights = simulate::bearings(&track, &mut random::generator(seed, run));
                faults.spoil(&mut sights, &mut random::generator(!seed, run));
                Some(Case {
                    group: format!("{}.{name}", track.name.to_lowercase()),
                    square: Square::round(&sights)?,
                    sights,
                    faults,
                })
            }));
        }
    }
    cases
}
