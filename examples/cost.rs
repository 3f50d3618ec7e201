//! What the library costs: one step of a filter, phase by phase, and the kernels it is made of.
//!
//! `cargo xtask cost` runs it in the emulator, where the tasks count the instructions between the edges of
//! its regions, and on the host, where it takes the time itself.

#![cfg_attr(target_os = "none", no_std, no_main)]

use core::hint::black_box;

use foxhunt::{
    aoa::{Bearing, BearingLikelihood, Observation},
    filter::ParticleFilter,
    math,
    model::RandomWalk,
    random::{SeedableRng, Xoshiro128PlusPlus, normal},
    resample::Scheme,
};

/// Where the source stands, in metres east and north.
const SOURCE: [f32; 2] = [1200.0, 800.0];
/// Standard deviation of a bearing, in radians.
const BEARING_SIGMA_RAD: f32 = 0.0195;
/// A metre after one second: two normal samples for each particle and step.
const DYNAMICS: RandomWalk<2> = RandomWalk { sigma: [1.0, 1.0] };

/// A filter that tracks the source by bearings from a vehicle, which drives east at 25 m/s.
struct Track<const N: usize> {
    filter: ParticleFilter<2, N>,
    rng: Xoshiro128PlusPlus,
    second: u32,
}

impl<const N: usize> Track<N> {
    fn new() -> Self {
        let mut rng = Xoshiro128PlusPlus::seed_from_u64(1);
        let mut filter = ParticleFilter::new();
        filter.initialise(&mut rng, |rng| {
            [
                SOURCE[0] + 50.0 * normal(rng),
                SOURCE[1] + 50.0 * normal(rng),
            ]
        });
        Self {
            filter,
            rng,
            second: 0,
        }
    }

    /// The next bearing, with its error.
    fn likelihood(&mut self) -> BearingLikelihood {
        let east = 25.0 * self.second as f32;
        self.second += 1;
        let direction = math::atan2(SOURCE[1], SOURCE[0] - east);
        let measured = direction + BEARING_SIGMA_RAD * normal(&mut self.rng);
        let bearing = Bearing::from_radians(measured);
        let observation =
            Observation::new(1000 * self.second, [east, 0.0], bearing, BEARING_SIGMA_RAD);
        black_box(BearingLikelihood::new(
            &observation.expect("the drive is short"),
        ))
    }

    fn predict(&mut self) {
        self.filter.predict(&DYNAMICS, 1.0, &mut self.rng);
    }

    fn update(&mut self, likelihood: &BearingLikelihood) {
        black_box(self.filter.update(likelihood)).expect("the cloud lies around the source");
    }

    fn resample(&mut self) {
        self.filter.resample(Scheme::Systematic, &mut self.rng);
    }

    /// A whole step, which always resamples.
    fn step(&mut self, likelihood: &BearingLikelihood) {
        self.predict();
        self.update(likelihood);
        black_box(self.filter.mean());
        self.resample();
    }
}

foxhunt_emulated::program!(board: target::run);

#[cfg(target_os = "none")]
mod target {
    use cortex_m_semihosting::hprintln;
    use foxhunt::{
        aoa::{Locator, Robust, robust},
        model::Likelihood,
        refine::{Acceptance, DifferentialEvolution, Firefly, FishSchool, Memory, Refinement},
    };
    use foxhunt_emulated::region::region;
    use micromath::F32Ext;

    use super::*;

    const N: usize = 200;
    /// Steps until the cloud has taken its usual shape.
    const WARM_UP: usize = 4;
    const STEPS: usize = 8;

    /// Runs all regions.
    pub fn run() {
        steps();
        kernels();
        other_kernels();
        refinements();
        robust();
    }

