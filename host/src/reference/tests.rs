//! The reference, checked.

use std::path::PathBuf;

use nalgebra::Vector2;
use rand::RngExt;
use rayon::prelude::*;

use super::{
    Biases, Brute, ByDirection, Difference, Model, Posterior, Prior, Square, biases_by_station,
    cell::Cell, cramer_rao, cramer_rao_of_biased, gauss_newton, likelihood::Likelihood,
};
use crate::{measured::Measured, simulate, tracks::Track};
use foxhunt_simulation::{Sight, faults::Faults, random};

/// One of each kind, and all kinds that may be together.
pub fn faults() -> [Faults; 5] {
    let clean = Faults::default();
    [
        clean,
        Faults {
            outlier_rate: 0.3,
            ..clean
        },
        Faults {
            mirrored_rate: 0.5,
            ..clean
        },
        Faults {
            outlier_rate: 0.1,
            mirrored_rate: 0.2,
            ..clean
        },
        Faults {
            bias_sigma: 0.05,
            ..clean
        },
    ]
}

/// What else the posterior takes for known, with `sights` along a track.
pub fn models(sights: &[Sight]) -> Vec<(&'static str, Model)> {
    let of = |faults: Faults| Model::with_faults(&faults);
    let [clean, _, _, mixed, bias] = faults().map(of);
    let [first, last] = [&sights[0], &sights[sights.len() - 1]].map(|sight| sight.position);
    let heading = f64::atan2(last[1] - first[1], last[0] - first[0]);
    let by_direction = ByDirection::new(vec![heading; sights.len()], 2, 0.1);
    let learned = ByDirection {
        mean: by_direction.mean.add_scalar(0.3),
        root: &by_direction.root * 0.4,
        ..by_direction.clone()
    };
    // Four arrays, each with a bearing in four.
    let stations: Vec<Sight> = (sights.iter().enumerate())
        .map(|(k, sight)| Sight {
            position: [(k % 4) as f64, 0.0],
            ..*sight
        })
        .collect();
    let ranged = |nearest_m| Prior::Ranged {
        centre: first,
        nearest_m,
        range_m: 20_000.0,
    };
    let scaled = |model| Model {
        scale_sigma: 0.15,
        ..model
    };
    let with = |biases| Model {
        biases,
        ..clean.clone()
    };
    let at = |prior, model| Model { prior, ..model };
    let stations = biases_by_station(&stations, 0.05);
    vec![
        ("scale", scaled(clean.clone())),
        ("scale and faults", scaled(mixed.clone())),
        ("scale and bias", scaled(bias)),
        ("near", at(ranged(1.0), clean.clone())),
        ("far, faults", at(ranged(20_000.0), mixed)),
        (
            "direction",
            at(ranged(1.0), with(Biases::ByDirection(by_direction))),
        ),
        (
            "direction, learned, scale",
            scaled(with(Biases::ByDirection(learned))),
        ),
        ("stations", with(stations)),
    ]
}

fn near(a: &Posterior, b: &Posterior) {
    let off = Difference::new(a.mean, &a.covariance, (b.mean, &b.covariance));
    assert!(off.mean < 0.01 && off.sigma < 0.01, "{off:?}");
}

/// Where the posterior is narrow it is normal: mean and covariance are the maximum's.
#[test]
fn narrow_posterior_is_the_maximum_likelihood() {
    let mut track = Track::a2();
    track.sigma = 1e-4;
    let sights = simulate::bearings(&track, &mut random::generator(1, 0));
    let posterior = Posterior::new(&sights).unwrap();
    let maximum = gauss_newton(&sights, [1000.0, 1000.0]).unwrap();
    let bound = cramer_rao(&sights, track.source).unwrap();
    let off = Difference::new(
        posterior.mean,
        &posterior.covariance,
        (maximum.place, &bound),
    );
    assert!(off.mean < 0.005 && off.sigma < 0.005, "{off:?}");
    let off = Difference::new(posterior.mode, &bound, (maximum.place, &bound));
    assert!(off.mean < 0.002, "{off:?}");
    // And so is the density at the maximum.
    let peak = 1.0 / (std::f64::consts::TAU * posterior.covariance.determinant().sqrt());
    assert!((posterior.density(posterior.mode) / peak - 1.0).abs() < 0.01);
}

