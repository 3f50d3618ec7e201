//! The search for modes, and the moves between them.

use super::super::density::Region;
use super::super::mode::{MODES, Mode};
use super::super::search::add;
use super::*;
use crate::kalman::Covariance;
use crate::math::ln;
use crate::random::uniform_open;

#[test]
fn draws_of_the_prior_are_distributed_as_it_says() {
    const N: usize = 100_000;
    // One range, or all between two; distances from the centre within which half of the prior is.
    for (ranges, half) in [([500.0, 500.0], 500.0_f64), ([1.0, 20_000.0], 141.4)] {
        let region = Region::new([100.0, -50.0], ranges);
        let modes = Modes::<PLAIN>::new();
        let proposal = MixtureProposal::new(&modes, region);
        let mut rng = generator(1);
        let mut distances: Vec<f64> = (0..N)
            .map(|_| {
                let [x, y, ..] = proposal.draw(&mut rng).map(f64::from);
                (x - 100.0).hypot(y + 50.0)
            })
            .collect();
        distances.sort_by(f64::total_cmp);
        let within = distances.partition_point(|&r| r < half);
        // Four standard errors.
        assert!((within as f64 / N as f64 - 0.5).abs() < 0.0064, "{within}");
        // By the density itself, summed over rings: a Kolmogorov-Smirnov test at 1.95, one false alarm in 1,000 seeds each.
        let (mut mass, mut inner, mut worst) = (0.0, 0.0, 0.0_f64);
        for step in 0..4_000 {
            let outer = 1e-3 * 1.005_f64.powi(step);
            let middle = ((inner + outer) / 2.0) as f32;
            let log = region.log_density([100.0 + middle, -50.0]) - region.log_volume();
            let area = core::f64::consts::PI * (outer * outer - inner * inner);
            mass += f64::from(log).exp() * area;
            inner = outer;
            let below = distances.partition_point(|&r| r < outer) as f64 / N as f64;
            worst = worst.max((below - mass).abs());
        }
        assert!((mass - 1.0).abs() < 2e-3, "{mass}");
        assert!(worst < 1.95 / (N as f64).sqrt() + 2e-3, "{worst}");
    }
}

#[test]
fn moves_leave_the_mixture_invariant() {
    let (config, evidence) = two_hypotheses();
    let terms = evidence.terms(&config.errors);
    let density = evidence.density(&terms, &config);
    let mut rng = generator(2);
    let modes = search(&evidence, &terms, &config, &Modes::<PLAIN>::new(), &mut rng);
    assert!(modes.len() >= 2, "{modes:?}");
    let region = evidence.region(&config);
    let proposal = MixtureProposal::new(&modes, region);
    let none = Modes::new();
    let prior = MixtureProposal::new(&none, region);
    let likelihood = |s: &State<PLAIN>| density.log_likelihood(s) + s[2].abs() + 0.5 * s[3] * s[3];
    // Of the prior, but with an exponential density of either sign for the scale.
    let mut draw = || {
        let mut state = prior.draw(&mut rng);
        let size = -ln(uniform_open(&mut rng));
        state[2] = if uniform(&mut rng) < 0.5 { size } else { -size };
        state
    };
    let peak = (0..100_000)
        .map(|_| likelihood(&draw()))
        .fold(0.0, f32::max)
        + 1.0;

    // Exact draws by rejection from the prior.
    const N: usize = 20_000;
    let mut exact: [Vec<f32>; PLAIN] = Default::default();
    let mut accept = generator(22);
    while exact[0].len() < N {
        let state = draw();
        let log = likelihood(&state) - peak;
        assert!(log <= 0.0);
        if ln(uniform_open(&mut accept)) < log {
            for (column, value) in exact.iter_mut().zip(state) {
                column.push(value);
            }
        }
    }
    for moves in [1, 2, 5] {
        let mut moved = exact.clone();
        let columns = moved.each_mut().map(Vec::as_mut_slice);
        sweep(columns, &density, &proposal, moves, &mut rng);
        let crossed = (0..N).filter(|&i| (exact[1][i] > 0.0) != (moved[1][i] > 0.0));
        assert!(crossed.count() > N / 100);
        for (before, after) in exact.iter().zip(&mut moved) {
            // Two-sample Kolmogorov-Smirnov: twelve tests at 2.1, one false alarm in 280 seeds.
            let mut before = before.clone();
            before.sort_by(f32::total_cmp);
            after.sort_by(f32::total_cmp);
            let below = |i: usize| after.partition_point(|&v| v <= before[i]) as f64;
            let apart = |i: usize| (below(i) - (i + 1) as f64).abs() / N as f64;
            let distance = (0..N).map(apart).fold(0.0, f64::max);
            let statistic = distance * (N as f64 / 2.0).sqrt();
            assert!(statistic < 2.1, "{moves} moves: {statistic}");
        }
    }
}

