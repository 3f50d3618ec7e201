//! What proposals are worth on the published models, beside the exact filters in f64 on the same runs.
//!
//! Seeds are fixed. Each limit is three standard errors or more from the figure of 2,000 runs: less than one other
//! set of seeds in 500 would miss it.

use foxhunt::filter::ParticleFilter;
use foxhunt::kalman::{Covariance, Unscented};
use foxhunt::model::Likelihood;
use foxhunt::proposal::{
    AuxiliaryFilter, PointMassFilter, Posterior, Transition, UnscentedParticleFilter,
};
use foxhunt::random::{Rng, SeedableRng, Xoshiro128PlusPlus};
use foxhunt::refine::{DifferentialEvolution, Memory};
use foxhunt::resample::Scheme;
use foxhunt_host::reference;
use foxhunt_problems::{gamma, growth};
use rayon::prelude::*;

const STEPS: usize = 50;

/// Dynamics, state and measurement of each step.
type Run<T, L> = Vec<(T, f32, L)>;

/// Mean squared error of the estimates that `step` gives over a run.
fn errors<T, L>(run: &Run<T, L>, mut step: impl FnMut(&T, &L) -> f32) -> f64 {
    let square = |(dynamics, state, measurement): &(T, f32, L)| {
        f64::from(step(dynamics, measurement) - state).powi(2)
    };
    run.iter().map(square).sum::<f64>() / run.len() as f64
}

/// The same of estimates that are known.
fn errors_of<T, L>(run: &Run<T, L>, means: Vec<f64>) -> f64 {
    let mut means = means.into_iter();
    errors(run, |_, _| means.next().unwrap() as f32)
}

/// Mean of `figures` and its standard error.
fn mean(figures: impl Iterator<Item = f64> + Clone) -> (f64, f64) {
    let n = figures.clone().count() as f64;
    let mean = figures.clone().sum::<f64>() / n;
    let squares = figures.map(|figure| (figure - mean).powi(2)).sum::<f64>();
    (mean, (squares / n / (n - 1.0)).sqrt())
}

fn point_mass<const N: usize, const G: usize, T: Transition<1>, L: Likelihood<1>>(
    start: f32,
    run: &Run<T, L>,
) -> f64 {
    let mut filter = PointMassFilter::<1, N>::EMPTY;
    filter.initialise_at([start]);
    errors(run, |dynamics, measurement| {
        filter
            .step(dynamics, measurement, 1.0, &mut [0.0; G])
            .unwrap();
        filter.mean()[0]
    })
}

fn auxiliary<const N: usize, T: Transition<1>, L: Likelihood<1>>(
    start: f32,
    run: &Run<T, L>,
    rng: &mut impl Rng,
) -> f64 {
    let mut filter = AuxiliaryFilter::<1, N>::EMPTY;
    filter.initialise(rng, |_| [start]);
    errors(run, |dynamics, measurement| {
        filter
            .step(dynamics, measurement, 1.0, &mut [0.0; 32], rng)
            .unwrap();
        filter.mean()[0]
    })
}

#[test]
fn fifty_points_are_exact_on_the_growth_model() {
    const RUNS: u64 = 1000;
    let exact = reference::growth::GridFilter::new(STEPS);
    let runs: Vec<[f64; 3]> = (0..RUNS)
        .into_par_iter()
        .map(|seed| {
            let nature = &mut Xoshiro128PlusPlus::seed_from_u64(5000 + seed);
            let run: Run<_, _> = growth::simulate(nature).take(STEPS).collect();
            let measurements: Vec<f64> = run.iter().map(|s| f64::from(s.2.value)).collect();
            let rng = &mut Xoshiro128PlusPlus::seed_from_u64(seed);
            [
                errors_of(&run, exact.means(&measurements)),
                point_mass::<50, 256, _, _>(growth::START, &run),
                auxiliary::<50, _, _>(growth::START, &run, rng),
            ]
        })
        .collect();
    // The floor is that of the same runs, so the ratio scatters far less than either.
    let floor = mean(runs.iter().map(|run| run[0])).0;
    let ratio = |k: usize| {
        let (excess, error) = mean(runs.iter().map(|run| (run[k] - run[0]) / floor));
        let ratio = (1.0 + excess).sqrt();
        println!("{ratio:.4} +- {:.4} x exact", error / (2.0 * ratio));
        ratio
    };
    // Of 2,000 runs 1.0002 +- 0.0002 and 1.086 +- 0.007.
    assert!(ratio(1) < 1.003);
    assert!(ratio(2) < 1.12);
}

