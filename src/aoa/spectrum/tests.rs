extern crate std;

use super::*;
use crate::aoa::Observation;
use crate::model::Likelihood;
use crate::random::{SeedableRng, Xoshiro128PlusPlus, normal, uniform};
use std::vec::Vec;

fn of(level: impl Fn(f32) -> f32) -> Spectrum {
    let mut spectrum = Spectrum::new();
    for degree in 0..360 {
        spectrum.push(level(degree as f32)).unwrap();
    }
    spectrum
}

/// Degrees from one direction to another.
fn apart(a: f32, b: f32) -> f32 {
    (a - b + 540.0).rem_euclid(360.0) - 180.0
}

/// Two normal peaks in linear power over a floor, in decibels above the least.
fn two(a: f32, b: f32, second: f32, width: f32) -> Spectrum {
    let power = |d: f32| (-0.5 * (d / width).powi(2)).exp();
    let at = |degree: f32| power(apart(degree, a)) + second * power(apart(degree, b)) + 1e-3;
    of(|degree| 10.0 * at(degree).log10() + 30.0)
}

#[test]
fn a_peak_is_found_between_degrees_with_its_sigma_and_probability() {
    let mut rng = Xoshiro128PlusPlus::seed_from_u64(1);
    for _ in 0..500 {
        let a = 360.0 * uniform(&mut rng);
        let b = a + 90.0 + 180.0 * uniform(&mut rng);
        let (width, second) = (4.0 + 8.0 * uniform(&mut rng), 0.3 + uniform(&mut rng));
        let exponent = 0.3 + 0.7 * uniform(&mut rng);
        let peaks = two(a, b, second, width).peaks(exponent);
        let peaks: Vec<Peak> = peaks.into_iter().flatten().collect();
        assert_eq!(peaks.len(), 2);
        let probabilities: f32 = peaks.iter().map(|peak| peak.probability).sum();
        assert!((probabilities - 1.0).abs() < 1e-5 && peaks[0].probability >= peaks[1].probability);
        for (angle, height) in [(a, 1.0_f32), (b, second)] {
            let off = |peak: &Peak| apart(peak.angle_rad.to_degrees(), angle).abs();
            let peak = peaks.iter().find(|peak| off(peak) < 20.0).unwrap();
            assert!(off(peak) < 0.15, "{} at {width}", off(peak));
            // A normal peak to the power of t is narrower by its root.
            let sigma = peak.sigma_rad.to_degrees() * exponent.sqrt() / width;
            assert!((sigma - 1.0).abs() < 0.1, "{sigma}");
            // The floor adds to both.
            let probability = height.powf(exponent) / (1.0 + second.powf(exponent));
            assert!(
                (peak.probability - probability).abs() < 0.1,
                "{} {probability}",
                peak.probability
            );
        }
    }
}

#[test]
fn peaks_that_overlap_are_one() {
    // To the power of a quarter twice as wide: 12 degrees, and 51 are three sigmas of the difference.
    for (distance, count) in [(45.0, 1), (60.0, 2)] {
        let spectrum = two(350.0, 350.0 + distance, 0.9, 6.0);
        let peaks = spectrum.peaks(0.25);
        assert_eq!(peaks.iter().flatten().count(), count);
        assert_eq!(spectrum.peaks(10.0).iter().flatten().count(), 2);
        if let (1, Some(one)) = (count, peaks[0]) {
            assert!(apart(one.angle_rad.to_degrees(), 350.0).abs() < 0.5);
            let exact = (12.0_f32.powi(2) + 0.49 * 45.0 * 45.0).sqrt();
            let sigma = one.sigma_rad.to_degrees();
            assert!((sigma / exact - 1.0).abs() < 0.05, "{sigma} {exact}");
        }
    }
}

#[test]
fn where_a_peak_lies_does_not_depend_on_the_temper() {
    let mut rng = Xoshiro128PlusPlus::seed_from_u64(4);
    for _ in 0..200 {
        let a = 360.0 * uniform(&mut rng);
        let (b, second) = (a + 60.0 + 90.0 * uniform(&mut rng), 0.7 * uniform(&mut rng));
        let spectrum = two(a, b, second, 5.0 + 10.0 * uniform(&mut rng));
        let angle = |exponent| spectrum.peaks(exponent)[0].map(|peak| peak.angle_rad);
        let sharp = angle(1.0);
        assert!(apart(sharp.unwrap().to_degrees(), a).abs() < 1.0);
        for exponent in [0.1, 0.2, 0.5] {
            // One that is flat by its temper has none.
            assert!(angle(exponent).is_none_or(|same| Some(same) == sharp));
        }
    }
}