    /// Whole steps, then each phase of as many others.
    fn steps() {
        hprintln!(
            "figure\tfilter.d2.n200.bytes\t{}\tbytes",
            size_of::<ParticleFilter<2, N>>()
        );
        let mut track = black_box(Track::<N>::new());
        for _ in 0..WARM_UP {
            let likelihood = track.likelihood();
            track.step(&likelihood);
        }
        for _ in 0..STEPS {
            let likelihood = track.likelihood();
            region("m4f.step.n200", N, || track.step(&likelihood));
        }
        let mut log_likelihoods = [0.0; N];
        for _ in 0..STEPS {
            let likelihood = track.likelihood();
            region("m4f.step.n200.predict", N, || track.predict());
            let columns = track.filter.particles().columns();
            region("m4f.step.n200.weigh", N, || {
                likelihood.log_likelihoods(&columns, &mut log_likelihoods);
            });
            black_box(&log_likelihoods);
            region("m4f.step.n200.update", N, || track.update(&likelihood));
            region("m4f.step.n200.mean", N, || track.filter.mean());
            region("m4f.step.n200.resample", N, || track.resample());
        }
    }

    /// Each kernel, over an array.
    // Apart: in the frame of all of `main`, arrays lie so far that a loop needs an instruction more to reach them.
    #[inline(never)]
    fn kernels() {
        let (a, pairs) = arguments();
        kernel("m4f.math.exp", &a, math::exp);
        kernel("m4f.math.ln", &a.map(f32::abs), math::ln);
        kernel("m4f.math.sqrt", &a.map(f32::abs), math::sqrt);
        kernel("m4f.math.wrap", &a, math::wrap);
        kernel("m4f.math.atan2", &pairs, |[y, x]| math::atan2(y, x));
        kernel("m4f.math.sin_cos", &a, math::sin_cos);
        let mut rng = Xoshiro128PlusPlus::seed_from_u64(2);
        kernel("m4f.random.normal", &a, |_| normal(&mut rng));
    }

    /// Normal samples, and pairs of them.
    #[inline(never)]
    fn arguments() -> ([f32; N], [[f32; 2]; N]) {
        let mut rng = Xoshiro128PlusPlus::seed_from_u64(2);
        let mut a = [0.0; N];
        a.fill_with(|| normal(&mut rng));
        let pairs = a.map(|y| [y, normal(&mut rng)]);
        (a, pairs)
    }

    /// The elementary functions of others, over the same arrays.
    #[inline(never)]
    fn other_kernels() {
        let (a, pairs) = arguments();
        let magnitudes = a.map(f32::abs);
        kernel("m4f.math.exp.libm", &a, libm::expf);
        kernel("m4f.math.exp.micromath", &a, F32Ext::exp);
        kernel("m4f.math.ln.libm", &magnitudes, libm::logf);
        kernel("m4f.math.ln.micromath", &magnitudes, F32Ext::ln);
        kernel("m4f.math.sqrt.libm", &magnitudes, libm::sqrtf);
        kernel("m4f.math.sqrt.micromath", &magnitudes, F32Ext::sqrt);
        kernel("m4f.math.atan2.libm", &pairs, |[y, x]| libm::atan2f(y, x));
        kernel("m4f.math.atan2.micromath", &pairs, |[y, x]| {
            F32Ext::atan2(y, x)
        });
        kernel("m4f.math.sin_cos.libm", &a, libm::sincosf);
        kernel("m4f.math.sin_cos.micromath", &a, F32Ext::sin_cos);
    }

    /// One iteration of each refinement, by a density that costs next to nothing, and of the school by a bearing as well.
    fn refinements() {
        // So far a fish sees a dozen mates on average.
        let school = FishSchool {
            perception: 0.22,
            ..FishSchool::DEFAULT
        };
        refinement::<1000>("m4f.refine.fish.n1000", &school, &bowl);
        let likelihood = Track::<1>::new().likelihood();
        refinement::<1000>("m4f.refine.fish.n1000.bearing", &school, &likelihood);
        let metropolis = FishSchool {
            acceptance: Acceptance::Metropolis,
            ..school
        };
        refinement::<N>("m4f.refine.fish.metropolis", &metropolis, &bowl);

        let flutter = 0.3;
        let standard = Firefly {
            flutter,
            ..Firefly::STANDARD
        };
        refinement::<80>("m4f.refine.firefly.standard", &standard, &bowl);
        let improved = Firefly {
            flutter,
            ..Firefly::DEFAULT
        };
        refinement::<80>("m4f.refine.firefly.improved", &improved, &bowl);

        let evolution = DifferentialEvolution {
            generations: 1,
            ..DifferentialEvolution::DEFAULT
        };
        refinement::<N>("m4f.refine.evolution.greedy", &evolution, &bowl);
        let metropolis = DifferentialEvolution {
            acceptance: Acceptance::Metropolis,
            ..evolution
        };
        refinement::<N>("m4f.refine.evolution.metropolis", &metropolis, &bowl);
    }

