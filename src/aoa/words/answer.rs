//! What is known of a source.

use crate::estimate::{Ellipse, Symmetric2};
use crate::math::larger;
use crate::snapshot::{Error, Reader, Value, Writer, by_value, value};

/// What a locator knows of the source.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Answer {
    /// The bearings do not say where it is.
    NotObservable(NotObservable),
    /// Where it is.
    Fix(Fix),
}

impl Answer {
    /// The answer before the first bearing.
    pub(in crate::aoa) const NOTHING: Self =
        Self::NotObservable(NotObservable::TooFewBearings { have: 0 });

    /// The fix, if there is one.
    pub const fn fix(&self) -> Option<Fix> {
        match self {
            Self::Fix(fix) => Some(*fix),
            Self::NotObservable(_) => None,
        }
    }

    /// How much farther the bearings must turn before there can be a fix, in radians; zero with a fix.
    pub(in crate::aoa) fn missing_angle(&self) -> f32 {
        /// Angle where it is not known how much is missing.
        const UNKNOWN: f32 = 0.1;
        /// Least missing angle, as a fraction of the needed one, where the angle suffices but the range is too uncertain.
        const LEAST: f32 = 0.25;
        match self {
            Self::Fix(_) => 0.0,
            Self::NotObservable(NotObservable::CrossingAngle {
                have_rad,
                needed_rad,
            }) => {
                let (missing, least) = (needed_rad - have_rad, LEAST * needed_rad);
                larger(missing, least)
            }
            Self::NotObservable(_) => UNKNOWN,
        }
    }
}

impl From<Result<Fix, NotObservable>> for Answer {
    fn from(result: Result<Fix, NotObservable>) -> Self {
        match result {
            Ok(fix) => Self::Fix(fix),
            Err(reason) => Self::NotObservable(reason),
        }
    }
}

/// Why there is no fix yet.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub enum NotObservable {
    /// There are fewer than two bearings.
    TooFewBearings {
        /// How many there are.
        have: u32,
    },
    /// The bearings cross at too small an angle, so that they might as well be parallel: drive on, across them.
    CrossingAngle {
        /// Angle between the halves of the bearings that stands out of their errors, in radians.
        have_rad: f32,
        /// Angle that their errors ask for, in radians. It falls with the number of bearings.
        needed_rad: f32,
    },
    /// The bearings do not meet in front of their receivers: drive on, or wait.
    NoIntersection,
    /// Several places fit, as the hypotheses say: drive so that they lie in different directions.
    SeveralPlaces {
        /// How many have at least a fiftieth of the probability.
        have: u32,
    },
    /// The range is not known well enough: drive nearer, or across the line of sight; or state a smaller range, if the source
    /// cannot be far away.
    WideRange {
        /// Standard deviation of the place, as a fraction of the range.
        have: f32,
        /// The largest that makes a fix.
        needed: f32,
    },
    /// Most bearings do not fit the best place: stations or readings contradict each other.
    Contradiction {
        /// Fraction of the bearings that are outliers there.
        outliers: f32,
    },
}

/// A located source.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Fix {
    /// Posterior mean, in metres east and north.
    pub position: [f32; 2],
    /// Posterior covariance, in square metres; includes the sampling error of the particles.
    pub covariance: Symmetric2,
    /// How many equally weighted particles the cloud is worth.
    pub effective_sample_size: f32,
    /// How many bearings the fix rests on.
    pub bearings: u32,
}

impl Fix {
    /// From the moments of a cloud that is worth `n` equally weighted particles.
    pub(in crate::aoa) fn of_cloud(
        position: [f32; 2],
        covariance: impl Into<Symmetric2>,
        n: f32,
        bearings: u32,
    ) -> Self {
        // The covariance of n samples about their own mean is small by 1 - 1/n, and that mean is off by 1/n of the
        // covariance.
        let sampling = if n > 2.0 {
            (1.0 + 1.0 / n) / (1.0 - 1.0 / n)
        } else {
            3.0
        };
        Self {
            position,
            covariance: covariance.into().scaled(sampling),
            effective_sample_size: n,
            bearings,
        }
    }

