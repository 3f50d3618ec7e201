use foxhunt::{
    kalman::{Covariance, Unscented},
    math,
    model::{Dynamics, Likelihood, RandomWalk},
    proposal::{AuxiliaryFilter, PointMassFilter, Posterior, Sensor, UnscentedParticleFilter},
    random::{Rng, SeedableRng, Xoshiro128PlusPlus, normal},
    refine::{DifferentialEvolution, Memory},
    resample::Scheme,
};
use foxhunt_problems::gamma;

use super::{Case, Digest};

pub const CASES: &[Case] = &[
    ("proposal::gamma_noise", gamma_noise),
    ("proposal::ranges_in_the_plane", ranges_in_the_plane),
];

/// The three filters on one run of the gamma-noise model.
fn gamma_noise() -> Digest {
    let mut rng = Xoshiro128PlusPlus::seed_from_u64(1);
    let mut digest = Digest::new();
    let mut unscented = UnscentedParticleFilter::<1, 10>::EMPTY;
    unscented.initialise(&mut rng, &Covariance::diagonal([1e-3]), |_| [1.0]);
    let mut auxiliary = AuxiliaryFilter::<1, 10>::EMPTY;
    auxiliary.initialise(&mut rng, |_| [1.0]);
    let mut points = PointMassFilter::<1, 10>::EMPTY;
    points.initialise_at([1.0]);
    let mut memory = [0.0; 64];
    let mut simulator = rng.clone();
    for (dynamics, _, measurement) in gamma::simulate(0.04, 0.1, &mut simulator).take(50) {
        let parameters = &Unscented::DEFAULT;
        let evidence = [
            unscented
                .step(parameters, &dynamics, &measurement, 1.0, &mut rng)
                .ok(),
            auxiliary
                .step(&dynamics, &measurement, 1.0, &mut memory, &mut rng)
                .ok(),
            points.step(&dynamics, &measurement, 1.0, &mut memory).ok(),
        ];
        digest.add(&evidence.map(|evidence| evidence.unwrap_or(f32::NAN)));
        digest.add(&[unscented.mean()[0], auxiliary.mean()[0], points.mean()[0]]);
        digest.add(unscented.covariance().as_flattened());
        digest.add(auxiliary.covariance().as_flattened());
        digest.add(points.covariance().as_flattened());
        digest.add(unscented.cloud().particles().columns()[0]);
        digest.add(auxiliary.particles().columns()[0]);
        digest.add(points.columns()[0]);
        digest.add(unscented.cloud().weights());
        digest.add(auxiliary.log_weights());
        digest.add(points.log_weights());
        unscented.resample(Scheme::Systematic, &mut rng);
    }
    digest
}

/// A distance from a beacon.
struct Range {
    beacon: [f32; 2],
    measured: f32,
}

const SIGMA: f32 = 0.3;

impl Likelihood<2> for Range {
    fn log_likelihood(&self, state: &[f32; 2]) -> f32 {
        let [residual] = self.residual(state);
        -0.5 * residual * residual / (SIGMA * SIGMA)
    }
}

impl Sensor<2, 1> for Range {
    fn residual(&self, [x, y]: &[f32; 2]) -> [f32; 1] {
        let [east, north] = self.beacon;
        let (dx, dy) = (x - east, y - north);
        [self.measured - math::sqrt(dx * dx + dy * dy)]
    }

    fn noise(&self) -> Covariance<1> {
        Covariance::diagonal([SIGMA])
    }
}

/// A walk among three beacons: where it has got to, and how far from one of them.
fn walk<R: Rng>(dynamics: &RandomWalk<2>, rng: &mut R) -> impl Iterator<Item = ([f32; 2], Range)> {
    let mut place = [0.0; 2];
    (0..12).map(move |step| {
        place = dynamics.step(place, 0.5, rng);
        let beacon = [[4.0, 1.0], [-3.0, 5.0], [0.5, -6.0]][step % 3];
        let exact = Range {
            beacon,
            measured: 0.0,
        };
        let [distance] = exact.residual(&place).map(|residual| -residual);
        let measured = distance + SIGMA * normal(rng);
        (place, Range { beacon, measured })
    })
}

/// The three filters on a walk among beacons; the unscented one refined by evolution.
fn ranges_in_the_plane() -> Digest {
    let mut rng = Xoshiro128PlusPlus::seed_from_u64(2);
    let mut digest = Digest::new();
    let dynamics = RandomWalk { sigma: [1.2, 0.9] };
    let prior = |[x, y]: &[f32; 2]| -2.0 * (x * x + y * y);
    let mut unscented = UnscentedParticleFilter::<2, 24>::EMPTY;
    let own = Covariance::diagonal([0.5; 2]);
    unscented.initialise(&mut rng, &own, |_| [0.0; 2]);
    let mut auxiliary = AuxiliaryFilter::<2, 12>::EMPTY;
    auxiliary.initialise(&mut rng, |rng| [0.5 * normal(rng), 0.5 * normal(rng)]);
    let mut points = PointMassFilter::<2, 30>::EMPTY;
    let mut cells = [0.0; 300];
    let begun = points.initialise([-6.0; 2], [6.0; 2], prior, &mut cells);
    begun.expect("the prior has mass");
    let mut memory = Memory::EMPTY;
    let mut simulator = rng.clone();
    let mut off = [0.0_f32; 3];
    for (step, (truth, range)) in walk(&dynamics, &mut simulator).enumerate() {
        let before = unscented.cloud().clone();
        let evidence = [
            unscented.step(&Unscented::DEFAULT, &dynamics, &range, 0.5, &mut rng),
            auxiliary.step(&dynamics, &range, 0.5, &mut [0.0; 260], &mut rng),
            points.step(&dynamics, &range, 0.5, &mut cells),
        ];
        digest.add(&evidence.map(|evidence| evidence.expect("the walk is followed")));
        if step % 4 == 3 {
            let posterior = Posterior {
                transition: &dynamics,
                dt: 0.5,
                columns: before.particles().columns(),
                log_weights: before.log_weights(),
                likelihood: &range,
            };
            let evolution = DifferentialEvolution {
                generations: 2,
                ..DifferentialEvolution::DEFAULT
            };
            unscented.refine(&evolution, &posterior, &mut memory, &mut rng);
        }
        for column in (unscented.cloud().particles().columns().into_iter())
            .chain(auxiliary.particles().columns())
            .chain(points.columns())
        {
            digest.add(column);
        }
        digest.add(auxiliary.log_weights());
        digest.add(points.log_weights());
        for covariance in [
            unscented.covariance(),
            auxiliary.covariance(),
            points.covariance(),
        ] {
            digest.add(covariance.as_flattened());
        }
        let means = [unscented.mean(), auxiliary.mean(), points.mean()];
        digest.add(means.as_flattened());
        for (off, [x, y]) in off.iter_mut().zip(means) {
            *off = off.max((x - truth[0]).abs().max((y - truth[1]).abs()));
        }
        unscented.resample(Scheme::Systematic, &mut rng);
    }
    assert!(off.iter().all(|off| *off < 2.5), "{off:?}");
    digest
}