type GammaRun = Run<gamma::GammaNoise, gamma::Measurement>;

/// The bootstrap filter.
fn blind(run: &GammaRun, rng: &mut impl Rng) -> f64 {
    let mut filter = ParticleFilter::<1, 10>::new();
    filter.initialise(rng, |_| [gamma::START]);
    errors(run, |dynamics, measurement| {
        filter.predict(dynamics, 1.0, rng);
        filter.update(measurement).unwrap();
        let mean = filter.mean()[0];
        filter.resample(Scheme::Systematic, rng);
        mean
    })
}

/// The unscented particle filter.
fn unscented(run: &GammaRun, rng: &mut impl Rng) -> f64 {
    let mut filter = UnscentedParticleFilter::<1, 10>::EMPTY;
    filter.initialise(rng, &Covariance::ZERO, |_| [gamma::START]);
    errors(run, |dynamics, measurement| {
        // Now and then all ten proposals lie where the noise cannot reach: the weights stay, and it goes on.
        _ = filter.step(&Unscented::DEFAULT, dynamics, measurement, 1.0, rng);
        let mean = filter.mean()[0];
        filter.resample(Scheme::Systematic, rng);
        mean
    })
}

/// Evolution in place of resampling, towards the posterior.
fn evolved(run: &GammaRun, memory: &mut Memory<1, 10>, rng: &mut impl Rng) -> f64 {
    let evolution = DifferentialEvolution::DEFAULT;
    let mut filter = ParticleFilter::<1, 10>::new();
    filter.initialise(rng, |_| [gamma::START]);
    let mut before = [gamma::START; 10];
    errors(run, |dynamics, measurement| {
        filter.predict(dynamics, 1.0, rng);
        let target = posterior(dynamics, measurement, &before);
        filter.refine(&evolution, &target, memory, rng);
        before.copy_from_slice(filter.particles().columns()[0]);
        filter.mean()[0]
    })
}

/// The same with unscented proposals.
fn unscented_evolved(run: &GammaRun, memory: &mut Memory<1, 10>, rng: &mut impl Rng) -> f64 {
    let evolution = DifferentialEvolution::DEFAULT;
    let mut filter = UnscentedParticleFilter::<1, 10>::EMPTY;
    filter.initialise(rng, &Covariance::ZERO, |_| [gamma::START]);
    let mut before = [gamma::START; 10];
    errors(run, |dynamics, measurement| {
        _ = filter.step(&Unscented::DEFAULT, dynamics, measurement, 1.0, rng);
        let target = posterior(dynamics, measurement, &before);
        filter.refine(&evolution, &target, memory, rng);
        before.copy_from_slice(filter.cloud().particles().columns()[0]);
        filter.mean()[0]
    })
}

/// Evolution to get there, then a chain that keeps the posterior, over which the mean is taken.
fn metropolis(run: &GammaRun, memory: &mut Memory<1, 10>, rng: &mut impl Rng) -> f64 {
    let evolution = DifferentialEvolution::DEFAULT;
    let chain = DifferentialEvolution {
        generations: 1,
        ..DifferentialEvolution::METROPOLIS
    };
    let mut filter = ParticleFilter::<1, 10>::new();
    filter.initialise(rng, |_| [gamma::START]);
    let mut before = [gamma::START; 10];
    errors(run, |dynamics, measurement| {
        filter.predict(dynamics, 1.0, rng);
        let target = posterior(dynamics, measurement, &before);
        filter.refine(&evolution, &target, memory, rng);
        let mut sum = 0.0;
        for generation in 0..80 {
            filter.refine(&chain, &target, memory, rng);
            if generation >= 20 {
                sum += filter.mean()[0];
            }
        }
        before.copy_from_slice(filter.particles().columns()[0]);
        sum / 60.0
    })
}

