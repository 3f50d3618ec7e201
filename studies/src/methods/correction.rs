//! One bearing from many readings at one stop, pulled together by their quality.
//!
//! Du et al. (2016), eq. 19 to 21: each reading is pulled towards the running mean, the poorer the harder, and the corrected
//! bearing is the running mean of the results. All means are circular. The library has no use for it: its locators weigh
//! every reading by its own sigma.

use foxhunt::aoa::Bearing;
use foxhunt::math::{atan2, sin_cos, wrap};

/// How hard a reading is pulled towards the mean, from its quality: 0 leaves it, 1 replaces it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Pull {
    /// Falls steadily from 1 at quality 40 to 0 at quality 100, through the values that the printed bands have in common.
    #[default]
    Continuous,
    /// As printed. Within each band the weight *grows* with quality, so the better of two readings may be
    /// pulled harder; here to reproduce the paper.
    Printed,
}

impl Pull {
    fn weight(self, quality: f32) -> f32 {
        let q = quality;
        match self {
            Self::Continuous if q >= 85.0 => (100.0 - q) / 120.0,
            Self::Continuous if q >= 70.0 => 1.0 / 8.0 + (85.0 - q) / 120.0,
            Self::Continuous if q >= 55.0 => 1.0 / 4.0 + (70.0 - q) / 60.0,
            Self::Continuous => 1.0 / 2.0 + (55.0 - q) / 30.0,
            Self::Printed if q >= 85.0 => (q - 85.0) / 150.0,
            Self::Printed if q >= 70.0 => 1.0 / 8.0 + (q - 70.0) / 375.0,
            Self::Printed if q >= 55.0 => 1.0 / 4.0 + (q - 55.0) / 600.0,
            Self::Printed => 1.0 / 2.0 + (q - 40.0) / 30.0,
        }
    }
}

/// Sums of directions; their mean is the direction of the sum.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
struct CircularMean {
    sin: f32,
    cos: f32,
}

impl CircularMean {
    fn add(&mut self, radians: f32) {
        let (sin, cos) = sin_cos(radians);
        self.sin += sin;
        self.cos += cos;
    }

    fn radians(self) -> f32 {
        atan2(self.sin, self.cos)
    }
}

/// Collects the readings of one stop.
///
/// ```
/// use foxhunt::aoa::Bearing;
/// use foxhunt_studies::methods::correction::{Correction, Pull};
///
/// let mut stop = Correction::new(Pull::Continuous);
/// for (degrees, quality) in [(358.0, 95.0), (2.0, 90.0), (30.0, 45.0), (180.0, 10.0)] {
///     stop.add(Bearing::from_compass_degrees(degrees), quality);
/// }
/// assert_eq!(stop.readings(), 3); // The last one is too poor.
/// let degrees = stop.bearing().unwrap().compass_degrees();
/// assert!(degrees < 6.0, "{degrees}"); // The plain mean of the three is 10.
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Correction {
    pull: Pull,
    readings: u32,
    raw: CircularMean,
    corrected: CircularMean,
}

impl Correction {
    /// Readings of this quality, on a scale of 0 to 100, or less are dropped.
    pub const POOREST_QUALITY: f32 = 40.0;

    /// No reading yet.
    pub const fn new(pull: Pull) -> Self {
        let nothing = CircularMean { sin: 0.0, cos: 0.0 };
        Self {
            pull,
            readings: 0,
            raw: nothing,
            corrected: nothing,
        }
    }

    /// Adds a reading of the given quality (0 to 100, more is better) and says whether it was kept.
    ///
    /// One of too poor a quality, or with a bearing that is not finite, changes nothing.
    pub fn add(&mut self, bearing: Bearing, quality: f32) -> bool {
        let reading = bearing.radians();
        let kept = quality > Self::POOREST_QUALITY && reading.is_finite();
        if kept {
            self.raw.add(reading);
            let off = wrap(reading - self.raw.radians());
            let quality = if quality < 100.0 { quality } else { 100.0 };
            self.corrected
                .add(reading - off * self.pull.weight(quality));
            self.readings += 1;
        }
        kept
    }

    /// The corrected bearing, or `None` before the first reading.
    pub fn bearing(&self) -> Option<Bearing> {
        (self.readings > 0).then(|| Bearing::from_radians(self.corrected.radians()))
    }

    /// How many readings were kept.
    pub const fn readings(&self) -> u32 {
        self.readings
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_continuous_weight_falls_and_has_no_step() {
        let mut last = Pull::Continuous.weight(40.0);
        assert!((last - 1.0).abs() < 1e-6);
        for i in 1..=6000 {
            let weight = Pull::Continuous.weight(40.0 + i as f32 * 0.01);
            assert!(weight < last && last - weight < 4e-4);
            last = weight;
        }
        assert!(last.abs() < 1e-6);
    }

    #[test]
    fn the_printed_weight_has_the_values_of_the_paper() {
        for (quality, weight) in [
            (100.0, 1.0 / 10.0),
            (85.0, 0.0),
            (84.999, 1.0 / 25.0 + 1.0 / 8.0),
            (70.0, 1.0 / 8.0),
            (69.999, 1.0 / 40.0 + 1.0 / 4.0),
            (55.0, 1.0 / 4.0),
            (54.999, 1.0),
        ] {
            assert!(
                (Pull::Printed.weight(quality) - weight).abs() < 1e-4,
                "{quality}"
            );
        }
    }

    #[test]
    fn equal_readings_stay_where_they_are_all_round_the_circle() {
        for degrees in 0..360 {
            let mut stop = Correction::new(Pull::default());
            for _ in 0..10 {
                stop.add(Bearing::from_compass_degrees(degrees as f32), 60.0);
            }
            let got = stop.bearing().unwrap();
            let off = wrap(got.radians() - Bearing::from_compass_degrees(degrees as f32).radians());
            assert!(off.abs() < 3e-6);
        }
    }

    #[test]
    fn poor_and_broken_readings_change_nothing() {
        let mut stop = Correction::new(Pull::Printed);
        assert!(stop.add(Bearing::from_compass_degrees(10.0), 80.0));
        let before = stop;
        assert!(!stop.add(Bearing::from_compass_degrees(50.0), 40.0));
        assert!(!stop.add(Bearing::from_compass_degrees(50.0), f32::NAN));
        assert!(!stop.add(Bearing::from_compass_degrees(f32::NAN), 90.0));
        assert_eq!(stop, before);
        assert_eq!(Correction::new(Pull::Printed).bearing(), None);
    }
}
