//! What is said of the source.

use heapless::Deque;

use super::cloud::Cloud;
use super::drive::Drive;
use super::{Config, Lost, Manoeuvring, Phase, seconds};
use crate::ConfigError;
use crate::aoa::core::{is_narrow, square_of_distance};
use crate::aoa::robust::{self, Candidate, Errors, Learned};
use crate::aoa::track::{Stationary, Track};
use crate::aoa::words::Belief;
use crate::aoa::{
    Advice, Answer, Bias, Fix, Hypothesis, Locate, Mixture, Motion, NotObservable, Observation,
    PushError, SigmaScale, Source,
};
use crate::math::sqrt;
use crate::random::Rng;

/// How many times the greatest relative range error of a first fix that of a moving source may be: more reports worse fixes,
/// fewer report none while the range grows uncertain.
const SLACK: f32 = 2.0;

impl<L: Stationary> Manoeuvring<L> {
    /// How the source moves; `None` before the first fix, until time has passed since, and again after the source was lost for
    /// good.
    pub fn motion(&self) -> Option<Motion> {
        if !self.cloud.is_alive() {
            return None;
        }
        let (velocity_m_s, variance) = self.cloud.velocity();
        let moving = self.moved * (1.0 - self.cloud.stopped().probability);
        Some(Motion {
            moving: if moving > 0.0 { moving } else { 0.0 },
            velocity_m_s,
            sigma_m_s: sqrt(variance),
        })
    }

    /// Of a source that may have moved: where it is if it has, and where it is otherwise.
    fn hypotheses(&self) -> impl Iterator<Item = Hypothesis> {
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
        let limit = SLACK * L::beliefs(&config.track).relative_range_sigma;
        let range = square_of_distance(position, self.latest_position());
        if is_narrow(fix.covariance.largest_eigenvalue(), range, limit) {
            Answer::Fix(fix)
        } else {
            Answer::NotObservable(NotObservable::NoIntersection)
        }
    }
}

impl<L: Stationary> Locate for Manoeuvring<L> {
    type Config = Config<L::Config>;

    const EMPTY: Self = Self {
        stationary: L::EMPTY,
        learned: Learned::NOTHING,
        cloud: Cloud::EMPTY,
        moved: 0.0,
        phase: Phase::Stationary,
        recent: Deque::new(),
        misfit: 0.0,
        tries: 0,
        lost: Lost::NOT,
        seen: None,
        bearings: 0,
        answer: Answer::NOTHING,
    };

    fn check(config: &Self::Config) -> Result<(), ConfigError> {
        L::check(&config.track)?;
        config.check_own()
    }

    /// Takes what the stationary locator takes for it, and a step of a Kalman filter of each of 128 normal distributions. The
    /// stationary locator comes first: it may refuse the bearing.
    fn push<R: Rng + ?Sized>(
        &mut self,
        observation: &Observation,
        config: &Self::Config,
        rng: &mut R,
    ) -> Result<Answer, PushError> {
        let elapsed_ms =
            (self.stationary.latest()).map_or(0, |latest| observation.since_ms(latest.time_ms()));
        let (place, had_fix) = (self.stationary.moments(), self.stationary.fix().is_some());
        self.stationary.push(observation, &config.track, rng)?;
        self.bearings = self.bearings.saturating_add(1);
        if elapsed_ms >= 0 {
            let errors = self.errors(config);
            let fresh = self.remember(observation, &errors);
            if had_fix || self.cloud.is_alive() {
                let drive = Drive::new(config, seconds(elapsed_ms));
                self.let_time_pass(&drive, &place, rng);
                self.weigh(&fresh, &place, &errors);
                self.search(&fresh, &drive, config, rng);
            }
        }
        self.update_phase(config);
        self.answer = self.conclude(config);
        if let Answer::Fix(fix) = self.answer
            && self.lost.bearings == 0
        {
            self.seen = Some(fix);
        }
        Ok(self.answer)
    }

    fn answer(&self) -> Answer {
        self.answer
    }

    fn reset(&mut self) {
        self.stationary.reset();
        self.learned = Learned::NOTHING;
        self.cloud.clear();
        self.moved = 0.0;
        self.phase = Phase::Stationary;
        self.recent.clear();
        (self.misfit, self.tries, self.lost, self.seen) = (0.0, 0, Lost::NOT, None);
        (self.bearings, self.answer) = (0, Answer::NOTHING);
    }

