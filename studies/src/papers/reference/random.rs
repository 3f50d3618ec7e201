//! Random geometries: 2 to 100 bearings with sigmas of 0.2 to 20 degrees.

use std::f64::consts::TAU;

use foxhunt_host::reference::Square;
use foxhunt_simulation::{Sight, random};
use rand::{Rng, RngExt};

use super::cases::{Case, faults};

/// Where the source is.
#[derive(Clone, Copy)]
enum Kind {
    /// Anywhere among the positions.
    Among,
    /// Very near one of the positions.
    Near,
    /// Many times farther than the positions are from each other.
    Far,
    /// Ahead of positions on a line that leads to it: the bearings are nearly parallel.
    Ahead,
}

const KINDS: [(&str, Kind); 4] = [
    ("among", Kind::Among),
    ("near", Kind::Near),
    ("far", Kind::Far),
    ("ahead", Kind::Ahead),
];

/// Every kind with each kind of fault.
pub fn cases(runs: u64, seed: u64) -> Vec<Case> {
    let mut cases = Vec::new();
    for (k, (kind_name, kind)) in (0..).zip(KINDS) {
        for (f, (fault_name, faults)) in (0..).zip(faults()) {
            cases.extend((0..runs).map(|run| {
                let mut rng = random::generator(seed ^ (k << 40) ^ (f << 48), run);
                let (mut sights, source) = geometry(kind, &mut rng);
                faults.spoil(&mut sights, &mut rng);
                Case {
                    group: format!("random.{kind_name}.{fault_name}"),
                    // Sides of eight kilometres, or of four times the distance of the source.
                    square: Square {
                        centre: [0.0; 2],
                        side: f64::max(8e3, 4.0 * source[0].hypot(source[1])),
                    },
                    sights,
                    faults,
                }
            }));
        }
    }
    cases
}

/// Positions within a kilometre, the bearings taken there, and the source.
fn geometry(kind: Kind, rng: &mut impl Rng) -> (Vec<Sight>, [f64; 2]) {
    let count = ratio(rng, 2.0, 100.0).round() as usize;
    let sigma = ratio(rng, 0.2, 20.0).to_radians();
    let mut positions: Vec<[f64; 2]> = (0..count)
        .map(|_| [0, 1].map(|_| rng.random_range(-500.0..500.0)))
        .collect();
    let around = |[x, y]: [f64; 2], range: f64, rng: &mut _| {
        let angle = RngExt::random_range(rng, 0.0..TAU);
        [x + range * angle.cos(), y + range * angle.sin()]
    };
    let source = match kind {
        Kind::Among => [0, 1].map(|_| rng.random_range(-800.0..800.0)),
        Kind::Near => {
            let range = ratio(rng, 0.3, 20.0);
            around(positions[0], range, rng)
        }
        Kind::Far => {
            let range = ratio(rng, 2e3, 2e4);
            around([0.0; 2], range, rng)
        }
        Kind::Ahead => {
            let source = around([0.0; 2], 1200.0, rng);
            for position in &mut positions {
                // Along the line by as much as it is east, beside it by a tenth of what it is north.
                let [along, beside] = [position[0] / 1200.0, 0.1 * position[1] / 1200.0];
                *position = [
                    along * source[0] - beside * source[1],
                    along * source[1] + beside * source[0],
                ];
            }
            source
        }
    };
    let sights = (positions.into_iter().zip(0..))
        .map(|(position, time_ms)| {
            let [x, y] = [0, 1].map(|d| source[d] - position[d]);
            Sight {
                time_ms,
                position,
                bearing: y.atan2(x) + sigma * random::normal(rng),
                sigma,
            }
        })
        .collect();
    (sights, source)
}

/// Any value between, each ratio as likely.
fn ratio(rng: &mut impl Rng, low: f64, high: f64) -> f64 {
    low * (high / low).powf(rng.random())
}