#[test]
fn parallel_bearings_have_no_posterior() {
    let sight = |x| Sight {
        time_ms: 1000 * x as u32,
        position: [x, 0.0],
        bearing: 0.0,
        sigma: 0.02,
    };
    assert!(Posterior::new(&[sight(0.0), sight(1.0)]).is_none());
    assert!(Posterior::new(&[sight(0.0), sight(0.0)]).is_none());
}

/// On every track, with faults of another kind each, it is what a uniform grid says: `cargo xtask papers reference` has them all.
#[test]
fn brute_force_says_the_same() {
    let all = Track::all();
    let pairs = all.iter().zip(faults().into_iter().cycle());
    pairs.par_bridge().for_each(|(track, faults)| {
        let mut sights = simulate::bearings(track, &mut random::generator(31, 0));
        faults.spoil(&mut sights, &mut random::generator(32, 0));
        let square = Square::round(&sights).unwrap();
        let posterior = Posterior::with_faults(&sights, &faults).unwrap();
        let brute = Brute::new(&square, &sights, &Model::with_faults(&faults), 512);
        let name = format!("{} {faults:?}", track.name);
        assert_same(&name, &posterior, &brute, [1e-3, 1e-3]);
        let same = posterior.log_likelihood(brute.maximum.1) - brute.maximum.0;
        let higher = posterior.log_likelihood(posterior.mode) - brute.maximum.0;
        assert!(same.abs() < 1e-6 && higher > -1e-6, "{same} {higher}");
        assert!(posterior.discarded <= 1e-6);
    });
}

/// Asserts that mean and standard deviations are within so many standard deviations of those of a uniform grid, and the
/// evidence within a thousandth.
fn assert_same(name: &str, posterior: &Posterior, brute: &Brute, [mean, sigma]: [f64; 2]) {
    let grid = brute.grid.as_ref().unwrap();
    let off = Difference::new(
        posterior.mean,
        &posterior.covariance,
        (grid.mean, &grid.covariance),
    );
    let evidence = (posterior.log_evidence - grid.log_evidence).abs();
    assert!(
        off.mean < mean && off.sigma < sigma && evidence < 1e-3,
        "{name}: {off:?}, evidence {evidence:.1e} off"
    );
}

/// So it is with a scale, biases and a prior that depends on range.
#[test]
fn brute_force_says_the_same_of_other_models() {
    let cases = [Track::a2()].into_iter().flat_map(|mut track| {
        // An eighth of the bearings, or the grids would take minutes.
        track.receivers = track.receivers.into_iter().step_by(8).collect();
        let sights = simulate::bearings(&track, &mut random::generator(33, 0));
        let models = models(&sights).into_iter();
        models.map(move |(name, model)| (track.name, sights.clone(), name, model))
    });
    cases
        .par_bridge()
        .for_each(|(track, mut sights, name, model)| {
            (model.faults).spoil(&mut sights, &mut random::generator(34, 0));
            let square = Square::round(&sights).unwrap();
            let posterior = Posterior::within(&square, &sights, &model).unwrap();
            let brute = Brute::new(&square, &sights, &model, 256);
            let name = format!("{track} {name}");
            assert_same(&name, &posterior, &brute, [2e-3, 3e-3]);
        });
}

/// In rooms, where some bearings are far off: one transmitter in sight, and two that are not.
#[test]
fn measured_rooms_are_what_brute_force_says() {
    let Some(data) = std::env::var_os("FOXHUNT_DATA").map(PathBuf::from) else {
        println!("skipped: FOXHUNT_DATA does not name the directory of the measured data");
        return;
    };
    let rooms = [("los", "tx2"), ("nlos", "tx3"), ("nlos", "tx4")];
    // With faults tx3 needs a finer grid than takes seconds.
    let cases = rooms
        .iter()
        .flat_map(|room| faults().map(|faults| (room, faults)))
        .filter(|(room, faults)| room.1 != "tx3" || *faults == Faults::default());
    cases.par_bridge().for_each(|((set, transmitter), faults)| {
        let file = data.join(format!("wsr/{set}_set_a.csv"));
        let sights: Vec<Sight> = (Measured::read(&file, transmitter).unwrap().bearings.iter())
            .map(|(position, degrees)| Sight {
                time_ms: 0,
                position: *position,
                bearing: degrees.to_radians(),
                sigma: 3f64.to_radians(),
            })
            .collect();
        let square = Square::round(&sights).unwrap();
        let posterior = Posterior::within(&square, &sights, &Model::with_faults(&faults)).unwrap();
        let grid = Brute::new(&square, &sights, &Model::with_faults(&faults), 2048)
            .grid
            .unwrap();
        let off = Difference::new(
            posterior.mean,
            &posterior.covariance,
            (grid.mean, &grid.covariance),
        );
        assert!(
            off.mean < 0.01 && off.sigma < 0.01,
            "{set} {transmitter} {faults:?}: {off:?}"
        );
    });
}

