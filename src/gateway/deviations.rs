//! How far to trust a bearing of some quality.

use core::fmt;

use crate::aoa::Observation;

/// The standard deviations of bearings by the quality that a direction finder states: up to eight knots, linear between
/// them, constant beyond the first and the last.
///
/// The presets are what is published of the devices, which is little: fit a table to bearings on a known transmitter.
///
/// ```
/// use foxhunt::gateway::{DeviationTable, Finder, Settings};
///
/// /// As measured: 15 degrees at quality 30, 4 at 60, 2.5 at 90.
/// const MEASURED: &DeviationTable = &match DeviationTable::new(&[(30.0, 0.262), (60.0, 0.070), (90.0, 0.044)]) {
///     Ok(table) => table,
///     Err(_) => panic!("knots ascend"),
/// };
/// let settings = Settings::new()
///     .with_deviation_table(Finder::Kraken, MEASURED)
///     .with_deviation_table(Finder::Agrelo, &DeviationTable::AGRELO);
/// assert!((settings.deviation_of_rad(Finder::Kraken, 45.0) - 0.166).abs() < 1e-6);
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct DeviationTable {
    /// Quality and deviation in radians. Those after the last are the last.
    knots: [(f32, f32); Self::KNOTS],
}

/// Why a table was refused.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub enum TableError {
    /// There is no knot, or there are more than [`DeviationTable::KNOTS`].
    Knots,
    /// A quality is not within 0 and 100, or not above the one before.
    Quality,
    /// A deviation is out of the range of [`Observation::new`].
    Deviation,
}

impl fmt::Display for TableError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Knots => "not one to eight knots",
            Self::Quality => "a quality is not within 0 and 100, or not above the one before",
            Self::Deviation => "a deviation is out of range",
        })
    }
}

impl core::error::Error for TableError {}

const DEGREE: f32 = core::f32::consts::PI / 180.0;

const fn preset(knots: &[(f32, f32)]) -> DeviationTable {
    match DeviationTable::new(knots) {
        Ok(table) => table,
        Err(_) => panic!("a preset is in range"),
    }
}

impl DeviationTable {
    /// The most knots of a table.
    pub const KNOTS: usize = 8;

    /// 10 degrees at quality 0, 2 at 100: what all finders have unless told otherwise.
    pub const LINEAR: Self = preset(&[(0.0, 10.0 * DEGREE), (100.0, 2.0 * DEGREE)]);

    /// Of `%BBB/Q`: half of the beam width that the digit stands for in APRS, from which the form comes: less than 240
    /// degrees for 1, 120 for 2, 64 for 3 and half of the one before from there on (APRS Protocol Reference 1.0.1,
    /// chapter 7). No less than 2 degrees, as nothing on a car is better.
    pub const AGRELO: Self = preset(&[
        (100.0 / 9.0, 120.0 * DEGREE),
        (200.0 / 9.0, 60.0 * DEGREE),
        (300.0 / 9.0, 32.0 * DEGREE),
        (400.0 / 9.0, 16.0 * DEGREE),
        (500.0 / 9.0, 8.0 * DEGREE),
        (600.0 / 9.0, 4.0 * DEGREE),
        (700.0 / 9.0, 2.0 * DEGREE),
    ]);

    /// Of a KrakenSDR whose confidence is in [percent](super::KrakenConfidence::Percent): linear, as nothing is published
    /// of it; by its maker's word it says little.
    pub const KRAKEN_PERCENT: Self = Self::LINEAR;

    /// Of a KrakenSDR whose confidence is in [decibels](super::KrakenConfidence::Decibels): users read 1 to 2 dB without
    /// any signal and 6 to 11 with one. A right angle up to 2 dB, then from 10 degrees at 6 to 3 at 11; these degrees are
    /// an estimate.
    pub const KRAKEN_DECIBELS: Self = preset(&[
        (2.0 * PER_DECIBEL, 90.0 * DEGREE),
        (4.0 * PER_DECIBEL, 25.0 * DEGREE),
        (6.0 * PER_DECIBEL, 10.0 * DEGREE),
        (11.0 * PER_DECIBEL, 3.0 * DEGREE),
    ]);

    /// Of a u-blox board whose quality is by its [azimuth](super::UbloxQuality::Azimuth): 5 degrees straight ahead, an
    /// estimate, divided by the cosine of the azimuth, as a flat array has it.
    pub const UBLOX: Self = preset(&[
        (100.0 / 9.0, 28.8 * DEGREE),
        (200.0 / 9.0, 14.6 * DEGREE),
        (300.0 / 9.0, 10.0 * DEGREE),
        (400.0 / 9.0, 7.8 * DEGREE),
        (600.0 / 9.0, 5.8 * DEGREE),
        (100.0, 5.0 * DEGREE),
    ]);