    /// A bearing that has a robust locator search for its modes and move its particles: few of them, for a log of all
    /// instructions.
    fn robust() {
        robust_updates::<16>("m4f.robust.n16.update");
        robust_updates::<64>("m4f.robust.n64.update");
    }

    fn robust_updates<const M: usize>(name: &str) {
        let locator = Locator::<Robust<M>>::new(robust::Config::DEFAULT);
        let mut locator = black_box(locator.expect("the default is right"));
        let mut rng = Xoshiro128PlusPlus::seed_from_u64(3);
        for second in 0..72 {
            let east = 20.0 * second as f32;
            let error = BEARING_SIGMA_RAD * normal(&mut rng);
            let outlier = if second % 5 == 0 { east } else { 0.0 };
            let direction = math::atan2(SOURCE[1], SOURCE[0] - east) + error + outlier;
            let bearing = Bearing::from_radians(direction);
            let observation =
                Observation::new(1000 * second, [east, 0.0], bearing, BEARING_SIGMA_RAD);
            let observation = observation.expect("the drive is short");
            // One of eight bearings has them moved.
            if second < 64 {
                locator.push(&observation, &mut rng).expect("in order");
            } else {
                region(name, 8, || locator.push(&observation, &mut rng)).expect("in order");
            }
        }
    }

    /// As wide as the clouds of tracks are when they begin.
    fn bowl([x, y]: &[f32; 2]) -> f32 {
        let (dx, dy) = (x - SOURCE[0], y - SOURCE[1]);
        -0.5 / (50.0 * 50.0) * (dx * dx + dy * dy)
    }

    #[inline(never)]
    fn refinement<const M: usize>(
        name: &str,
        refinement: &impl Refinement<2>,
        target: &impl Likelihood<2>,
    ) {
        let mut track = black_box(Track::<M>::new());
        let mut memory = black_box(Memory::EMPTY);
        region(name, M, || {
            let Track { filter, rng, .. } = &mut track;
            filter.refine(refinement, target, &mut memory, rng)
        });
    }

    // Always inlined: the code of a kernel's loop does not depend on how many others there are.
    #[inline(always)]
    fn kernel<A: Copy, B: Copy + Default>(
        name: &str,
        arguments: &[A; N],
        mut function: impl FnMut(A) -> B,
    ) {
        let arguments = black_box(arguments);
        let mut results = [B::default(); N];
        region(name, N, || {
            // Four at a time, as the library's own passes are.
            let (blocks, _) = results.as_chunks_mut::<4>();
            for (results, arguments) in blocks.iter_mut().zip(arguments.as_chunks::<4>().0) {
                *results = arguments.map(&mut function);
            }
            black_box(&mut results);
        });
    }
}

/// Takes the time on the host. The smallest of several medians is what the work takes when nothing disturbs
/// it.
#[cfg(not(target_os = "none"))]
fn main() {
    use std::time::Instant;

    const N: usize = 1000;
    const STEPS: u32 = 40;
    const REPETITIONS: usize = 101;
    const ROUNDS: usize = 9;

    let mut fastest = f64::INFINITY;
    for _ in 0..ROUNDS {
        let mut times = Vec::new();
        for _ in 0..REPETITIONS {
            let mut track = Box::new(Track::<N>::new());
            let likelihoods: Vec<_> = (0..STEPS).map(|_| track.likelihood()).collect();
            let start = Instant::now();
            for likelihood in &likelihoods {
                track.step(likelihood);
            }
            times.push(start.elapsed().as_nanos() as f64 / f64::from(STEPS) / N as f64);
        }
        times.sort_by(f64::total_cmp);
        fastest = fastest.min(times[REPETITIONS / 2]);
    }
    println!("figure\thost.step.n1000.ns\t{fastest}\tns");
}