/// RMSE of a run of the model with gamma noise: of the exact filter, and of each of ours with ten particles.
fn gamma_run(variance: f32, seed: u64) -> [f64; 8] {
    let model = reference::gamma::GammaNoise {
        omega: 0.04,
        variance: f64::from(variance),
    };
    let nature = &mut Xoshiro128PlusPlus::seed_from_u64(1000 + seed);
    let run: GammaRun = gamma::simulate(0.04, variance, nature)
        .take(STEPS)
        .collect();
    let measurements: Vec<f64> = run.iter().map(|s| f64::from(s.2.value)).collect();
    let rng = &mut Xoshiro128PlusPlus::seed_from_u64(seed);
    let mut memory = Memory::EMPTY;
    [
        errors_of(&run, model.means(&measurements)),
        blind(&run, rng),
        unscented(&run, rng),
        evolved(&run, &mut memory, rng),
        unscented_evolved(&run, &mut memory, rng),
        metropolis(&run, &mut memory, rng),
        auxiliary::<10, _, _>(gamma::START, &run, rng),
        point_mass::<10, 64, _, _>(gamma::START, &run),
    ]
    .map(f64::sqrt)
}

fn posterior<'a, T, L>(
    transition: &'a T,
    likelihood: &'a L,
    before: &'a [f32],
) -> Posterior<'a, 1, T, L> {
    const EQUAL: [f32; 10] = [0.0; 10];
    Posterior {
        transition,
        dt: 1.0,
        columns: [before],
        log_weights: &EQUAL,
        likelihood,
    }
}

#[test]
fn ten_points_are_exact_on_the_gamma_model() {
    ten_points_are_exact(&[(1e-5, 0.0041), (1.0, 0.608)]);
}

#[test]
#[ignore = "takes too long for every change: a part of `cargo xtask release`"]
fn ten_points_are_exact_with_other_noise() {
    ten_points_are_exact(&[(0.01, 0.124), (0.1, 0.330)]);
}

/// With variances of the measurement's noise, and what the exact filter's error is then.
fn ten_points_are_exact(noises: &[(f32, f64)]) {
    const RUNS: u64 = 300;
    const NAMES: [&str; 8] = [
        "exact",
        "PF",
        "UPF",
        "PFDE",
        "UPFDE",
        "DE-Metropolis",
        "auxiliary",
        "point mass",
    ];
    for &(variance, floor) in noises {
        let runs: Vec<[f64; 8]> = (0..RUNS)
            .into_par_iter()
            .map(|seed| gamma_run(variance, seed))
            .collect();
        let figures: [(f64, f64); 8] = std::array::from_fn(|k| mean(runs.iter().map(|run| run[k])));
        let exact = figures[0].0;
        // Paired with the floor of the same runs.
        let ratios: [f64; 8] = std::array::from_fn(|k| figures[k].0 / exact);
        for (name, ((mean, error), ratio)) in NAMES.iter().zip(figures.iter().zip(ratios)) {
            println!("{variance}: {name} {mean:.5} +- {error:.5}, {ratio:.4} x exact");
        }
        assert!((exact / floor - 1.0).abs() < 0.04);
        let [
            _,
            blind,
            upf,
            pfde,
            upfde,
            metropolis,
            auxiliary,
            point_mass,
        ] = ratios;
        assert!(point_mass < 1.002);
        assert!(auxiliary < 1.02);
        assert!(upf < blind);
        assert!(metropolis < 1.03);
        if variance == 1e-5 {
            // 0.0049 and 0.0050 +- 0.0003 over 2,000 runs: a few of them begin with a generation that finds nothing.
            assert!(figures[3].0 < 0.009 && figures[4].0 < 0.009);
        }
        if variance == 1.0 {
            // It optimises where it should sample.
            assert!(pfde > 1.1 && upfde > 1.1);
        }
    }
}
