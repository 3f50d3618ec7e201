//! What a tracker knows of a tag.

use crate::estimate::{Ellipse, Symmetric2};
use crate::math::sqrt;
use crate::snapshot::{value, value_as};

/// How reliable a place is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub enum State {
    /// It is where the fix says.
    Tracking,
    /// The fix is the mean of places too far apart: its sigma is above [`super::Config::uncertain_sigma_m`].
    Uncertain,
    /// The evidence has gone against the particles, and some or all were just drawn anew.
    Lost,
    /// It was lost, and the evidence has supported the particles since then, but not for long.
    Recovered,
}

/// Where a tag is.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Fix {
    /// When it was there: the mean time of the packets of the last update.
    pub time_ms: u32,
    /// How reliable the place is.
    pub state: State,
    /// Posterior mean in metres. On a map of one row or column, the other coordinate is that of its points.
    pub position: [f32; 2],
    /// Posterior covariance in square metres.
    pub covariance: Symmetric2,
    /// Posterior mean in metres a second.
    pub velocity: [f32; 2],
    /// By how many dB the tag reads stronger than the one of the survey: the posterior mean.
    pub offset_db: f32,
    /// How many equally weighted particles the cloud is worth.
    pub effective_sample_size: f32,
}

impl Fix {
    pub(super) const EMPTY: Self = Self {
        time_ms: 0,
        state: State::Tracking,
        position: [0.0; 2],
        covariance: Symmetric2::ZERO,
        velocity: [0.0; 2],
        offset_db: 0.0,
        effective_sample_size: 0.0,
    };

    /// The region that holds the tag with the given probability (0 to 1), if the posterior is normal: an ellipse, or on a map
    /// of one row or column a segment.
    pub fn ellipse(&self, probability: f32) -> Ellipse {
        Ellipse::of_normal(self.position, self.covariance, probability)
    }

    /// Whether a place is in the region that holds the tag with the given probability. On a map of one row or column only the
    /// place along it is judged: how far from that line people walk is not tracked.
    pub fn contains(&self, place: [f32; 2], probability: f32) -> bool {
        let Symmetric2 { xx, yy, .. } = self.covariance;
        let region = self.ellipse(probability);
        let [x, y] = self.position;
        if yy == 0.0 {
            (place[0] - x).abs() <= region.semi_major
        } else if xx == 0.0 {
            (place[1] - y).abs() <= region.semi_major
        } else {
            region.contains(place)
        }
    }

    /// The place at another time if the velocity stays.
    pub fn position_at(&self, time_ms: u32) -> [f32; 2] {
        let seconds = seconds(time_ms.wrapping_sub(self.time_ms) as i32);
        [
            self.position[0] + seconds * self.velocity[0],
            self.position[1] + seconds * self.velocity[1],
        ]
    }

    /// Standard deviation along the longest axis, in metres.
    pub fn sigma_m(&self) -> f32 {
        sqrt(self.covariance.largest_eigenvalue())
    }
}

value!(Fix {
    time_ms,
    state,
    position,
    covariance,
    velocity,
    offset_db,
    effective_sample_size
});

value_as!(State as u8: |state| *state as u8, |code| {
    let states = [Self::Tracking, Self::Uncertain, Self::Lost, Self::Recovered];
    states.get(usize::from(code)).copied()
});

pub(super) fn seconds(milliseconds: i32) -> f32 {
    1e-3 * milliseconds as f32
}