#[test]
fn faults_that_are_rare_make_no_difference() {
    for run in 0..10 {
        let sights = simulate::bearings(&Track::a1(), &mut random::generator(7, run));
        let plain = Posterior::new(&sights).unwrap();
        let next_to_none = Faults {
            outlier_rate: 1e-5,
            mirrored_rate: 1e-5,
            bias_sigma: 0.0,
        };
        near(
            &Posterior::with_faults(&sights, &next_to_none).unwrap(),
            &plain,
        );
        let straight = Faults {
            bias_sigma: 1e-5,
            ..Faults::default()
        };
        near(&Posterior::with_faults(&sights, &straight).unwrap(), &plain);
    }
}

#[test]
fn narrow_posterior_of_biased_bearings_is_their_bound() {
    let sights = simulate::bearings(&Track::a2(), &mut random::generator(8, 0));
    let biased = cramer_rao_of_biased(&sights, Track::a2().source, 0.05).unwrap();
    let faults = Faults {
        bias_sigma: 0.05,
        ..Faults::default()
    };
    let posterior = Posterior::with_faults(&sights, &faults).unwrap();
    let ratio = posterior.covariance.trace() / biased.trace();
    assert!((0.8..1.25).contains(&ratio), "{ratio}");
}

#[test]
fn mirrored_bearings_say_as_much_as_direct_ones() {
    let sights = simulate::bearings(&Track::a2(), &mut random::generator(8, 0));
    let mut turned = sights.clone();
    let half = Faults {
        mirrored_rate: 0.5,
        ..Faults::default()
    };
    half.spoil(&mut turned, &mut random::generator(9, 0));
    assert_ne!(turned, sights);
    near(
        &Posterior::with_faults(&turned, &half).unwrap(),
        &Posterior::new(&sights).unwrap(),
    );
}

#[test]
fn a_bias_is_found_if_it_is_known_of() {
    let track = Track::a2();
    let mut sights = simulate::bearings(&track, &mut random::generator(10, 0));
    for sight in &mut sights {
        sight.bearing += 0.1;
    }
    let off = |posterior: Posterior| {
        (posterior.mean[0] - track.source[0]).hypot(posterior.mean[1] - track.source[1])
    };
    let biased = Faults {
        bias_sigma: 0.1,
        ..Faults::default()
    };
    assert!(off(Posterior::new(&sights).unwrap()) > 20.0);
    assert!(off(Posterior::with_faults(&sights, &biased).unwrap()) < 12.0);
}

/// The bound holds at random places of random cells, large and small, near the receivers and far, and is tight where a cell is
/// small.
#[test]
fn nothing_in_a_cell_is_above_its_bound() {
    let mut rng = random::generator(21, 0);
    let sights = simulate::bearings(&Track::a2(), &mut rng);
    let plain = faults().map(|faults| ("faults", Model::with_faults(&faults)));
    for (name, model) in plain.into_iter().chain(models(&sights)) {
        let mut sights = sights.clone();
        model.faults.spoil(&mut sights, &mut rng);
        let likelihood = Likelihood::new(&sights, &model);
        for _ in 0..3000 {
            let mut any = |size: f64| [0, 1].map(|_| size * rng.random_range(-1.0..1.0));
            let half = any(6.0).map(f64::exp2);
            let size = any(6.0)[0].exp2();
            let cell = Cell {
                centre: Vector2::from(any(3000.0)),
                half: Vector2::from(half) * size,
            };
            let bound = likelihood.bound(&cell);
            for _ in 0..10 {
                let place = cell.centre + cell.half.component_mul(&Vector2::from(any(1.0)));
                let log = likelihood.with_prior(place);
                assert!(log <= bound.log + 1e-9, "{name}: {cell:?}");
            }
            let point = Cell {
                half: Vector2::repeat(1e-9),
                ..cell
            };
            let off = likelihood.bound(&point).log - likelihood.with_prior(point.centre);
            assert!(off.abs() < 1e-3, "{name}: {off}");
        }
    }
}
