//! What is said of the source.

use super::Pursuit;
use super::component::matrix;
use super::phases::Phase;
use crate::aoa::Observation;
use crate::aoa::advice::{Advice, Belief};
use crate::aoa::locate::{Cloud, Locate, Motion, Source};
use crate::aoa::locator::{Answer, Fix, NotObservable};
use crate::aoa::robust::{Bias, Hypothesis, Shares};
use crate::estimate::largest_variance;
use crate::math::sqrt;
use crate::random::Rng;

impl<const N: usize, const B: usize> Pursuit<N, B> {
    /// How the source moves; `None` before the first fix, until time has passed since, and again after the source was lost for
    /// good.
    pub fn motion(&self) -> Option<Motion> {
        if !self.cloud.is_alive() {
            return None;
        }
        let (velocity, variance) = self.cloud.velocity();
        let moving = (1.0 - self.parked) * (1.0 - self.cloud.at_rest().share);
        Some(Motion {
            moving: if moving > 0.0 { moving } else { 0.0 },
            velocity,
            deviation: sqrt(variance),
        })
    }

    /// Of a source that may have moved: where it is if it has, and where it is parked otherwise.
    fn hypotheses(&self) -> impl Iterator<Item = Hypothesis> {
        let (position, spread) = self.cloud.place();
        let moved = Hypothesis {
            position,
            covariance: matrix(spread),
            mass: 1.0 - self.parked,
        };
        let parked = match self.locator.answer() {
            Answer::Fix(fix) if self.phase == Phase::Departing => Some(Hypothesis {
                position: fix.position,
                covariance: fix.covariance,
                mass: self.parked,
            }),
            _ => None,
        };
        [Some(moved), parked].into_iter().flatten()
    }

    pub(super) fn conclude(&self) -> Answer {
        if self.phase == Phase::Parked {
            return match self.locator.answer() {
                Answer::Fix(fix) => Answer::Fix(Fix {
                    bearings: self.bearings,
                    ..fix
                }),
                answer => answer,
            };
        }
        let (mut position, spread) = self.cloud.place();
        let mut covariance = matrix(spread);
        if self.phase == Phase::Departing
            && let Answer::Fix(parked) = self.locator.answer()
        {
            let share = self.parked;
            let apart = [0, 1].map(|d: usize| parked.position[d] - position[d]);
            for (a, row) in covariance.iter_mut().enumerate() {
                for (b, entry) in row.iter_mut().enumerate() {
                    let between = share * (1.0 - share) * apart[a] * apart[b];
                    *entry += share * (parked.covariance[a][b] - *entry) + between;
                }
            }
            position = [0, 1].map(|d: usize| position[d] + share * apart[d]);
        }
        let n = self.cloud.effective_sample_size();
        let fix = Fix::of_cloud(position, covariance, n, self.bearings);
        let limit = 2.0 * self.settings.locator.relative_range_error();
        let latest = self.recent.place();
        let (dx, dy) = (position[0] - latest[0], position[1] - latest[1]);
        if largest_variance(&fix.covariance) <= limit * limit * (dx * dx + dy * dy) {
            Answer::Fix(fix)
        } else {
            Answer::NotObservable(NotObservable::NoIntersection)
        }
    }
}

impl<const N: usize, const B: usize> Locate for Pursuit<N, B> {
    fn push_after<R: Rng + ?Sized>(
        &mut self,
        observation: Observation,
        seconds: f32,
        rng: &mut R,
    ) -> Answer {
        self.push_after(observation, seconds, rng)
    }

    fn answer(&self) -> Answer {
        self.answer
    }

    fn reset(&mut self) {
        self.reset();
    }

    fn source(&self, index: usize) -> Option<Source> {
        match self.answer {
            Answer::Fix(fix) if index == 0 => Some(Source {
                identity: 0,
                fix,
                motion: self.motion(),
            }),
            _ => None,
        }
    }

    fn hypothesis(&self, index: usize) -> Option<Hypothesis> {
        if self.phase == Phase::Parked {
            self.locator.hypotheses().nth(index)
        } else {
            self.hypotheses().nth(index)
        }
    }

    fn bias(&self) -> Option<Bias> {
        let Answer::Fix(_) = self.answer else {
            return None;
        };
        if self.phase == Phase::Parked {
            return self.locator.bias();
        }
        let (offset, scale) = (self.cloud.offset, self.errors.bias_scale());
        Some(Bias {
            mean: scale * offset.mean,
            deviation: scale * sqrt(offset.variance),
        })
    }

    fn advice(&self) -> Option<Advice> {
        if self.phase == Phase::Parked {
            return self.locator.advice();
        }
        let latest = self.recent.latest()?;
        Belief::of_hypotheses(self.hypotheses(), latest.position())
            .advice(latest, self.answer.missing_angle())
    }

    fn classify(&self, observation: &Observation) -> Option<Shares> {
        if self.phase == Phase::Parked {
            return self.locator.classify(observation);
        }
        let Answer::Fix(_) = self.answer else {
            return None;
        };
        let mut shares = self.cloud.classify(observation, &self.errors);
        if self.phase == Phase::Departing
            && let Some(parked) = self.locator.classify(observation)
        {
            shares.direct += self.parked * (parked.direct - shares.direct);
            shares.mirror += self.parked * (parked.mirror - shares.mirror);
            shares.wild += self.parked * (parked.wild - shares.wild);
        }
        Some(shares)
    }

    /// While it is parked. What moves is of no particles, but its [`hypothesis`](Locate::hypothesis) is that of a fix.
    fn cloud(&self, index: usize) -> Option<Cloud<'_>> {
        if self.phase == Phase::Parked {
            self.locator.cloud(index)
        } else {
            None
        }
    }

    fn shares(&self) -> Option<Shares> {
        Some(self.errors.shares_now())
    }
}