#[test]
fn a_particle_in_a_mode_that_was_lost_leaves_it() {
    let errors = Errors::DEFAULT;
    let observations = drive(Track::A2, 0.0, 0.0, 3);
    let evidence = evidence(&errors, &observations);
    let mut rng = generator(3);
    let terms = evidence.terms(&errors);
    let modes = search(
        &evidence,
        &terms,
        &with(errors),
        &Modes::<PLAIN>::new(),
        &mut rng,
    );
    // All particles are a kilometre away, a hundred sigmas, where no mode is known of.
    let mut columns = [
        vec![200.0; 256],
        vec![700.0; 256],
        vec![0.0; 256],
        vec![0.0; 256],
    ];
    let density = evidence.density(&terms, &with(errors));
    let proposal = MixtureProposal::new(&modes, evidence.region(&with(errors)));
    let slices = columns.each_mut().map(Vec::as_mut_slice);
    sweep(slices, &density, &proposal, 1, &mut rng);
    let left = columns[0].iter().filter(|x| **x != 200.0).count();
    assert!(left > 200, "{left}");
}

#[test]
fn a_search_finds_the_source_among_outlier_bearings() {
    let errors = independent();
    for seed in 0..100 {
        let track = if seed % 2 == 0 { Track::A1 } else { Track::A2 };
        let evidence = evidence(&errors, &drive(track, 0.1, 0.4, seed));
        let terms = evidence.terms(&errors);
        let modes = search(
            &evidence,
            &terms,
            &with(errors),
            &Modes::<PLAIN>::new(),
            &mut generator(seed),
        );
        let best = modes
            .iter()
            .max_by(|a, b| a.weight.total_cmp(&b.weight))
            .unwrap();
        let [x, y, ..] = best.mean;
        let off = (x - SOURCE[0]).hypot(y - SOURCE[1]);
        // One of them in hundreds would be further off.
        assert!(off < 60.0, "seed {seed}: {off}");
    }
}

#[test]
fn a_search_finds_the_source_behind_a_bias() {
    // The bias throws crossings a hundred sigmas off the place of the source, and off each other.
    const BIAS: f32 = 0.2;
    const SHARP: f32 = 0.003;
    let errors = Errors {
        bias_sigma_rad: BIAS,
        ..Errors::DEFAULT
    };
    let found = (0..300).filter(|&seed| {
        let mut rng = generator(seed);
        let observations: Vec<Observation> = (0..60)
            .map(|i| {
                let error = BIAS + SHARP * normal(&mut rng);
                let outlier = if uniform(&mut rng) < 0.3 {
                    6.0 * uniform(&mut rng)
                } else {
                    0.0
                };
                towards(Track::A1.receiver(i), SOURCE, error + outlier, SHARP)
            })
            .collect();
        let evidence = evidence(&errors, &observations);
        let terms = evidence.terms(&errors);
        let modes = search(
            &evidence,
            &terms,
            &with(errors),
            &Modes::<PLAIN>::new(),
            &mut generator(seed),
        );
        let off = |mode: &Mode<PLAIN>| (mode.mean[0] - SOURCE[0]).hypot(mode.mean[1] - SOURCE[1]);
        modes.iter().any(|mode| off(mode) < 60.0)
    });
    let found = found.count();
    // 294 of these; by their own sigmas, without a bias in them, candidates give 268. One search of many.
    assert!(found > 283, "{found}");
}

#[test]
fn a_mode_along_a_ray_does_not_swallow_what_lies_on_it() {
    let (config, evidence) = two_hypotheses();
    let terms = evidence.terms(&config.errors);
    let density = evidence.density(&terms, &config);
    let mut rng = generator(4);
    let modes = search(&evidence, &terms, &config, &Modes::<PLAIN>::new(), &mut rng);
    let known = modes[0];
    let narrow = Covariance::diagonal([1.0, 1.0, 0.1, 0.1]);
    let mut other = Mode {
        covariance: narrow,
        ..known
    };
    other.mean[0] += 5.0;
    // The wide one's sigmas hold the narrow one's mean, but not the other way.
    assert!(known.distance(&other.mean) < 4.0 && other.distance(&known.mean) > 4.0);
    let mut both = Modes::new();
    for mode in [known, other, known] {
        add(&mut both, mode);
    }
    assert_eq!(both.len(), 2);
    // A fifth takes the place of the lightest.
    for i in 0..4 {
        let mut further = other;
        further.mean[1] += 1000.0 * (i + 1) as f32;
        further.log_mass = 100.0 + i as f32;
        add(&mut both, further);
    }
    assert_eq!(both.len(), MODES);
    assert!(both.iter().all(|mode| mode.log_mass >= 100.0));
    assert!(density.log_density(&known.mean).is_finite());
}
