//! What one bearing says.

use core::f64::consts::{PI, TAU};

use super::*;
use crate::aoa::core::{BLOCK, Target};

#[test]
fn a_term_is_the_mixture_over_what_a_bearing_is() {
    let density = |z: f64| (-0.5 * z * z).exp() / TAU.sqrt();
    for sigma in [0.01, 0.05, 0.3] {
        let errors = Errors {
            bias_sigma_rad: 0.01,
            ..Errors::DEFAULT
        };
        let bearing = Bearing::from_radians(2.0);
        let observation = Observation::new(0, [3.0, -2.0], bearing, sigma).unwrap();
        let term = term(&observation, &errors);
        for step in 0..500 {
            let angle = f64::from(step) * 0.0126 - PI;
            let radius = 10f64.powi(step % 5);
            let [x, y] = [3.0 + radius * angle.cos(), -2.0 + radius * angle.sin()];
            let bias = f64::from(step % 7) * 0.01 - 0.03;
            let got = term.log_likelihood(&[x as f32, y as f32, 0.0, 100.0 * bias as f32]);

            let s = f64::from(sigma);
            let turn = |a: f64| a - TAU * (a / TAU).round();
            let e = turn(angle - 2.0 + bias);
            let sum = 0.8 * density(e / s) / s + 0.08 * density(turn(e + PI) / s) / s;
            let exact = (1.0 + sum * TAU / 0.12).ln();
            // An angle that is off by 2e-5; a peak that is a right angle off or more.
            let limit = 2e-3 + 2e-5 / s * 9.0;
            assert!(
                (f64::from(got) - exact).abs() < limit,
                "{sigma} {angle}: {got} {exact}"
            );
        }
    }
}

#[test]
fn a_line_says_the_same_at_infinity() {
    let errors = Errors::DEFAULT;
    let observation = towards([10.0, 20.0], [-700.0, 300.0], 0.0, 0.05);
    let term = term(&observation, &errors);
    for step in -30..30 {
        let direction = step as f32 * 0.1;
        let far = 1e5;
        let place = [
            10.0 + far * direction.cos(),
            20.0 + far * direction.sin(),
            0.0,
            0.3,
        ];
        let near = term.line(&place);
        let far = term.line_far(&[direction, 0.0, 0.0, 0.3]);
        assert!((near.error - far.error).abs() < 1e-4 && near.mirrored == far.mirrored);
    }
}

#[test]
fn the_density_of_many_states_is_that_of_each() {
    let (config, evidence) = two_hypotheses();
    let terms = evidence.terms(&config.errors);
    let density: Density<'_, PLAIN> = evidence.density(&terms, &config);
    let mut rng = generator(14);
    let states: [State<PLAIN>; BLOCK] = core::array::from_fn(|_| {
        [
            800.0 * normal(&mut rng),
            800.0 * normal(&mut rng),
            3.0 * normal(&mut rng),
            normal(&mut rng),
        ]
    });
    let columns = core::array::from_fn(|d| states.map(|state| state[d]));
    for (state, log) in states.iter().zip(density.log_densities(&columns)) {
        assert!((log - density.log_density(state)).abs() < 1e-4);
    }
}