#[test]
fn peaks_over_the_ends_of_the_circle_and_none_of_a_flat_one() {
    for at in [0.0, 0.4, 179.6, 359.7] {
        let [Some(peak), None, None] = two(at, at, 1.0, 6.0).peaks(0.5) else {
            panic!("there is one at {at}");
        };
        assert!(apart(peak.angle_rad.to_degrees(), at).abs() < 0.1);
        assert!(peak.angle_rad.abs() <= PI + 1e-5 && (peak.probability - 1.0).abs() < 1e-6);
    }
    for level in [0.0, 30.0, 600.0] {
        assert_eq!(of(|_| level).peaks(1.0), [None; 3]);
    }
    // As sharp as can be: no sharper than a degree is wide.
    let needle = of(|degree| if degree == 77.0 { 100.0 } else { 0.0 });
    let [Some(peak), None, None] = needle.peaks(10.0) else {
        panic!("there is one");
    };
    assert!((peak.sigma_rad.to_degrees() - 0.289).abs() < 1e-3);
    assert!((peak.angle_rad.to_degrees() - 77.0).abs() < 0.01);
    // Many are three.
    let comb = of(|degree| 20.0 + 10.0 * (degree.to_radians() * 8.0).cos());
    assert_eq!(comb.peaks(1.0).iter().flatten().count(), 3);
}

#[test]
fn anything_has_peaks_that_are_directions() {
    let mut rng = Xoshiro128PlusPlus::seed_from_u64(2);
    for run in 0..2000 {
        let steep = 60.0 * uniform(&mut rng);
        let cells: Vec<f32> = (0..360)
            .map(|_| (steep * normal(&mut rng)).abs().min(600.0))
            .collect();
        let spectrum = of(|degree| cells[degree as usize]);
        let exponent = [0.001, 0.2, 10.0][run % 3];
        let peaks = spectrum.peaks(exponent);
        let probabilities: Vec<f32> = peaks
            .iter()
            .flatten()
            .map(|peak| peak.probability)
            .collect();
        assert!(probabilities.is_empty() || (probabilities.iter().sum::<f32>() - 1.0).abs() < 1e-4);
        for peak in peaks.iter().flatten() {
            assert!(
                peak.angle_rad.abs() <= PI + 1e-5
                    && peak.sigma_rad > 0.005
                    && peak.probability > 0.0
            );
            let bearing = Bearing::from_radians(peak.angle_rad);
            assert!(Observation::new(0, [0.0, 0.0], bearing, peak.sigma_rad).is_ok());
        }
    }
}

#[test]
fn a_hump_as_wide_as_the_circle_is_no_bearing() {
    let hump = |decibels: f32| of(|degree| 0.5 * decibels * (1.0 + degree.to_radians().cos()));
    for decibels in [0.1, 1.0, 3.0, 6.0, 8.0] {
        assert_eq!(hump(decibels).peaks(0.2), [None; 3], "{decibels}");
    }
    let mut before = Observation::MAX_SIGMA_RAD;
    for decibels in [12.0, 30.0, 100.0, 600.0] {
        let [Some(peak), None, None] = hump(decibels).peaks(0.2) else {
            panic!("there is one of {decibels}");
        };
        assert!(peak.sigma_rad < before, "{decibels}: {}", peak.sigma_rad);
        before = peak.sigma_rad;
    }
}

#[test]
fn the_likelihood_is_the_tempered_level_between_two_degrees() {
    let spectrum = of(|degree| (degree - 100.0).abs() * 0.1);
    let per_decibel = 0.3 * LN_10 / 10.0;
    for (degrees, level) in [
        (10.5_f32, 8.95),
        (-90.0, 17.0),
        (359.5, 17.95),
        (100.0, 0.0),
    ] {
        let got = spectrum.log_likelihood(degrees.to_radians(), 0.3);
        let exact = per_decibel * (level - 25.9);
        assert!((got - exact).abs() < 1e-3, "{degrees}: {got} {exact}");
    }
    let axis = Bearing::from_compass_degrees(30.0);
    let likelihood = spectrum.likelihood([5.0, -3.0], axis, 0.3);
    let mut rng = Xoshiro128PlusPlus::seed_from_u64(3);
    let places: [[f32; 100]; 2] =
        core::array::from_fn(|_| core::array::from_fn(|_| 300.0 * normal(&mut rng)));
    let mut out = [0.0; 100];
    likelihood.log_likelihoods(&[&places[0], &places[1]], &mut out);
    for ((x, y), got) in places[0].iter().zip(places[1]).zip(out) {
        assert_eq!(Likelihood::<2>::log_likelihood(&likelihood, &[*x, y]), got);
        // The axis points to 60 degrees counter-clockwise from east.
        let angle = (y + 3.0).atan2(x - 5.0) - 60.0_f32.to_radians();
        let exact = spectrum.log_likelihood(angle, 0.3);
        assert!((got - exact).abs() < 1e-3, "{got} {exact}");
    }
}

#[test]
fn values_are_checked() {
    let mut spectrum = Spectrum::new();
    for level in [-0.1, 600.1, f32::NAN] {
        assert_eq!(spectrum.push(level), Err(ObservationError::Level));
    }
    for level in [60_001, u16::MAX] {
        assert_eq!(spectrum.push_level(level), Err(ObservationError::Level));
    }
    assert_eq!(spectrum, Spectrum::new());
    for degree in 0..360 {
        assert!(!spectrum.is_whole());
        spectrum.push(degree as f32).unwrap();
    }
    assert!(spectrum.is_whole());
    assert_eq!(spectrum.push(1.0), Err(ObservationError::Degrees));
    spectrum.clear();
    assert_eq!(spectrum, Spectrum::new());
    assert_eq!(size_of::<Spectrum>(), 722);
}