    /// The ellipse that holds the source with the given probability (0 to 1).
    pub fn ellipse(&self, probability: f32) -> Ellipse {
        Ellipse::of_normal(self.position, self.covariance, probability)
    }
}

/// A place where the source may be: a mode of the posterior, as it was when particles last moved.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Hypothesis {
    /// The mode, in metres east and north.
    pub position: [f32; 2],
    /// Inverse of the curvature at the mode, in square metres.
    pub covariance: Symmetric2,
    /// Probability of this hypothesis among all, by Laplace's approximation.
    pub probability: f32,
}

impl Hypothesis {
    /// The ellipse that holds the source with the given probability (0 to 1), if this hypothesis is right.
    pub fn ellipse(&self, probability: f32) -> Ellipse {
        Ellipse::of_normal(self.position, self.covariance, probability)
    }
}

/// The common error of all bearings of an antenna array.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Bias {
    /// Posterior mean, in radians: to be subtracted from a bearing.
    pub mean_rad: f32,
    /// Posterior standard deviation, in radians.
    pub sigma_rad: f32,
}

/// How many times as large as stated the standard deviations of bearings are, by the scatter of those that are not outliers.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct SigmaScale {
    /// Root of the posterior mean of its square: the factor that the stated ones are multiplied by.
    pub mean: f32,
    /// Posterior standard deviation.
    pub sigma: f32,
}

/// The kinds of bearings, each with its rate among many or its probability for one. They sum to one.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Mixture {
    /// Bearings that point at the source, but for their errors.
    pub direct: f32,
    /// Bearings that point away from it, as an array with a 180-degree ambiguity gives them.
    pub mirrored: f32,
    /// Bearings that say nothing of the source: reflections, other transmitters.
    pub outlier: f32,
}

impl Mixture {
    /// Of no bearings.
    pub(in crate::aoa) const ZERO: Self = Self {
        direct: 0.0,
        mirrored: 0.0,
        outlier: 0.0,
    };

    /// Rates of mirrored and outlier bearings; the others are direct.
    pub const fn new(mirrored: f32, outlier: f32) -> Self {
        Self {
            direct: 1.0 - mirrored - outlier,
            mirrored,
            outlier,
        }
    }

    /// The sum of all.
    pub(in crate::aoa) const fn total(&self) -> f32 {
        self.direct + self.mirrored + self.outlier
    }
}

/// One of the sources on a channel.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Source {
    /// A number that the source keeps for as long as it is tracked. It is used again after 65,536 others.
    pub identity: u16,
    /// The probability that there is such a source and that it is still heard, 0 to 1; a locator of one source takes it for
    /// granted.
    pub probability: f32,
    /// Where it is.
    pub fix: Fix,
    /// How it moves; `None` from a locator for stationary sources.
    pub motion: Option<Motion>,
}

/// How a source moves.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Motion {
    /// Probability that it moves now, rather than being stationary.
    pub moving: f32,
    /// Posterior mean of its velocity if it moves, in metres a second east and north.
    pub velocity_m_s: [f32; 2],
    /// Standard deviation of either component of the velocity, in metres a second.
    pub sigma_m_s: f32,
}

/// Particles that represent where a source may be.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Cloud<'a> {
    /// East coordinates, in metres.
    pub east: &'a [f32],
    /// North coordinates, in metres.
    pub north: &'a [f32],
    /// Weights, which sum to one.
    pub weights: &'a [f32],
}

value!(Fix {
    position,
    covariance,
    effective_sample_size,
    bearings,
});

value!(SigmaScale { mean, sigma });

value!(Mixture {
    direct,
    mirrored,
    outlier,
});

impl Value for NotObservable {
    const SIZE: usize = u8::SIZE + <[f32; 2]>::SIZE;