    fn source(&self, index: usize) -> Option<Source> {
        let fix = self.answer.fix().filter(|_| index == 0)?;
        Some(Source {
            identity: 0,
            fix,
            motion: self.motion(),
        })
    }

    fn hypothesis(&self, index: usize) -> Option<Hypothesis> {
        if self.phase == Phase::Stationary {
            self.stationary.hypothesis(index)
        } else {
            self.hypotheses().nth(index)
        }
    }

    fn bias(&self, config: &Self::Config) -> Option<Bias> {
        self.answer.fix()?;
        if self.phase == Phase::Stationary {
            return self.stationary.bias(&config.track);
        }
        let (bias, scale) = (self.cloud.bias, self.errors(config).bias_sigma_rad);
        Some(Bias {
            mean_rad: scale * bias.mean,
            sigma_rad: scale * sqrt(bias.variance),
        })
    }

    fn rates(&self, config: &Self::Config) -> Option<Mixture> {
        Some(self.errors(config).rates)
    }

    fn sigma_scale(&self, config: &Self::Config) -> Option<SigmaScale> {
        let known = self.stationary.sigma_scale(&config.track)?;
        Some(if self.learned.sigma_scale.mean > 0.0 {
            self.learned.sigma_scale
        } else {
            known
        })
    }

    fn advice(&self, config: &Self::Config) -> Option<Advice> {
        if self.phase == Phase::Stationary {
            return self.stationary.advice(&config.track);
        }
        let latest = self.recent.back()?;
        Belief::of_hypotheses(self.hypotheses(), latest, L::beliefs(&config.track).range_m)
            .advice(latest, self.answer.missing_angle())
    }

    fn classify(&self, observation: &Observation, config: &Self::Config) -> Option<Mixture> {
        let stationary = |track: &L| track.classify(observation, &config.track);
        if self.phase == Phase::Stationary {
            return stationary(&self.stationary);
        }
        self.answer.fix()?;
        let mut mixture = self.cloud.classify(observation, &self.errors(config));
        if self.phase == Phase::Departing
            && let Some(other) = stationary(&self.stationary)
        {
            let p = 1.0 - self.moved;
            mixture.direct += p * (other.direct - mixture.direct);
            mixture.mirrored += p * (other.mirrored - mixture.mirrored);
            mixture.outlier += p * (other.outlier - mixture.outlier);
        }
        Some(mixture)
    }

    /// The particles while the source is stationary. A moving source has none, but its [`hypothesis`](Locate::hypothesis)
    /// is that of the fix.
    fn cloud(&self, index: usize) -> Option<crate::aoa::Cloud<'_>> {
        if self.phase == Phase::Stationary {
            self.stationary.cloud(index)
        } else {
            None
        }
    }
}

impl<L: Stationary> Track for Manoeuvring<L> {
    fn beliefs(config: &Self::Config) -> robust::Config {
        L::beliefs(&config.track)
    }

    fn errors(&self, config: &Self::Config) -> Errors {
        L::beliefs(&config.track).errors.with(&self.learned)
    }

    fn latest(&self) -> Option<&Observation> {
        self.stationary.latest()
    }

    fn initiate<R: Rng + ?Sized>(
        &mut self,
        candidate: &Candidate<'_>,
        config: &Self::Config,
        rng: &mut R,
    ) -> Answer {
        self.reset();
        (self.stationary).initiate(candidate, &config.track, rng);
        self.bearings = candidate.observations().count() as u32;
        self.answer = self.conclude(config);
        self.answer
    }

    fn odds(&self, observation: &Observation, config: &Self::Config) -> f32 {
        let stationary = if self.may_be_stationary() {
            (1.0 - self.moved) * self.stationary.odds(observation, &config.track)
        } else {
            0.0
        };
        let elapsed_ms = self
            .latest()
            .map_or(0, |latest| observation.since_ms(latest.time_ms()));
        let elapsed = seconds(elapsed_ms.max(0));
        stationary + self.moved * self.cloud.odds(observation, &self.errors(config), elapsed)
    }

    fn set_outliers_removed(&mut self, per_bearing: f32) {
        self.stationary.set_outliers_removed(per_bearing);
    }
}