    /// From knots of quality (0 to 100, ascending) and standard deviation (radians).
    ///
    /// # Errors
    /// Names what is out of range.
    pub const fn new(knots: &[(f32, f32)]) -> Result<Self, TableError> {
        let Some(&last) = knots.last() else {
            return Err(TableError::Knots);
        };
        let mut all = [last; Self::KNOTS];
        let (mut rest, mut places) = (knots, all.as_mut_slice());
        let mut below = -1.0;
        while let [knot, others @ ..] = rest {
            let [place, more @ ..] = places else {
                return Err(TableError::Knots);
            };
            let (quality, deviation) = *knot;
            if !(quality >= 0.0 && quality <= 100.0 && quality > below) {
                return Err(TableError::Quality);
            }
            if !(deviation >= Observation::MIN_DEVIATION_RAD
                && deviation <= Observation::MAX_DEVIATION_RAD)
            {
                return Err(TableError::Deviation);
            }
            *place = *knot;
            below = quality;
            (rest, places) = (others, more);
        }
        Ok(Self { knots: all })
    }

    /// Standard deviation, in radians, of a bearing of this quality (0 to 100).
    pub fn deviation_rad(&self, quality: f32) -> f32 {
        between(&self.knots, quality)
    }
}

/// The quality that stands for a decibel.
const PER_DECIBEL: f32 = 100.0 / super::bearing_line::LARGEST_DECIBELS;

// Of a slice, and not inlined, so that the loop is not unrolled.
#[inline(never)]
fn between(knots: &[(f32, f32)], quality: f32) -> f32 {
    let mut before: Option<(f32, f32)> = None;
    for &(next, deviation) in knots {
        let (known, start) = before.unwrap_or((next, deviation));
        if quality <= next {
            let width = next - known;
            let share = if width > 0.0 {
                (quality - known) / width
            } else {
                0.0
            };
            return start + share * (deviation - start);
        }
        before = Some((next, deviation));
    }
    before.map_or(Observation::MAX_DEVIATION_RAD, |(_, deviation)| deviation)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn linear_between_knots_and_constant_beyond() {
        let table = DeviationTable::new(&[(20.0, 0.4), (40.0, 0.2), (90.0, 0.1)]).unwrap();
        for (quality, deviation) in [
            (0.0, 0.4),
            (20.0, 0.4),
            (30.0, 0.3),
            (40.0, 0.2),
            (65.0, 0.15),
            (90.0, 0.1),
            (100.0, 0.1),
        ] {
            assert!(
                (table.deviation_rad(quality) - deviation).abs() < 1e-6,
                "{quality}"
            );
        }
        let one = DeviationTable::new(&[(50.0, 0.3)]).unwrap();
        assert_eq!([0.0, 50.0, 100.0].map(|q| one.deviation_rad(q)), [0.3; 3]);
        let full: [(f32, f32); 8] = core::array::from_fn(|i| (i as f32, 0.8 - 0.1 * i as f32));
        let full = DeviationTable::new(&full).unwrap();
        assert!((full.deviation_rad(6.5) - 0.15).abs() < 1e-6);
    }

    #[test]
    fn refused() {
        for (knots, error) in [
            (&[][..], TableError::Knots),
            (&[(1.0, 0.1); 9], TableError::Quality),
            (&[(-1.0, 0.1)], TableError::Quality),
            (&[(f32::NAN, 0.1)], TableError::Quality),
            (&[(101.0, 0.1)], TableError::Quality),
            (&[(5.0, 0.1), (5.0, 0.1)], TableError::Quality),
            (&[(5.0, 0.0)], TableError::Deviation),
            (&[(5.0, f32::NAN)], TableError::Deviation),
            (&[(5.0, 4.0)], TableError::Deviation),
        ] {
            assert_eq!(DeviationTable::new(knots), Err(error), "{knots:?}");
        }
        let nine: [(f32, f32); 9] = core::array::from_fn(|i| (i as f32, 0.1));
        assert_eq!(DeviationTable::new(&nine), Err(TableError::Knots));
    }

    #[test]
    fn presets_are_what_they_say() {
        let settings = super::super::Settings::new();
        for tenth in 0..=1000 {
            let quality = tenth as f32 * 0.1;
            let linear = DeviationTable::LINEAR.deviation_rad(quality);
            assert!((linear - settings.deviation_rad(quality)).abs() < 1e-6);
        }
        let agrelo =
            |digit: f32| DeviationTable::AGRELO.deviation_rad(digit * (100.0 / 9.0)) / DEGREE;
        for (digit, degrees) in [
            (9.0, 2.0),
            (7.0, 2.0),
            (6.0, 4.0),
            (3.0, 32.0),
            (0.0, 120.0),
        ] {
            assert!((agrelo(digit) - degrees).abs() < 1e-3, "{digit}");
        }
        for degrees in [0.0_f32, 15.0, 30.0, 50.0, 60.0, 70.0, 80.0] {
            let quality = 100.0 - degrees / 0.9;
            let exact = 5.0 / degrees.to_radians().cos();
            let got = DeviationTable::UBLOX.deviation_rad(quality) / DEGREE;
            assert!((got / exact - 1.0).abs() < 0.05, "{degrees}: {got} {exact}");
        }
    }
}
