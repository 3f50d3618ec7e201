use foxhunt::{
    random::{self, SeedableRng, Xoshiro128PlusPlus},
    resample::{Scheme, resample},
};

use super::{Case, Digest};

pub const CASES: &[Case] = &[
    ("random::uniform", || {
        samples(random::uniform, 0.5, 1.0 / 12.0)
    }),
    ("random::normal", || samples(random::normal, 0.0, 1.0)),
    ("resample::systematic", || copies(Scheme::Systematic)),
    ("resample::stratified", || copies(Scheme::Stratified)),
    ("resample::residual", || copies(Scheme::Residual)),
    ("resample::multinomial", || copies(Scheme::Multinomial)),
];

/// Moments within four standard errors, and the very numbers.
fn samples(sample: impl Fn(&mut Xoshiro128PlusPlus) -> f32, mean: f32, variance: f32) -> Digest {
    const N: u16 = 4096;
    let mut rng = Xoshiro128PlusPlus::seed_from_u64(1);
    let mut digest = Digest::new();
    let (mut sum, mut squares) = (0.0, 0.0);
    for _ in 0..N {
        let x = sample(&mut rng);
        digest.add(&[x]);
        sum += x - mean;
        squares += (x - mean) * (x - mean);
    }
    let n = f32::from(N);
    assert!((sum / n) * (sum / n) < 16.0 * variance / n);
    assert!((squares / n / variance - 1.0).abs() < 0.15);
    digest
}

/// Every scheme leaves the heavy particle about as often as its weight says.
fn copies(scheme: Scheme) -> Digest {
    let mut rng = Xoshiro128PlusPlus::seed_from_u64(1);
    let mut weights = [0.5 / 99.0; 100];
    weights[31] = 0.5;
    let mut memory = [0.0; 100];
    let mut ancestors: [u8; 100] = core::array::from_fn(|i| i as u8);
    resample(scheme, &weights, &mut memory, &mut rng).gather(&mut ancestors, &mut [0; 100]);
    let heavy = ancestors.iter().filter(|&&ancestor| ancestor == 31).count();
    assert!((30..=70).contains(&heavy), "{heavy} copies");
    let mut digest = Digest::new();
    digest.add_bytes(&ancestors);
    digest
}
