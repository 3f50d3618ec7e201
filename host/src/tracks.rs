//! The problems of the published experiments, ready made.
//!
//! Each has a source that stands still, receivers along a track and bearings with Gaussian errors.
//! The papers print their tracks as pictures only; these are ours, of the same size.

use std::f64::consts::TAU;

/// A source and the places from which its bearing is taken.
#[derive(Debug, Clone, PartialEq)]
pub struct Track {
    /// Short name, as in the tables.
    pub name: &'static str,
    /// Where the source is, in metres east and north.
    pub source: [f64; 2],
    /// Where the bearings are taken, in order, in metres east and north.
    pub receivers: Vec<[f64; 2]>,
    /// Standard deviation of the bearings, in radians.
    pub deviation: f64,
    /// Process noise that the published filter assumes, in square metres per step and axis. The
    /// source itself does not move.
    pub process: f64,
    /// Number of particles of the published filter.
    pub particles: usize,
}

impl Track {
    /// A straight line past the source (fish school paper, 2016).
    pub fn a1() -> Self {
        Self::fish("A1", along(&[[0.0, 0.0], [1500.0, 0.0]], 60))
    }

    /// An L round the source (fish school paper, 2016).
    pub fn a2() -> Self {
        Self::fish(
            "A2",
            along(&[[0.0, 0.0], [1500.0, 0.0], [1500.0, 1500.0]], 60),
        )
    }

    /// A circle of 350 m round the source (fish school paper, 2016).
    pub fn a5() -> Self {
        let place = |k: u32| {
            let (sin, cos) = (TAU * f64::from(k) / 60.0).sin_cos();
            [1200.0 + 350.0 * cos, 800.0 + 350.0 * sin]
        };
        Self::fish("A5", (0..60).map(place).collect())
    }

    /// A larger L (firefly paper, 2017).
    pub fn b2() -> Self {
        Self {
            name: "B2",
            source: [3000.0, 2200.0],
            receivers: along(&[[0.0, 0.0], [4000.0, 0.0], [4000.0, 2000.0]], 40),
            deviation: 3.8e-4_f64.sqrt(),
            process: 5.0,
            particles: 80,
        }
    }

    fn fish(name: &'static str, receivers: Vec<[f64; 2]>) -> Self {
        Self {
            name,
            source: [1200.0, 800.0],
            receivers,
            deviation: 3.801e-4_f64.sqrt(),
            process: 1.0,
            particles: 100,
        }
    }
}

/// `count` places at equal distances along the line through `corners`, both ends included.
pub fn along(corners: &[[f64; 2]], count: usize) -> Vec<[f64; 2]> {
    let lengths: Vec<f64> = corners
        .windows(2)
        .map(|leg| (leg[1][0] - leg[0][0]).hypot(leg[1][1] - leg[0][1]))
        .collect();
    let step = lengths.iter().sum::<f64>() / (count.max(2) - 1) as f64;
    (0..count)
        .map(|k| {
            let mut rest = step * k as f64;
            let mut leg = 0;
            while leg + 1 < lengths.len() && rest > lengths[leg] {
                rest -= lengths[leg];
                leg += 1;
            }
            let part = rest / lengths[leg];
            let (from, to) = (corners[leg], corners[leg + 1]);
            [
                from[0] + part * (to[0] - from[0]),
                from[1] + part * (to[1] - from[1]),
            ]
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn places_are_equally_spaced_round_the_corner() {
        let places = along(&[[0.0, 0.0], [2.0, 0.0], [2.0, 2.0]], 5);
        assert_eq!(
            places,
            [[0.0, 0.0], [1.0, 0.0], [2.0, 0.0], [2.0, 1.0], [2.0, 2.0]]
        );
    }
}
