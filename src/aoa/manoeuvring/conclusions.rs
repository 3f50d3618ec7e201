//! The answer from both explanations.

use super::{Config, Manoeuvring, Phase};
use crate::aoa::core::{check_narrow, square_of_distance};
use crate::aoa::track::Stationary;
use crate::aoa::{Answer, Fix, Hypothesis, Motion};
use crate::math::{larger, sqrt};

/// Factor by which the relative range error of a moving source may exceed the limit for a first fix: more reports worse
/// fixes, less reports none while the range grows uncertain.
const SLACK: f32 = 2.0;

impl<L: Stationary, const K: usize, const N: usize> Manoeuvring<L, K, N> {
    /// How the source moves; `None` before the first fix, until time has passed since, and again after the source was lost for
    /// good.
    pub fn motion(&self) -> Option<Motion> {
        if !self.cloud.is_alive() {
            return None;
        }
        let (velocity_m_s, variance) = self.cloud.velocity();
        let moving = self.moved * (1.0 - self.cloud.stopped().probability);
        Some(Motion {
            moving: larger(moving, 0.0),
            velocity_m_s,
            sigma_m_s: sqrt(variance),
        })
    }

    /// Where the source is if it has moved, and while it departs, where it is otherwise.
    pub(super) fn hypotheses(&self) -> impl Iterator<Item = Hypothesis> {
        let (position, covariance) = self.cloud.position();
        let moved = Hypothesis {
            position,
            covariance,
            probability: self.moved,
        };
        let departing = self.phase == Phase::Departing;
        let stationary = self.stationary.fix().filter(|_| departing);
        let stationary = stationary.map(|fix| Hypothesis {
            position: fix.position,
            covariance: fix.covariance,
            probability: 1.0 - self.moved,
        });
        [Some(moved), stationary].into_iter().flatten()
    }

    pub(super) fn conclude(&self, config: &Config<L::Config>) -> Answer {
        if self.phase == Phase::Stationary {
            return match self.stationary.answer() {
                Answer::Fix(fix) => Answer::Fix(Fix {
                    bearings: self.bearings,
                    ..fix
                }),
                answer => answer,
            };
        }
        let (mut position, mut covariance) = self.cloud.position();
        if self.phase == Phase::Departing
            && let Some(stationary) = self.stationary.fix()
        {
            let p = 1.0 - self.moved;
            let ([sx, sy], [x, y]) = (stationary.position, position);
            let apart = [sx - x, sy - y];
            covariance = (covariance.scaled(1.0 - p))
                .plus(&stationary.covariance.scaled(p))
                .plus_outer(p * (1.0 - p), apart);
            position = [x + p * apart[0], y + p * apart[1]];
        }
        let n = self.cloud.effective_sample_size();
        let fix = Fix::of_cloud(position, covariance, n, self.bearings);
        let limit = SLACK * L::beliefs(&config.stationary).relative_range_sigma;
        let range = square_of_distance(position, self.latest_position());
        let narrow = check_narrow(fix.covariance.largest_eigenvalue(), range, limit);
        narrow.map(|()| fix).into()
    }
}
