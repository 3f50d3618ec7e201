//! The problems of the published experiments, ready made.
//!
//! Each has a source that stands still, receivers along a track and bearings with Gaussian errors: those of
//! [`foxhunt_problems::bearings`], for references in f64.

use foxhunt_problems::bearings;
use foxhunt_simulation::path::along;

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
    pub sigma: f64,
    /// Process noise that the published filter assumes, in square metres per step and axis. The
    /// source itself does not move.
    pub process: f64,
    /// Number of particles of the published filter.
    pub particles: usize,
}

impl Track {
    /// A straight line past the source (fish school paper, 2016).
    pub fn a1() -> Self {
        Self::of("A1", bearings::Track::A1)
    }

    /// An L round the source (fish school paper, 2016).
    pub fn a2() -> Self {
        Self::of("A2", bearings::Track::A2)
    }

    /// A line that heads for the source a little to its right.
    pub fn a3() -> Self {
        Self::a1().on("A3", &[[0.0, 0.0], [1000.0, 400.0]])
    }

    /// A short line far from the source.
    pub fn a4() -> Self {
        Self::a1().on("A4", &[[0.0, 0.0], [600.0, 0.0]])
    }

    /// A circle of 350 m round the source (fish school paper, 2016).
    pub fn a5() -> Self {
        Self::of("A5", bearings::Track::A5)
    }

    /// A longer line past the source.
    pub fn b1() -> Self {
        Self::b2().on("B1", &[[0.0, 0.0], [4000.0, 0.0]])
    }

    /// A larger L (firefly paper, 2017).
    pub fn b2() -> Self {
        Self::of("B2", bearings::Track::B2)
    }

    /// Those of the papers, and three with other ways to the same sources.
    pub fn all() -> [Self; 7] {
        [
            Self::a1(),
            Self::a2(),
            Self::a3(),
            Self::a4(),
            Self::a5(),
            Self::b1(),
            Self::b2(),
        ]
    }

    /// The same experiment along another line.
    fn on(self, name: &'static str, corners: &[[f64; 2]]) -> Self {
        let receivers = along(corners, self.receivers.len());
        Self {
            name,
            receivers,
            ..self
        }
    }

    /// The library's track, in f64.
    fn of(name: &'static str, track: bearings::Track) -> Self {
        Self {
            name,
            source: track.source().map(f64::from),
            receivers: (0..track.bearings())
                .map(|index| track.receiver(index).map(f64::from))
                .collect(),
            sigma: f64::from(track.variance()).sqrt(),
            process: f64::from(track.process_variance()),
            particles: track.particles(),
        }
    }
}
