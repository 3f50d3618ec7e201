//! The peaks of a spectrum, as bearings that exclude each other.

use core::f32::consts::PI;

use super::{Spectrum, per_level};
use crate::aoa::Observation;
use crate::math::{exp, sqrt, wrap};

/// A direction from which a source may be heard.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Peak {
    /// Radians counter-clockwise from the array's axis, within -pi and pi: between the points either side at which the
    /// level has fallen by a decibel, or the next dip.
    pub angle_rad: f32,
    /// Standard deviation, in radians: that of the normal distribution whose logarithm is the parabola through the top
    /// and the points either side at which the tempered spectrum has fallen to exp(-1/2) of it, or the next dip. Wider
    /// where another peak is too near to be told apart.
    pub sigma_rad: f32,
    /// Fraction of the mass of the tempered spectrum, up to the dips either side, in that of all peaks returned.
    pub probability: f32,
}

/// Peaks are at most so many.
pub(super) const PEAKS: usize = 3;

/// A peak ends where the level rises again by so many hundredths of a decibel.
const DIP: f32 = 100.0;
/// Its direction is that of the points that are lower by so many hundredths of a decibel: nearer ones feel how the levels
/// are rounded, those further away lean towards other peaks.
const FALL: f32 = 100.0;
/// Peaks with less of the mass are dropped: fewer alternatives to weigh, for the loss of faint sources.
const LEAST_FRACTION: f32 = 0.02;
/// Sigma of what is only known to a degree.
const FINEST: f32 = 0.289 * DEGREE;
const DEGREE: f32 = PI / 180.0;

/// A top, and how many degrees it reaches down either side.
#[derive(Clone, Copy)]
struct Hill {
    top: usize,
    left: usize,
    right: usize,
}

impl Spectrum {
    /// The peaks, that with the most mass first. Of two less than three sigmas of their difference apart that with less
    /// mass is dropped, and the other is wider for it. Where a peak lies does not depend on the temper.
    ///
    /// There are none if the spectrum is flat, or as good as flat: if, tempered, a peak would be as wide as
    /// [`Observation::MAX_SIGMA_RAD`], more than half the circle. A bearing of it would tell more than the spectrum
    /// does. So every peak makes an [`Observation`].
    ///
    /// As bearings they exclude each other: [`Alternative`](crate::aoa::Alternative). `temper` is 0.001 to 10.
    pub fn peaks(&self, temper: f32) -> [Option<Peak>; PEAKS] {
        self.peaks_of_sigma(temper, None)
    }

    /// The same with peaks of a known sigma, which is that of an observation; the highest first.
    #[inline(never)]
    pub(crate) fn peaks_of_sigma(
        &self,
        temper: f32,
        sigma_rad: Option<f32>,
    ) -> [Option<Peak>; PEAKS] {
        let scale = per_level(temper);
        let highest = self.highest();
        let mut hills = [None; PEAKS];
        let mut peaks = [None; PEAKS];
        let mut total = 0.0;
        for place in 0..PEAKS {
            let Some(hill) = self.next_hill(&hills) else {
                break;
            };
            let mass = match sigma_rad {
                // Those of one sigma are as likely as they are high.
                Some(_) => exp(scale * (self.level(hill.top) - highest)),
                None => self.mass(&hill, scale, highest),
            };
            if let (Some(kept), Some(peak)) = (hills.get_mut(place), peaks.get_mut(place)) {
                *kept = Some(hill);
                let own_sigma_rad = sigma_rad.map_or_else(|| self.sigma_rad(&hill, scale), Some);
                *peak =
                    (self.angle_rad(&hill).zip(own_sigma_rad)).map(|(angle_rad, sigma_rad)| Peak {
                        angle_rad,
                        sigma_rad,
                        probability: mass,
                    });
                total += if peak.is_some() { mass } else { 0.0 };
            }
        }
        let [a, b, c] = &mut peaks;
        merge(a, b);
        merge(a, c);
        merge(b, c);
        if peaks.iter().flatten().any(Peak::is_flat) {
            return [None; PEAKS];
        }
        normalise(&mut peaks, total);
        peaks
    }

    /// The highest top that no other hill holds.
    #[inline(never)]
    fn next_hill(&self, known: &[Option<Hill>]) -> Option<Hill> {
        let mut best = None;
        let mut above = -1.0;
        for degree in 0..Self::CELLS {
            let level = self.level(degree);
            if level > above && !known.iter().flatten().any(|hill| hill.holds(degree)) {
                (best, above) = (Some(degree), level);
            }
        }
        let top = best?;
        let hill = Hill {
            top,
            left: self.reach(top, Self::CELLS - 1),
            right: self.reach(top, 1),
        };
        // What ends in a slope is the foot of another.
        (hill.left > 0 && hill.right > 0).then_some(hill)
    }

