//! How far to trust a bearing of some quality.

use crate::ConfigError;
use crate::aoa::Observation;
use crate::config::require;

/// Standard deviations of bearings by the quality that a direction finder states: up to eight knots, linear between them,
/// constant beyond the first and the last.
///
/// The modules of the [formats](super::formats) hold what is published of the devices, which is little: fit a table to
/// bearings on a known transmitter.
///
/// ```
/// use foxhunt::gateway::SigmaTable;
///
/// /// As measured: 15 degrees at quality 30, 4 at 60, 2.5 at 90.
/// const MEASURED: SigmaTable = match SigmaTable::new(&[(30.0, 0.262), (60.0, 0.070), (90.0, 0.044)]) {
///     Ok(table) => table,
///     Err(_) => panic!("qualities ascend"),
/// };
/// assert!((MEASURED.sigma_rad(45.0) - 0.166).abs() < 1e-6);
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct SigmaTable {
    /// Quality, and standard deviation in radians. Those after the last are the last.
    knots: [(f32, f32); Self::KNOTS],
}

/// A table of qualities and degrees that are in range.
pub(super) const fn preset<const K: usize>(knots: &[(f32, f32); K]) -> SigmaTable {
    const DEGREE: f32 = core::f32::consts::PI / 180.0;
    let mut radians = *knots;
    let mut rest = radians.as_mut_slice();
    while let [(_, sigma), others @ ..] = rest {
        *sigma *= DEGREE;
        rest = others;
    }
    match SigmaTable::new(&radians) {
        Ok(table) => table,
        Err(_) => panic!("a preset is in range"),
    }
}

impl SigmaTable {
    /// The most knots of a table.
    pub const KNOTS: usize = 8;

    /// 10 degrees at quality 0, 2 at 100.
    pub const LINEAR: Self = preset(&[(0.0, 10.0), (100.0, 2.0)]);

    /// By the quality of an Agrelo or a station of APRS: half of the beam width that its digit stands for in APRS: less than
    /// 240 degrees for 1, 120 for 2, 64 for 3 and half of the one before from there on (APRS Protocol Reference 1.0.1,
    /// chapter 7). No less than 2 degrees, as nothing on a car is better.
    pub const BEAM_WIDTHS: Self = preset(&[
        (100.0 / 9.0, 120.0),
        (200.0 / 9.0, 60.0),
        (300.0 / 9.0, 32.0),
        (400.0 / 9.0, 16.0),
        (500.0 / 9.0, 8.0),
        (600.0 / 9.0, 4.0),
        (700.0 / 9.0, 2.0),
    ]);

    /// From knots of quality (0 to 100, ascending) and standard deviation (radians).
    ///
    /// # Errors
    /// Says what is out of range.
    pub const fn new(knots: &[(f32, f32)]) -> Result<Self, ConfigError> {
        let Some(&last) = knots.last() else {
            return Err(ConfigError::new("knots must be one to eight"));
        };
        let mut all = [last; Self::KNOTS];
        let (mut rest, mut places) = (knots, all.as_mut_slice());
        let mut below = -1.0;
        while let [knot, others @ ..] = rest {
            let [place, more @ ..] = places else {
                return Err(ConfigError::new("knots must be one to eight"));
            };
            let (quality, sigma) = *knot;
            require!(
                quality >= 0.0 && quality <= 100.0 && quality > below,
                "quality must be from 0 to 100 and above the one before"
            );
            require!(
                sigma >= Observation::MIN_SIGMA_RAD && sigma <= Observation::MAX_SIGMA_RAD,
                "sigma_rad must be from 0.001 to 3.2, as of an observation"
            );
            *place = *knot;
            below = quality;
            (rest, places) = (others, more);
        }
        Ok(Self { knots: all })
    }

    /// Standard deviation, in radians, of a bearing of this quality (0 to 100).
    pub fn sigma_rad(&self, quality: f32) -> f32 {
        between(&self.knots, quality)
    }
}

// Of a slice, and not inlined, so that the loop is not unrolled.
#[inline(never)]
fn between(knots: &[(f32, f32)], quality: f32) -> f32 {
    let mut before: Option<(f32, f32)> = None;
    for &(next, sigma) in knots {
        let (known, start) = before.unwrap_or((next, sigma));
        if quality <= next {
            let width = next - known;
            let fraction = if width > 0.0 {
                (quality - known) / width
            } else {
                0.0
            };
            return start + fraction * (sigma - start);
        }
        before = Some((next, sigma));
    }
    before.map_or(Observation::MAX_SIGMA_RAD, |(_, sigma)| sigma)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sigmas_are_linear_between_knots_and_constant_beyond() {
        let table = SigmaTable::new(&[(20.0, 0.4), (40.0, 0.2), (90.0, 0.1)]).unwrap();
        for (quality, sigma) in [
            (0.0, 0.4),
            (20.0, 0.4),
            (30.0, 0.3),
            (40.0, 0.2),
            (65.0, 0.15),
            (90.0, 0.1),
            (100.0, 0.1),
        ] {
            let got = table.sigma_rad(quality);
            assert!((got - sigma).abs() < 1e-6, "{quality}: {got}");
        }
        let one = SigmaTable::new(&[(50.0, 0.3)]).unwrap();
        assert_eq!([0.0, 50.0, 100.0].map(|q| one.sigma_rad(q)), [0.3; 3]);
        assert!(SigmaTable::new(&[(0.0, 3.2), (100.0, 0.001)]).is_ok());
        let full: [(f32, f32); 8] = core::array::from_fn(|i| (i as f32, 0.8 - 0.1 * i as f32));
        let full = SigmaTable::new(&full).unwrap();
        assert!((full.sigma_rad(6.5) - 0.15).abs() < 1e-6);
    }

    #[test]
    fn refuses_knots_out_of_range() {
        for (knots, field) in [
            (&[][..], "knots"),
            (&[(1.0, 0.1); 9], "quality"),
            (&[(-1.0, 0.1)], "quality"),
            (&[(f32::NAN, 0.1)], "quality"),
            (&[(101.0, 0.1)], "quality"),
            (&[(5.0, 0.1), (5.0, 0.1)], "quality"),
            (&[(5.0, 0.0)], "sigma_rad"),
            (&[(5.0, f32::NAN)], "sigma_rad"),
            (&[(5.0, 4.0)], "sigma_rad"),
        ] {
            let error = SigmaTable::new(knots).unwrap_err();
            assert_eq!(error.field(), field, "{knots:?}");
        }
        let nine: [(f32, f32); 9] = core::array::from_fn(|i| (i as f32, 0.1));
        assert_eq!(SigmaTable::new(&nine).unwrap_err().field(), "knots");
    }

    #[test]
    fn sigmas_follow_the_beam_width_of_aprs() {
        for (digit, degrees) in [
            (9.0, 2.0),
            (7.0, 2.0),
            (6.0, 4.0),
            (3.0, 32.0),
            (0.0, 120.0_f32),
        ] {
            let sigma = SigmaTable::BEAM_WIDTHS
                .sigma_rad(digit * (100.0 / 9.0))
                .to_degrees();
            assert!((sigma - degrees).abs() < 1e-3, "{digit}");
        }
    }
}
