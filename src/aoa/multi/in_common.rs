//! What the bearings of several sources have in common at one place: an error, as that of a compass there.

use crate::aoa::robust::MODES;
use crate::aoa::track::OffBy;
use crate::aoa::words::Correction;
use crate::math::larger;
use crate::snapshot::{by_value, value_as};

/// Pairs of bearings that the prior of the variance of the errors in common counts for, which is that there are none: less
/// takes chance for such errors, more learns of them later.
const PAIRS: f32 = 4.0;

/// How far the revision has come, and what it has learned. All bits of a new one are zero.
#[derive(Debug, Clone, Copy)]
pub(super) struct Revision {
    /// The next entry: number of its track, or that of tracks for the unassociated ones, and its index.
    pub(super) place: u16,
    pub(super) index: u16,
    /// Variance of the errors that all sources' bearings of one place have in common, in square radians.
    pub(super) variance: f32,
    /// Sums over the places since the first entry: of the products of errors of two sources, and of what they count for.
    pub(super) products: f32,
    pub(super) pairs: f32,
}

value_as!(Revision as ((u16, u16), [f32; 3]):
    |taken| ((taken.place, taken.index), [taken.variance, taken.products, taken.pairs]),
    |((place, index), [variance, products, pairs])| {
        let all = [variance, products, pairs];
        let is_one = all.iter().all(|one| one.is_finite()) && variance >= 0.0 && pairs >= 0.0;
        is_one.then_some(Self { place, index, variance, products, pairs })
    },
);

by_value!(Revision);

impl Revision {
    pub(super) const NEW: Self = Self {
        place: 0,
        index: 0,
        variance: 0.0,
        products: 0.0,
        pairs: 0.0,
    };

    /// All entries have been looked at once more.
    pub(super) fn begin_again(&mut self) {
        let variance = self.products / (self.pairs + PAIRS);
        *self = Self {
            variance: larger(variance, 0.0),
            ..Self::NEW
        };
    }
}

/// What the bearings of one source at one place say of the error that they have in common with those of others.
#[derive(Clone, Copy)]
pub(super) struct Sum {
    precision: f32,
    /// The mean, times that.
    error: f32,
    probability: f32,
}

impl Sum {
    const NOTHING: Self = Self {
        precision: 0.0,
        error: 0.0,
        probability: 0.0,
    };

    pub(super) fn add(&mut self, one: &OffBy) {
        let precision = one.probability / one.variance;
        self.precision += precision;
        self.error += precision * one.error;
        self.probability = larger(self.probability, one.probability);
    }
}

/// What bearings of one place say, by source.
pub(super) struct AtPlace<const K: usize> {
    pub(super) of_tracks: [Sum; K],
    pub(super) of_modes: [Sum; MODES],
    /// The entry that comes first.
    pub(super) first: Option<[usize; 2]>,
}

impl<const K: usize> AtPlace<K> {
    pub(super) const NOTHING: Self = Self {
        of_tracks: [Sum::NOTHING; K],
        of_modes: [Sum::NOTHING; MODES],
        first: None,
    };

    fn all(&self) -> impl Iterator<Item = &Sum> + Clone {
        self.of_tracks.iter().chain(&self.of_modes)
    }

    /// The sum of the products of the errors of two sources, and what they count for.
    pub(super) fn products(&self) -> [f32; 2] {
        let (mut products, mut pairs) = (0.0, 0.0);
        let known = self.all().filter(|one| one.precision > 0.0);
        for (i, a) in known.clone().enumerate() {
            for b in known.clone().skip(i + 1) {
                let both = a.probability * b.probability;
                products += both * (a.error / a.precision) * (b.error / b.precision);
                pairs += both;
            }
        }
        [products, pairs]
    }

    /// By what a bearing of this source, by its number, is to be corrected if such errors have this variance; a square
    /// radian of stated variance adds so much to that of the bearing.
    pub(super) fn correction(
        &self,
        own: Option<usize>,
        variance: f32,
        by_stated: f32,
    ) -> Correction {
        if variance <= 0.0 {
            return Correction::NONE;
        }
        let (mut precision, mut error) = (1.0 / variance, 0.0);
        for (source, one) in self.all().enumerate() {
            if own != Some(source) {
                precision += one.precision;
                error += one.error;
            }
        }
        Correction {
            offset: error / precision,
            variance: 1.0 / (precision * by_stated),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn off_by(error: f32, sigma: f32, probability: f32) -> OffBy {
        OffBy {
            error,
            variance: sigma * sigma,
            by_stated: 1.0,
            probability,
        }
    }

    /// Two sources of three are heard at a place, one of them twice.
    fn place() -> AtPlace<3> {
        let mut all = AtPlace::NOTHING;
        all.of_tracks[0].add(&off_by(0.10, 0.1, 1.0));
        all.of_tracks[0].add(&off_by(0.20, 0.1, 1.0));
        all.of_tracks[2].add(&off_by(0.05, 0.2, 0.5));
        all
    }

    #[test]
    fn a_correction_is_that_of_a_kalman_filter_without_the_source_itself() {
        let variance = 0.04;
        for (own, precision, error) in [
            (None, 25.0 + 200.0 + 12.5, 30.0 + 0.625),
            (Some(0), 25.0 + 12.5, 0.625),
            (Some(1), 25.0 + 200.0 + 12.5, 30.0 + 0.625),
            (Some(2), 25.0 + 200.0, 30.0),
        ] {
            let found = place().correction(own, variance, 2.0);
            assert!((found.offset - error / precision).abs() < 1e-6);
            assert!((found.variance - 0.5 / precision).abs() < 1e-6);
        }
        assert_eq!(place().correction(None, 0.0, 1.0), Correction::NONE);
    }

    #[test]
    fn products_are_of_the_means_of_two_sources() {
        let mut place = place();
        let [products, pairs] = place.products();
        assert!((products - 0.5 * 0.15 * 0.05).abs() < 1e-7);
        assert_eq!(pairs, 0.5);
        place.of_modes[1].add(&off_by(-0.1, 0.1, 1.0));
        let [products, pairs] = place.products();
        assert!((products - (0.5 * 0.15 * 0.05 - 0.15 * 0.1 - 0.5 * 0.05 * 0.1)).abs() < 1e-7);
        assert_eq!(pairs, 2.0);
    }

    #[test]
    fn few_products_teach_little() {
        let revision = |products, pairs| {
            let mut revision = Revision {
                place: 4,
                index: 2,
                products,
                pairs,
                ..Revision::NEW
            };
            revision.begin_again();
            assert_eq!((revision.place, revision.index), (0, 0));
            assert_eq!((revision.products, revision.pairs), (0.0, 0.0));
            revision.variance
        };
        assert_eq!(revision(0.04, 4.0), 0.005);
        assert!((revision(4.0, 400.0) - 0.0099).abs() < 1e-5);
        assert_eq!(revision(-1.0, 10.0), 0.0);
    }
}