    /// How many steps of so many degrees it goes down from a top.
    fn reach(&self, top: usize, step: usize) -> usize {
        let (mut lowest, mut reach) = (self.level(top), 0);
        let mut degree = top;
        for steps in 1..Self::CELLS / 2 {
            degree += step;
            if degree >= Self::CELLS {
                degree -= Self::CELLS;
            }
            let level = self.level(degree);
            if level < lowest {
                (lowest, reach) = (level, steps);
            } else if level > lowest + DIP {
                break;
            }
        }
        reach
    }

    /// The mass of the tempered spectrum in a hill.
    fn mass(&self, hill: &Hill, scale: f32, highest: f32) -> f32 {
        let first = hill.top + Self::CELLS - hill.left;
        let degrees = (0..=hill.left + hill.right).map(|i| circle(first + i));
        degrees
            .map(|degree| exp(scale * (self.level(degree) - highest)))
            .sum()
    }

    fn angle_rad(&self, hill: &Hill) -> Option<f32> {
        let (slope, curvature) = self.parabola(hill, 1.0, FALL)?;
        Some(wrap((hill.top as f32 + slope / curvature) * DEGREE))
    }

    fn sigma_rad(&self, hill: &Hill, scale: f32) -> Option<f32> {
        let (_, curvature) = self.parabola(hill, scale, 0.5)?;
        Some(bounded(DEGREE / sqrt(curvature)))
    }

    /// The slope at the top and the curvature of the parabola through it and a point either side, where the scaled level
    /// has fallen by so much.
    fn parabola(&self, hill: &Hill, scale: f32, fall: f32) -> Option<(f32, f32)> {
        let top = self.level(hill.top);
        let fall = |most: usize, step: usize| {
            let mut degree = hill.top;
            let mut found = (0.0, 0.0);
            for steps in 1..=most {
                degree = circle(degree + step);
                let drop = scale * (top - self.level(degree));
                found = (steps as f32, drop);
                if drop >= fall {
                    break;
                }
            }
            found
        };
        let (l, drop_left) = fall(hill.left, Self::CELLS - 1);
        let (r, drop_right) = fall(hill.right, 1);
        // y = -drop at -l and r, 0 at 0: its slope at 0 and its curvature.
        let width = l * r * (l + r);
        let curvature = 2.0 * (drop_left * r + drop_right * l) / width;
        let slope = (drop_left * r * r - drop_right * l * l) / width;
        (curvature > 0.0 && width > 0.0).then_some((slope, curvature))
    }
}

impl Peak {
    /// Whether it is as wide as the circle.
    fn is_flat(&self) -> bool {
        self.sigma_rad >= Observation::MAX_SIGMA_RAD
    }
}

/// A sigma within what can be known and what is worth knowing.
fn bounded(sigma_rad: f32) -> f32 {
    sigma_rad.clamp(FINEST, Observation::MAX_SIGMA_RAD)
}

impl Hill {
    fn holds(&self, degree: usize) -> bool {
        let from_left = circle(degree + Spectrum::CELLS + self.left - self.top);
        from_left <= self.left + self.right
    }
}

/// A degree within the circle, from one within thrice.
fn circle(mut degree: usize) -> usize {
    while degree >= Spectrum::CELLS {
        degree -= Spectrum::CELLS;
    }
    degree
}

/// Of two peaks that a bearing could be of either, the larger stays, and is wider for the other: what is taken for bearings
/// that exclude each other must lie apart.
fn merge(one: &mut Option<Peak>, other: &mut Option<Peak>) {
    let (Some(a), Some(b)) = (*one, *other) else {
        return;
    };
    let turn = wrap(b.angle_rad - a.angle_rad);
    let variances = (a.sigma_rad * a.sigma_rad, b.sigma_rad * b.sigma_rad);
    if turn * turn >= 9.0 * (variances.0 + variances.1) {
        return;
    }
    let mass = a.probability + b.probability;
    let (larger, less) = if b.probability > a.probability {
        (b, a.probability / mass)
    } else {
        (a, b.probability / mass)
    };
    let variance = variances.0 + less * (variances.1 - variances.0) + less * turn * turn;
    *one = Some(Peak {
        sigma_rad: bounded(sqrt(variance)),
        probability: mass,
        ..larger
    });
    *other = None;
}

/// From masses to probabilities, without those that are next to nothing, the largest first.
fn normalise(peaks: &mut [Option<Peak>; PEAKS], total: f32) {
    let mut kept = 0.0;
    for slot in peaks.iter_mut() {
        if let Some(peak) = *slot {
            if peak.probability < LEAST_FRACTION * total {
                *slot = None;
            } else {
                kept += peak.probability;
            }
        }
    }
    for peak in peaks.iter_mut().flatten() {
        peak.probability /= kept;
    }
    let probability = |peak: &Option<Peak>| peak.map_or(-1.0, |peak| peak.probability);
    let [a, b, c] = peaks;
    for (one, other) in [(0, 1), (1, 2), (0, 1)] {
        let (one, other) = match (one, other) {
            (0, 1) => (&mut *a, &mut *b),
            _ => (&mut *b, &mut *c),
        };
        if probability(other) > probability(one) {
            core::mem::swap(one, other);
        }
    }
}
