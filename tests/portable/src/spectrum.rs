use foxhunt::{
    aoa::spectrum::Spectrum,
    math,
    random::{SeedableRng, Xoshiro128PlusPlus, normal, uniform},
};

use super::{Case, Digest};

pub const CASES: &[Case] = &[
    ("spectrum::peaks_of_anything", peaks_of_anything),
    ("spectrum::peaks_of_hills", peaks_of_hills),
];

/// In whole decibels, so that levels are equal at times.
fn of(level: impl FnMut(u16) -> f32) -> Spectrum {
    let mut spectrum = Spectrum::new();
    for level in (0..360).map(level) {
        let level = level.clamp(0.0, Spectrum::MAX_DECIBELS) as u16;
        spectrum.push(f32::from(level)).expect("in range");
    }
    spectrum
}

fn add_peaks(digest: &mut Digest, spectrum: &Spectrum) {
    for temper in [0.05, 0.2, 0.5, 1.0, 10.0] {
        let peaks = spectrum.peaks(temper);
        let mut total = 0.0;
        for peak in peaks.into_iter().flatten() {
            digest.add(&[peak.angle_rad, peak.sigma_rad, peak.probability]);
            total += peak.probability;
        }
        assert!(peaks[0].is_none() || (total - 1.0).abs() < 1e-4);
    }
    for degrees in [-180.0_f32, -77.7, 0.0, 123.4, 359.9] {
        digest.add(&[spectrum.log_likelihood(degrees.to_radians(), 0.3)]);
    }
}

/// Noise of every steepness.
fn peaks_of_anything() -> Digest {
    let mut rng = Xoshiro128PlusPlus::seed_from_u64(1);
    let mut digest = Digest::new();
    for run in 0..40_u8 {
        let steep = f32::from(run) * uniform(&mut rng);
        let (mut level, keep) = (20.0, uniform(&mut rng));
        let spectrum = of(|_| {
            level = 20.0 + keep * (level - 20.0) + steep * normal(&mut rng);
            level
        });
        add_peaks(&mut digest, &spectrum);
    }
    digest
}

/// Three hills of different heights and widths, wherever they are; some the mirror images of others.
fn peaks_of_hills() -> Digest {
    let mut rng = Xoshiro128PlusPlus::seed_from_u64(2);
    let mut digest = Digest::new();
    for run in 0..40_u16 {
        let mut hills = [(); 3].map(|()| {
            let top = 360.0 * uniform(&mut rng);
            (
                top,
                10.0 + 15.0 * uniform(&mut rng),
                0.3 * uniform(&mut rng),
            )
        });
        if run % 4 == 0 {
            let (top, height, slope) = hills[0];
            hills[1] = (360.0 - top, height, slope);
            hills[2].1 = height - 3.0;
        }
        let spectrum = of(|degree| {
            let heights = hills.map(|(top, height, slope)| {
                let off = math::wrap((f32::from(degree) - top).to_radians()).to_degrees();
                height - slope * off.abs() - 0.01 * slope * off * off
            });
            heights.into_iter().fold(0.0, f32::max)
        });
        add_peaks(&mut digest, &spectrum);
    }
    digest
}
