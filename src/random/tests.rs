//! Every test has a fixed seed. A Kolmogorov-Smirnov distance beyond 1.95 / sqrt(n) and a moment beyond
//! 3.3 standard errors would each happen by chance once in a thousand seeds.

extern crate std;
use std::vec::Vec;

use super::*;

const SAMPLES: usize = 1_000_000;

fn draw(seed: u64, mut sampler: impl FnMut(&mut Xoshiro128PlusPlus) -> f32) -> Vec<f64> {
    let mut rng = Xoshiro128PlusPlus::seed_from_u64(seed);
    let mut samples: Vec<f64> = (0..SAMPLES).map(|_| f64::from(sampler(&mut rng))).collect();
    samples.sort_by(f64::total_cmp);
    samples
}

fn assert_distributed(samples: &[f64], cumulative: impl Fn(f64) -> f64) {
    let n = samples.len() as f64;
    let distance = samples
        .iter()
        .enumerate()
        .map(|(i, &x)| {
            let p = cumulative(x);
            (p - i as f64 / n).abs().max((p - (i + 1) as f64 / n).abs())
        })
        .fold(0.0, f64::max);
    assert!(
        distance * n.sqrt() < 1.95,
        "Kolmogorov-Smirnov {}",
        distance * n.sqrt()
    );
}

/// `moments`: expectation of x^k and standard deviation of x^k, for k = 1, 2, ...
fn assert_moments(samples: &[f64], moments: &[(f64, f64)]) {
    let n = samples.len() as f64;
    for (k, &(expected, sigma)) in (1..).zip(moments) {
        let got = samples.iter().map(|x| x.powi(k)).sum::<f64>() / n;
        let errors = (got - expected) * n.sqrt() / sigma;
        assert!(
            errors.abs() < 3.3,
            "moment {k}: {got} is {errors:.1} standard errors off {expected}"
        );
    }
}

fn normal_cumulative(x: f64) -> f64 {
    0.5 * libm::erfc(-x / 2f64.sqrt())
}

#[test]
fn uniforms_are_uniform() {
    for (seed, sampler) in [
        (1, uniform as fn(&mut Xoshiro128PlusPlus) -> f32),
        (2, uniform_open),
    ] {
        let samples = draw(seed, sampler);
        assert_distributed(&samples, |x| x);
        assert_moments(
            &samples,
            &[
                (0.5, 12f64.sqrt().recip()),
                (1.0 / 3.0, (4.0 / 45f64).sqrt()),
            ],
        );
        assert!(samples[0] >= 0.0 && samples[SAMPLES - 1] < 1.0);
    }
}

/// A generator that counts, to reach chosen words.
struct Words(u32);

impl rand_core::TryRng for Words {
    type Error = core::convert::Infallible;
    fn try_next_u32(&mut self) -> Result<u32, Self::Error> {
        Ok(self.0)
    }
    fn try_next_u64(&mut self) -> Result<u64, Self::Error> {
        Ok(self.0.into())
    }
    fn try_fill_bytes(&mut self, dst: &mut [u8]) -> Result<(), Self::Error> {
        dst.fill(self.0 as u8);
        Ok(())
    }
}

#[test]
fn open_uniform_never_reaches_its_ends() {
    assert!(uniform_open(&mut Words(0)) > 0.0);
    assert!(uniform_open(&mut Words(u32::MAX)) < 1.0);
}

#[test]
fn normal_is_the_quantile_function() {
    // Every octave, a thousand places each, both signs. The exact distribution function of the sample
    // returns the probability that the word stands for; its slope turns the difference into sigmas.
    for octave in 0..31 {
        for i in 0..1000u64 {
            let word = ((1u64 << octave) + ((i << octave) / 1000)) as u32 | 1;
            for word in [word, word.wrapping_neg()] {
                let sample = f64::from(normal(&mut Words(word)));
                let probability = f64::from((word as i32).unsigned_abs()) / 2f64.powi(32);
                let density = (-0.5 * sample * sample).exp() / core::f64::consts::TAU.sqrt();
                let error = (normal_cumulative(-sample.abs()) - probability) / density;
                // In the last octaves the words themselves are steps of a few hundredths of a sigma.
                let limit = if octave < 2 { 0.3 } else { 4e-4 };
                assert!(
                    error.abs() < limit,
                    "word {word:#x}: {sample} errs by {error}"
                );
                assert!(sample.abs() < 4e-4 || (sample > 0.0) == ((word as i32) > 0));
            }
        }
    }
}

#[test]
fn normal_is_normal() {
    let samples = draw(3, normal);
    assert_distributed(&samples, normal_cumulative);
    assert_moments(
        &samples,
        &[
            (0.0, 1.0),
            (1.0, 2f64.sqrt()),
            (0.0, 15f64.sqrt()),
            (3.0, 96f64.sqrt()),
        ],
    );
    // Tails: expected counts 2700, 63 and 0.57 in a million.
    let beyond = |limit: f64| samples.iter().filter(|x| x.abs() > limit).count() as f64;
    assert!((beyond(3.0) - 2700.0).abs() < 3.3 * 2700f64.sqrt());
    assert!((beyond(4.0) - 63.3).abs() < 3.3 * 63.3f64.sqrt());
    assert!(beyond(5.0) <= 4.0);
}