    fn write(&self, to: &mut Writer<'_>) {
        match self {
            Self::TooFewBearings { have } => (0u8, *have).write(to),
            Self::CrossingAngle {
                have_rad,
                needed_rad,
            } => (1u8, [*have_rad, *needed_rad]).write(to),
            Self::NoIntersection => 2u8.write(to),
            Self::SeveralPlaces { have } => (3u8, *have).write(to),
            Self::WideRange { have, needed } => (4u8, [*have, *needed]).write(to),
            Self::Contradiction { outliers } => (5u8, *outliers).write(to),
        }
    }

    fn read(from: &mut Reader<'_>) -> Result<Self, Error> {
        Ok(match u8::read(from)? {
            0 => Self::TooFewBearings {
                have: Value::read(from)?,
            },
            1 => {
                let [have_rad, needed_rad] = Value::read(from)?;
                Self::CrossingAngle {
                    have_rad,
                    needed_rad,
                }
            }
            2 => Self::NoIntersection,
            3 => Self::SeveralPlaces {
                have: Value::read(from)?,
            },
            4 => {
                let [have, needed] = Value::read(from)?;
                Self::WideRange { have, needed }
            }
            5 => Self::Contradiction {
                outliers: Value::read(from)?,
            },
            _ => return Err(Error::Malformed),
        })
    }
}

/// Whether it is a fix, and which answer.
impl Value for Answer {
    const SIZE: usize = bool::SIZE + Fix::SIZE;

    fn write(&self, to: &mut Writer<'_>) {
        match self {
            Self::Fix(fix) => (true, *fix).write(to),
            Self::NotObservable(reason) => (false, *reason).write(to),
        }
    }

    fn read(from: &mut Reader<'_>) -> Result<Self, Error> {
        Ok(if bool::read(from)? {
            Self::Fix(Value::read(from)?)
        } else {
            Self::NotObservable(Value::read(from)?)
        })
    }
}

by_value!(Answer, NotObservable);

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_answer_is_restored_as_it_was() {
        let crossing = NotObservable::CrossingAngle {
            have_rad: 0.1,
            needed_rad: 0.4,
        };
        let wide = NotObservable::WideRange {
            have: 0.5,
            needed: 0.25,
        };
        let reasons = [
            NotObservable::TooFewBearings { have: 1 },
            crossing,
            NotObservable::NoIntersection,
            NotObservable::SeveralPlaces { have: 3 },
            wide,
            NotObservable::Contradiction { outliers: 0.9 },
        ];
        let fix = Fix::of_cloud([7.0, -8.0], [[2.0, 0.5], [0.5, 1.0]], 40.0, 9);
        let answers = reasons.map(Answer::NotObservable).into_iter();
        for answer in answers.chain([Answer::Fix(fix)]) {
            let mut bytes = [0; Answer::SIZE];
            answer.write(&mut Writer::new(&mut bytes));
            assert_eq!(Answer::read(&mut Reader::new(&bytes)), Ok(answer));
        }
        assert!(NotObservable::read(&mut Reader::new(&[6; 9])).is_err());
    }

    #[test]
    fn what_is_missing_of_the_angle_is_at_least_a_quarter() {
        let crossing = |have_rad, needed_rad| NotObservable::CrossingAngle {
            have_rad,
            needed_rad,
        };
        for (reason, missing) in [
            (crossing(0.0, 0.4), 0.4),
            (crossing(0.1, 0.4), 0.3),
            (crossing(0.35, 0.4), 0.1),
            (crossing(0.5, 0.4), 0.1),
            (NotObservable::NoIntersection, 0.1),
        ] {
            let angle = Answer::NotObservable(reason).missing_angle();
            assert!((angle - missing).abs() < 1e-6, "{reason:?}: {angle}");
        }
        let fix = Fix::of_cloud([0.0; 2], Symmetric2::isotropic(1.0), 4.0, 9);
        assert_eq!(Answer::Fix(fix).missing_angle(), 0.0);
        // (1 + 1/4) / (1 - 1/4)
        assert!((fix.covariance.xx - 5.0 / 3.0).abs() < 1e-6);
        let few = Fix::of_cloud([0.0; 2], Symmetric2::isotropic(1.0), 2.0, 9);
        assert_eq!(few.covariance.yy, 3.0);
    }
}
