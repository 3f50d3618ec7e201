//! Biases of bearings: which have one in common, and what is known of them before.

use super::term::{BIASES, State};
use crate::aoa::{Bias, Observation};
use crate::kalman::Covariance;
use crate::math::vector::dot;
use crate::math::{atan2, larger, sin_cos, sqrt, wrap};
use crate::snapshot::value;

/// Which bearings have a bias in common. A locator of dimension `D` knows `D - 3` numbers of biases.
///
/// ```
/// use foxhunt::aoa::{Locator, Robust, robust::{Biases, Config, Errors}};
///
/// // An array on a roof, whose bearings are off by some five degrees that change with the direction: two harmonics.
/// const CONFIG: Config = Config {
///     errors: Errors { bias_sigma_rad: 0.09, biases: Biases::ByDirection, ..Errors::DEFAULT },
///     ..Config::DEFAULT
/// };
/// let locator = Locator::<Robust<256, 64, 8>>::new(CONFIG)?;
/// # Ok::<(), foxhunt::ConfigError>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Biases {
    /// All: one number.
    Common,
    /// Those of one station: a number each, by the station's own number. Stations beyond the last number have that one in
    /// common.
    PerStation,
    /// Those of one direction, as it is seen from the array, whose [heading](Observation::with_heading) is known: a constant
    /// and the cosine and sine of each harmonic. An array on a roof is off by such a curve; the standard deviation is that
    /// of the whole curve, in every direction.
    ByDirection,
}

impl Biases {
    /// Derivatives of the error of a bearing by the numbers of a state, for biases of a standard deviation in radians; zero
    /// for place and scale.
    ///
    /// Directions are those of the source where it is thought to be, for a bearing that is off is that in another one.
    #[inline(never)]
    pub(super) fn features<const D: usize>(
        self,
        observation: &Observation,
        sigma: f32,
        source: Option<[f32; 2]>,
    ) -> State<D> {
        let mut features = [0.0; D];
        let Some(numbers) = features.get_mut(BIASES..) else {
            return features;
        };
        let last = numbers.len().saturating_sub(1);
        match self {
            Self::Common => set(numbers, 0, sigma),
            Self::PerStation => set(numbers, usize::from(observation.station()).min(last), sigma),
            Self::ByDirection => {
                let harmonics = last / 2;
                let each = sigma / sqrt(1.0 + harmonics as f32);
                let turn = wrap(direction(observation, source) - observation.heading().radians());
                set(numbers, 0, each);
                for harmonic in 0..harmonics {
                    let (sin, cos) = sin_cos(wrap((harmonic + 1) as f32 * turn));
                    set(numbers, 2 * harmonic + 1, each * cos);
                    set(numbers, 2 * harmonic + 2, each * sin);
                }
            }
        }
        features
    }
}

/// That of the source from where a bearing was taken; the bearing itself as long as it is not known where that is.
fn direction(observation: &Observation, source: Option<[f32; 2]>) -> f32 {
    let [x, y] = observation.position();
    source.map_or(observation.bearing().radians(), |[east, north]| {
        atan2(north - y, east - x)
    })
}

fn set(numbers: &mut [f32], place: usize, value: f32) {
    if let Some(number) = numbers.get_mut(place) {
        *number = value;
    }
}

/// What is known of the numbers of biases before any bearing: a normal distribution, in prior sigmas. All bits are zero where
/// they have their priors.
#[derive(Debug, Clone, Copy)]
pub(super) struct Known<const D: usize> {
    is_more: bool,
    mean: State<D>,
    covariance: Covariance<D>,
}

value!(impl[const D: usize] Known<D> as "robust::Known", { is_more, mean, covariance });

impl<const D: usize> Known<D> {
    pub(super) const NOTHING: Self = Self {
        is_more: false,
        mean: [0.0; D],
        covariance: Covariance::ZERO,
    };

    /// Derivatives of the error of a bearing by the numbers of a state, which are what is left unknown of the biases in
    /// sigmas; and how far the bearing is off by what is known.
    #[inline(never)]
    pub(super) fn features(
        &self,
        observation: &Observation,
        (biases, sigma): (Biases, f32),
        source: Option<[f32; 2]>,
    ) -> (State<D>, f32) {
        let prior: State<D> = biases.features(observation, sigma, source);
        if !self.is_more {
            return (prior, 0.0);
        }
        let columns = self.covariance.columns();
        let mut features = columns.map(|column| dot(column, prior));
        for feature in features.iter_mut().take(BIASES) {
            *feature = 0.0;
        }
        (features, dot(self.mean, prior))
    }

    /// Goes on with what a state of this mean and covariance has taught.
    #[inline(never)]
    pub(super) fn learn(&mut self, mean: &State<D>, covariance: &[State<D>; D]) {
        let mut learned = Self::NOTHING;
        learned.is_more = true;
        let mut matrix = [[0.0; D]; D];
        // A product of the old factor, or of the identity, on both sides.
        for (row, i) in matrix.iter_mut().zip(0..).skip(BIASES) {
            for (entry, j) in row.iter_mut().zip(0..).skip(BIASES) {
                let (a, b) = (self.row(i), self.row(j));
                *entry = dot(covariance.map(|row| dot(row, b)), a);
            }
        }
        for (value, i) in learned.mean.iter_mut().zip(0..).skip(BIASES) {
            *value = self.mean.get(i).copied().unwrap_or(0.0) + dot(self.row(i), *mean);
        }
        if let Some(covariance) = Covariance::new(&matrix) {
            learned.covariance = covariance;
            *self = learned;
        }
    }

    /// How one number of the biases depends on the numbers of a state.
    fn row(&self, i: usize) -> State<D> {
        let mut row = [0.0; D];
        if self.is_more {
            for (entry, column) in row.iter_mut().zip(self.covariance.columns()) {
                *entry = column.get(i).copied().unwrap_or(0.0);
            }
        } else {
            set(&mut row, i, 1.0);
        }
        row
    }

    /// The bias of a bearing, if states have this mean and covariance.
    #[inline(never)]
    pub(super) fn bias(
        &self,
        observation: &Observation,
        biases: (Biases, f32),
        (mean, covariance): &(State<D>, [State<D>; D]),
    ) -> Bias {
        let source = Some([mean[0], mean[1]]);
        let (features, offset) = self.features(observation, biases, source);
        let variance = dot(covariance.map(|row| dot(row, features)), features);
        Bias {
            mean_rad: offset + dot(features, *mean),
            sigma_rad: sqrt(larger(variance, 0.0)),
        }
    }
}
