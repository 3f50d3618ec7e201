//! What a tracker says.

use crate::estimate::{Ellipse, largest_variance};
use crate::math::sqrt;

/// How far a place is to be trusted.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub enum State {
    /// It is where the fix says.
    Tracking,
    /// The fix is the mean of places too far apart: the deviation is above [`super::Settings::with_uncertain_m`].
    #[default]
    Uncertain,
    /// The evidence has gone against all particles, and some or all were just drawn anew.
    Lost,
    /// It was lost, and the evidence has been for the particles since, but not for long.
    Recovered,
}

/// Where a tag is.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Fix {
    /// When it was there: the mean time of the packets of the last update.
    pub time_ms: u32,
    /// How far it is to be trusted.
    pub state: State,
    /// Posterior mean in metres. A map of one row knows nothing of y.
    pub position: [f32; 2],
    /// Posterior covariance in square metres.
    pub covariance: [[f32; 2]; 2],
    /// Posterior mean in metres a second.
    pub velocity: [f32; 2],
    /// By how many dB the tag reads stronger than the one of the survey: the posterior mean.
    pub offset_db: f32,
    /// How many equally weighted particles the cloud was worth.
    pub effective_sample_size: f32,
}

impl Fix {
    /// The ellipse that holds the tag with the given probability (0 to 1), if the posterior is normal.
    pub fn ellipse(&self, probability: f32) -> Ellipse {
        Ellipse::of_normal(self.position, self.covariance, probability)
    }

    /// Where it is at another time, if it goes on as it did.
    pub fn position_at(&self, time_ms: u32) -> [f32; 2] {
        let seconds = seconds(time_ms.wrapping_sub(self.time_ms) as i32);
        [
            self.position[0] + seconds * self.velocity[0],
            self.position[1] + seconds * self.velocity[1],
        ]
    }

    /// Standard deviation along the longest axis, in metres.
    pub fn deviation(&self) -> f32 {
        sqrt(largest_variance(&self.covariance))
    }
}

pub(super) fn seconds(milliseconds: i32) -> f32 {
    1e-3 * milliseconds as f32
}
