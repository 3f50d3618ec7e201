//! What the methods of the published studies take: whole runs of each, on problems that the board simulates itself.
//!
//! `cargo xtask papers` runs it in the emulator, with a clock that counts instructions. The argument names the study.
//! Lines of `figure<TAB>name<TAB>value<TAB>unit` come back, one of each run. On the host the methods run within the
//! tasks, and this does nothing.

#![cfg_attr(target_os = "none", no_std, no_main)]

foxhunt_emulated::program!(target::main);

#[cfg(target_os = "none")]
mod target {
    use core::hint::black_box;

    use cortex_m_semihosting::{heprintln, nr::GET_CMDLINE, syscall1};
    use foxhunt::{
        aoa::{BearingLikelihood, Clean},
        proposal::{Sensor, Transition},
        random::{SeedableRng, Xoshiro128PlusPlus},
    };
    use foxhunt_emulated::stopwatch::Stopwatch;
    use foxhunt_problems::{bearings::Track, gamma, growth};
    use foxhunt_studies::methods::{bearings, scalar};

    /// Runs of every method, each with a seed of its own.
    const RUNS: u64 = 8;
    /// More than any track has.
    const BEARINGS: usize = 64;
    /// Of a run, in both papers on models of one dimension.
    const STEPS: usize = 50;

    /// Runs the study that the emulator's command line names.
    pub fn main() {
        let mut buffer = [0; 512];
        run(argument(&mut buffer));
    }

    /// The last word of the emulator's command line.
    fn argument(buffer: &mut [u8; 512]) -> &str {
        let mut block = [buffer.as_mut_ptr() as usize, buffer.len()];
        // SAFETY: the emulator writes as many bytes as the buffer has at most, and their number into the block.
        let failed = unsafe { syscall1(GET_CMDLINE, block.as_mut_ptr() as usize) };
        assert_eq!(failed, 0, "the command line is too long");
        let line = core::str::from_utf8(&buffer[..block[1]]).expect("the command line is text");
        line.rsplit(' ').next().unwrap_or_default()
    }

    /// Runs a study: `fish:a1`, `growth`, `gamma:0.04:1e-5` with its omega and variance, and so on.
    fn run(study: &str) {
        let stopwatch = &Stopwatch::start();
        let mut words = study.split(':');
        let mut word = || words.next().unwrap_or_default();
        match (word(), word()) {
            ("aoa", "a1") => bearings::aoa(&mut on(Track::A1, stopwatch)),
            ("aoa", "a2") => bearings::aoa(&mut on(Track::A2, stopwatch)),
            ("fish", "a1") => bearings::fish::<100>(&mut on(Track::A1, stopwatch)),
            ("fish", "a2") => bearings::fish::<100>(&mut on(Track::A2, stopwatch)),
            ("fish", "a5") => bearings::fish::<100>(&mut on(Track::A5, stopwatch)),
            ("fish", "b2") => bearings::fish::<80>(&mut on(Track::B2, stopwatch)),
            ("fireflies", "b2") => bearings::fireflies::<80>(&mut on(Track::B2, stopwatch)),
            ("ladder", "a2") => bearings::ladder(&mut on(Track::A2, stopwatch)),
            ("growth", "") => scalar::growth(&mut in_growth(stopwatch)),
            ("ladder", "growth") => scalar::ladder(&mut in_growth(stopwatch)),
            ("gamma", omega) => scalar::gamma(&mut in_gamma(omega, word(), stopwatch)),
            ("ladder", "gamma") => scalar::ladder(&mut in_gamma(word(), word(), stopwatch)),
            _ => panic!("no study {study}"),
        }
    }

    fn on(track: Track, stopwatch: &Stopwatch) -> OnTrack<'_> {
        OnTrack { track, stopwatch }
    }

    fn in_growth(stopwatch: &Stopwatch) -> impl scalar::Visit {
        let steps = |run| {
            let mut nature = Xoshiro128PlusPlus::seed_from_u64(run);
            let mut steps = growth::simulate(&mut nature);
            core::array::from_fn(|_| {
                let (dynamics, _, measurement) = steps.next().expect("it is endless");
                (dynamics, measurement)
            })
        };
        InOneDimension {
            start: growth::START,
            steps,
            stopwatch,
        }
    }

    fn in_gamma(omega: &str, variance: &str, stopwatch: &Stopwatch) -> impl scalar::Visit {
        let [omega, variance] = [omega, variance].map(|x| x.parse().expect("a number"));
        let steps = move |run| {
            let mut nature = Xoshiro128PlusPlus::seed_from_u64(run);
            let mut steps = gamma::simulate(omega, variance, &mut nature);
            core::array::from_fn(|_| {
                let (dynamics, _, measurement) = steps.next().expect("it is endless");
                (dynamics, measurement)
            })
        };
        InOneDimension {
            start: gamma::START,
            steps,
            stopwatch,
        }
    }

    /// Prints what `work` took.
    fn measure<T>(stopwatch: &Stopwatch, name: &str, work: impl FnOnce() -> T) {
        let (result, instructions) = stopwatch.instructions(work);
        black_box(result);
        heprintln!("figure\t{}\t{}\tinstructions", name, instructions);
    }

    struct OnTrack<'a> {
        track: Track,
        stopwatch: &'a Stopwatch,
    }

    impl bearings::Visit for OnTrack<'_> {
        #[inline(never)]
        fn method(&mut self, label: &'static str, _: &'static str, method: impl bearings::Method) {
            for run in 0..RUNS {
                let mut nature = Xoshiro128PlusPlus::seed_from_u64(run);
                let mut simulated = self.track.simulate(&mut nature);
                let first = simulated.next().expect("a track has bearings");
                let mut observations = [first; BEARINGS];
                let mut count = 1;
                for (slot, observation) in observations[1..].iter_mut().zip(simulated) {
                    *slot = observation;
                    count += 1;
                }
                let observations = black_box(&observations[..count]);
                let mut rng = Xoshiro128PlusPlus::seed_from_u64(!run);
                measure(self.stopwatch, label, || {
                    let mut likelihoods = [BearingLikelihood::new(&first); BEARINGS];
                    for (likelihood, observation) in likelihoods.iter_mut().zip(observations) {
                        *likelihood = BearingLikelihood::new(observation);
                    }
                    let bearings = bearings::Bearings {
                        observations,
                        likelihoods: &likelihoods[..count],
                        process: self.track.process_variance(),
                    };
                    let estimate = method.locate(bearings, &mut rng, &mut Unwatched);
                    estimate.map(|estimate| (estimate.position, estimate.covariance))
                });
            }
        }
    }

    /// Whoever needs estimates takes them: they must be computed.
    struct Unwatched;

    impl bearings::Watch for Unwatched {
        fn estimate(&mut self, position: Option<[f32; 2]>) {
            black_box(position);
        }

        fn pushed<const N: usize>(&mut self, _: &Clean<N>, _: u8) {}
    }

    struct InOneDimension<'a, S> {
        start: f32,
        /// Of a run.
        steps: S,
        stopwatch: &'a Stopwatch,
    }

    impl<S: Fn(u64) -> [(T, M); STEPS], T: Transition<1>, M: Sensor<1, 1>> scalar::Visit
        for InOneDimension<'_, S>
    {
        #[inline(never)]
        fn method(&mut self, label: &'static str, _: &'static str, method: impl scalar::Method) {
            for run in 0..RUNS {
                let steps = black_box((self.steps)(run));
                let mut rng = Xoshiro128PlusPlus::seed_from_u64(!run);
                measure(self.stopwatch, label, || {
                    method.track(self.start, steps.into_iter(), &mut rng, |mean, _, _| {
                        black_box(mean);
                    });
                });
            }
        }
    }
}
