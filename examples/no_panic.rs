//! The proof that the library cannot panic: this firmware calls all of it with arguments that the compiler
//! cannot see, and its panic handler calls a function that does not exist. It links only if no path to the
//! handler is left.

#![cfg_attr(target_os = "none", no_std, no_main)]

#[cfg(not(target_os = "none"))]
fn main() {}

#[cfg(target_os = "none")]
mod proof {
    use core::{hint::black_box, panic::PanicInfo};

    use foxhunt::{
        aoa::{
            Bearing, BearingLikelihood, Locate, Observation,
            correction::{Correction, Pull},
            gauss_newton::{self, Errors},
            geodesy::{Geodetic, LocalPlane},
            locator::{self, Answer, Locator},
            pursuit::{self, Pursuit},
            robust::{self, RobustLocator, Tails},
            sources::{self, Sources},
            spectrum::{Spectrum, SpectrumLikelihood, Temper},
            triangulation,
        },
        estimate::{self, Ellipse},
        filter::ParticleFilter,
        fingerprint::{
            GaussianMatcher, KernelDensity, Lattice, Matcher, Missing, Neighbours, Packet,
            PacketModel, Posterior, RadioMap, Reading, Samples, TableMatcher, tracker,
        },
        gateway::{
            self, BearingReference, DeviationTable, Finder, KrakenConfidence, SHORT_REPORT, Sense,
            SpectrumReader, UbloxQuality, Vehicle,
        },
        kalman::{Covariance, Gaussian, Unscented},
        math,
        model::{ConstantVelocity, Dynamics, Likelihood, RandomWalk, Static},
        particles::{self, Particles},
        problems::{bearings::Track, gamma, growth},
        proposal::{AuxiliaryFilter, PointMassFilter, Transition, UnscentedParticleFilter},
        random::{self, SeedableRng, Xoshiro128PlusPlus},
        refine::{
            Acceptance, DifferentialEvolution, Firefly, FishSchool, Lengths, Memory, Refinement,
            fish,
        },
        resample::{Scheme, resample},
        snapshot::{self, Keeper, Persist},
        weights,
    };

    unsafe extern "C" {
        // SAFETY: never linked, never called.
        safe fn a_panic_is_possible() -> !;
    }

    #[panic_handler]
    fn panic(_: &PanicInfo) -> ! {
        a_panic_is_possible()
    }

    /// Any value at all, as far as the compiler knows.
    fn any<T>(value: T) -> T {
        black_box(value)
    }

    /// A slice of any length.
    fn some<T>(slice: &[T]) -> &[T] {
        slice.get(..any(slice.len())).unwrap_or_default()
    }

    /// A slice of any length.
    fn some_mut<T>(slice: &mut [T]) -> &mut [T] {
        let length = any(slice.len());
        slice.get_mut(..length).unwrap_or_default()
    }

    #[cortex_m_rt::entry]
    fn main() -> ! {
        let mut rng = Xoshiro128PlusPlus::seed_from_u64(any(1));
        math();
        random(&mut rng);
        cloud(&mut rng);
        filter(&mut rng);
        refine::<1>(&mut rng);
        refine::<2>(&mut rng);
        refine::<4>(&mut rng);
        kalman(&mut rng);
        propose(&mut rng);
        bearings(&mut rng);
        locate(&mut rng);
        locate_robustly(&mut rng);
        locate_several(&mut rng);
        snapshots(&mut rng);
        pursue(&mut rng);
        fingerprints();
        track(&mut rng);
        gateway();
        beacons();
        loop {
            cortex_m::asm::wfi();
        }
    }

    fn math() {
        black_box(math::exp(any(0.0)));
        black_box(math::ln(any(0.0)));
        black_box(math::sqrt(any(0.0)));
        black_box(math::wrap(any(0.0)));
        black_box(math::sin_cos(any(0.0)));
        black_box(math::atan2(any(0.0), any(0.0)));
    }

    fn random(rng: &mut Xoshiro128PlusPlus) {
        black_box(random::uniform(rng));
        black_box(random::uniform_open(rng));
        black_box(random::normal(rng));
        black_box(random::gamma(rng, any(0.0)));
    }

    fn cloud(rng: &mut Xoshiro128PlusPlus) {
        let mut cloud = any(Particles::<3, 50>::new());
        cloud.initialise(rng, |_| any([0.0; 3]));
        cloud.set(any(0), any([0.0; 3]));
        black_box(cloud.get(any(0)));
        cloud.log_weights_mut().fill(any(0.0));
        cloud.resample(any(Scheme::Systematic), &mut any([0.0; 50]), rng);
        black_box(cloud.log_weights());

        let (mut a, mut b, mut c) = (any([0.0; 20]), any([0.0; 20]), any([0.0; 20]));
        let mut columns = [some_mut(&mut a), some_mut(&mut b)];
        particles::write(&mut columns, any(0), any([0.0; 2]));
        Static.predict(&mut columns, any(0.0), rng);
        let walk = any(RandomWalk {
            deviation: [0.0; 2],
        });
        walk.predict(&mut columns, any(0.0), rng);
        black_box(walk.step(any([0.0; 2]), any(0.0), rng));
        let [a, b] = columns;
        let columns = [&*a, &*b];
        black_box(particles::read(&columns, any(0)));
        black_box(estimate::mean(&columns, some(&c)));
        black_box(estimate::covariance(&columns, some(&c)));
        black_box(estimate::quantile(some(a), some(b), any(0.0)));
        black_box(weights::effective_sample_size(some(a)));
        black_box(weights::normalise(some_mut(a), some_mut(b)));
        black_box(weights::reweigh(some_mut(a), some_mut(b)));
        let ancestors = resample(any(Scheme::Systematic), some(a), some_mut(&mut c), rng);
        ancestors.gather(some_mut(a), some_mut(b));
        black_box(ancestors.iter().sum::<usize>());
        let ellipse = Ellipse::of_normal(any([0.0; 2]), any([[0.0; 2]; 2]), any(0.0));
        black_box(ellipse.contains(any([0.0; 2])));
    }

    fn filter(rng: &mut Xoshiro128PlusPlus) {
        let mut filter = any(ParticleFilter::<4, 50>::new());
        filter.initialise(rng, |_| any([0.0; 4]));
        filter.predict(
            &any(ConstantVelocity {
                acceleration: [0.0; 2],
            }),
            any(0.0),
            rng,
        );
        _ = black_box(filter.update(&|state: &[f32; 4]| any(state[0])));
        if let Some(observation) = observation() {
            _ = black_box(filter.update(&BearingLikelihood::new(&observation)));
        }
        black_box(filter.resample_below(any(0.0), rng));
        filter.resample(any(Scheme::Systematic), rng);
        black_box((
            filter.mean(),
            filter.covariance(),
            filter.effective_sample_size(),
        ));
        black_box((filter.columns_mut(), any(0.0)));
        black_box((filter.particles(), filter.weights()));
    }

    fn refine<const D: usize>(rng: &mut Xoshiro128PlusPlus) {
        let mut memory = Memory::<D, 50>::new();
        let mut states = any([[0.0; 60]; D]);
        let mut columns = states.each_mut().map(|column| some_mut(column));
        let target = |state: &[f32; D]| any(state[0]);
        let acceptance = any(Acceptance::Greedy);
        let lengths = any(Lengths::Absolute);
        let school = FishSchool::new(lengths, any(1.0), any(1.0))
            .and_then(|school| school.tries(any(3)))
            .and_then(|school| school.iterations(any(4)))
            .and_then(|school| school.crowding(any(0.5)))
            .and_then(|school| school.threshold(any(0.1)));
        if let Ok(school) = school {
            let school = school
                .behaviour(any(fish::Behaviour::Prey))
                .heading(any(fish::Heading::Random))
                .acceptance(acceptance);
            black_box(school.evaluations(any(3)));
            black_box(school.refine(&mut columns, &target, &mut memory.workspace(), rng));
        }
        for firefly in [
            Firefly::standard(lengths, any(1.0), any(1.0)),
            Firefly::improved(lengths, any(1.0), any(1.0)),
        ] {
            let firefly = firefly
                .and_then(|firefly| firefly.iterations(any(2)))
                .and_then(|firefly| firefly.decay(any(2.0)));
            if let Ok(firefly) = firefly {
                let firefly = firefly.acceptance(acceptance);
                black_box(firefly.refine(&mut columns, &target, &mut memory.workspace(), rng));
            }
        }
        let evolution = DifferentialEvolution::new()
            .acceptance(acceptance)
            .generations(any(3))
            .and_then(|evolution| evolution.crossover(any(0.3)));
        if let Ok(evolution) = evolution {
            black_box(evolution.refine(&mut columns, &target, &mut memory.workspace(), rng));
        }
    }

    fn kalman(rng: &mut Xoshiro128PlusPlus) {
        let Ok(mut covariance) = Covariance::<3>::new(&any([[0.0; 3]; 3])) else {
            return;
        };
        covariance.add(any([0.0; 3]));
        black_box((covariance.matrix(), covariance.deviations()));
        let mut state = any(Gaussian {
            mean: [0.0; 3],
            covariance: covariance.plus(&any(Covariance::diagonal([0.0; 3]))),
        });
        black_box((state.draw(rng), state.log_density(any([0.0; 3]))));
        let noise = any(Covariance::<2>::diagonal([0.0; 2]));
        _ = black_box(state.predict(&any([[0.0; 3]; 3]), &covariance));
        _ = black_box(state.update(&any([[0.0; 3]; 2]), any([0.0; 2]), &noise));
        if let Ok(unscented) = Unscented::new(any(0.0), any(0.0), any(0.0)) {
            _ = black_box(unscented.predict(&mut state, |x| any(*x), &covariance));
            _ = black_box(unscented.update(&mut state, |[x, y, _]| any([*x, *y]), &noise));
        }
    }

    fn propose(rng: &mut Xoshiro128PlusPlus) {
        let covariance = any(Covariance::diagonal([0.0]));
        let mut unscented = any(UnscentedParticleFilter::<1, 10>::new());
        unscented.initialise(rng, &covariance, |_| any([0.0]));
        let mut auxiliary = any(AuxiliaryFilter::<1, 10>::new());
        auxiliary.initialise(rng, |_| any([0.0]));
        let mut points = any(PointMassFilter::<1, 10>::at([0.0]));
        let mut memory = any([0.0; 32]);
        let seed = any(1);
        for (dynamics, _, measurement) in gamma::simulate(
            any(0.0),
            any(0.0),
            &mut Xoshiro128PlusPlus::seed_from_u64(seed),
        )
        .take(any(50))
        {
            let parameters = &Unscented::DEFAULT;
            _ = black_box(unscented.step(parameters, &dynamics, &measurement, any(0.0), rng));
            black_box((unscented.mean(), unscented.covariance()));
            unscented.resample(any(Scheme::Systematic), rng);
            _ = black_box(auxiliary.step(&dynamics, &measurement, any(0.0), &mut memory, rng));
            black_box((auxiliary.mean(), auxiliary.covariance()));
            _ = black_box(points.step(&dynamics, &measurement, any(0.0), &mut memory));
            black_box((points.mean(), points.covariance()));
        }
        for (dynamics, truth, measurement) in growth::simulate(rng).take(any(50)) {
            black_box((dynamics.mean(&[truth], any(0.0)), measurement));
        }

        let walk = any(RandomWalk {
            deviation: [0.0; 2],
        });
        let mut memory = any([0.0; 300]);
        let mut auxiliary = any(AuxiliaryFilter::<2, 10>::new());
        let likelihood = |state: &[f32; 2]| any(state[0]);
        _ = black_box(auxiliary.step(&walk, &likelihood, any(0.0), &mut memory, rng));
        let (low, high) = any(([0.0; 2], [0.0; 2]));
        let prior = |state: &[f32; 2]| any(state[1]);
        if let Ok(mut points) = PointMassFilter::<2, 10>::from_prior(low, high, prior, &mut memory)
        {
            _ = black_box(points.step(&walk, &likelihood, any(0.0), &mut memory));
        }
        for observation in any(Track::A2).simulate(rng) {
            black_box(observation);
        }
    }

    fn observation() -> Option<Observation> {
        let bearing = match any(0) {
            0 => Bearing::from_radians(any(0.0)),
            1 => Bearing::from_compass_degrees(any(0.0)),
            _ => Bearing::from_relative_degrees(any(0.0), any(0.0)),
        };
        black_box(bearing.compass_degrees());
        Observation::new(any([0.0; 2]), bearing, any(0.0)).ok()
    }

    fn bearings(rng: &mut Xoshiro128PlusPlus) {
        let mut correction = Correction::new(any(Pull::Continuous));
        correction.add(Bearing::from_radians(any(0.0)), any(0.0));
        black_box((correction.bearing(), correction.readings()));

        let Some(observation) = observation() else {
            return;
        };
        let observations = any([observation; 8]);
        let observations = some(&observations);
        black_box(triangulation::intersection(
            &observation,
            &any(observation),
            any(0.0),
        ));
        black_box(triangulation::random_intersection(
            observations,
            any(0.0),
            rng,
        ));
        let errors = any(Errors::Gaussian);
        _ = black_box(gauss_newton::solve(observations, errors, any([0.0; 2])));
        let (mut a, mut out) = (any([0.0; 20]), any([0.0; 20]));
        let likelihood = BearingLikelihood::new(&observation);
        likelihood.log_likelihoods(
            &[some(&any([0.0; 20])), some_mut(&mut a)],
            some_mut(&mut out),
        );
        black_box(out);

        if let Ok(origin) = Geodetic::new(any(0), any(0))
            && let Ok(plane) = LocalPlane::new(origin)
        {
            _ = black_box(plane.to_local(any(origin)));
            _ = black_box(plane.to_geodetic(any([0.0; 2])));
        }
    }

    fn locate(rng: &mut Xoshiro128PlusPlus) {
        let settings = locator::Settings::new()
            .relative_range_error(any(0.0))
            .and_then(|settings| settings.resample_share(any(0.0)))
            .and_then(|settings| settings.moves(any(0)));
        let mut locator = any(Locator::<50, 16>::new(settings.unwrap_or_default()));
        if let Some(observation) = observation()
            && let Answer::Fix(fix) = locator.push(observation, rng)
        {
            black_box(fix.ellipse(any(0.0)));
        }
        black_box((
            locator.answer(),
            locator.columns(),
            locator.weights(),
            locator.observations(),
        ));
        locator.reset();
    }

    fn pursue(rng: &mut Xoshiro128PlusPlus) {
        let settings = pursuit::Settings::new(any(robust::Settings::default()))
            .speed(any(0.0))
            .and_then(|settings| settings.parked_s(any(0.0)))
            .and_then(|settings| settings.driving_s(any(0.0)))
            .and_then(|settings| settings.straight_s(any(0.0)));
        let mut pursuit = any(Pursuit::<50, 16>::new(settings.unwrap_or_default()));
        for _ in 0..any(100) {
            let Some(observation) = observation() else {
                continue;
            };
            black_box(pursuit.push_after(observation, any(0.0), rng));
            black_box((pursuit.answer(), pursuit.motion()));
            black_box((pursuit.source(any(0)), pursuit.hypothesis(any(0))));
            black_box((pursuit.bias(), pursuit.shares(), pursuit.advice()));
            black_box(pursuit.classify(&observation));
        }
        pursuit.reset();
    }

    fn locate_robustly(rng: &mut Xoshiro128PlusPlus) {
        let errors = robust::Errors::new()
            .tails(any(Tails::Normal))
            .and_then(|errors| errors.shares(any(0.0), any(0.0)))
            .and_then(|errors| errors.prior_bearings(any(0.0)))
            .and_then(|errors| errors.bias_deviation(any(0.0)))
            .and_then(|errors| errors.position_deviation(any(0.0)))
            .and_then(|errors| errors.correlation(any(0.0), any(0.0), any(0.0)));
        let settings = robust::Settings::new(errors.unwrap_or_default())
            .common(any(locator::Settings::new()))
            .range_m(any(0.0));
        let mut locator = any(RobustLocator::<50, 16>::new(settings.unwrap_or_default()));
        for _ in 0..any(100) {
            let Some(observation) = observation() else {
                continue;
            };
            black_box(locator.push(observation, rng));
            black_box(locator.push_after(observation, any(0.0), rng));
            black_box((locator.answer(), locator.bias(), locator.shares()));
            black_box((locator.columns(), locator.weights()));
            locator.hypotheses().for_each(|hypothesis| {
                black_box(hypothesis);
            });
            black_box(locator.observations().len());
        }
        locator.reset();
    }

    fn locate_several(rng: &mut Xoshiro128PlusPlus) {
        let settings = sources::Settings::new()
            .false_birth(any(0.0))
            .and_then(|settings| settings.memory(any(0.0), any(0.0)))
            .and_then(|settings| settings.least_share(any(0.0)));
        let tracks =
            [const { RobustLocator::<50, 16>::new(robust::Settings::new(robust::Errors::new())) };
                3];
        let mut sources = any(Sources::<3, _, 16>::new(
            settings.unwrap_or_default(),
            tracks,
        ));
        for _ in 0..any(100) {
            let Some(observation) = observation() else {
                continue;
            };
            black_box(sources.push(observation, rng));
            black_box(sources.push_after(observation, any(0.0), rng));
            black_box((sources.answer(), sources.bias(), sources.shares()));
            black_box((sources.source(any(0)), sources.hypothesis(any(0))));
            black_box((sources.advice(), sources.classify(&observation)));
            black_box((sources.cloud(any(0)), sources.tracks().count()));
        }
        sources.reset();
    }

    fn snapshots(rng: &mut Xoshiro128PlusPlus) {
        fn both_ways<T: Persist>(state: &mut T) {
            let mut buffer = any([0; 2000]);
            _ = black_box(snapshot::save(state, some_mut(&mut buffer)));
            _ = black_box(snapshot::restore(state, some(&any(buffer))));
            let [mut one, mut other] = any([[0; 2000]; 2]);
            let mut keeper = Keeper::new([some_mut(&mut one), some_mut(&mut other)]);
            _ = black_box(keeper.restore(state));
            _ = black_box(keeper.save(state));
        }
        let settings = any(locator::Settings::new());
        let place = Geodetic::new(any(0), any(0));
        let Ok(mut place) = place else { return };
        let Ok(mut plane) = LocalPlane::new(place) else {
            return;
        };
        both_ways(&mut place);
        both_ways(&mut (&mut plane, rng));
        both_ways(&mut any(ParticleFilter::<4, 50>::new()));
        both_ways(&mut any(Locator::<50, 16>::new(settings)));
        let evolution = any(DifferentialEvolution::new());
        both_ways(&mut any(
            Locator::<50, 16, DifferentialEvolution>::with_refinement(settings, evolution),
        ));
        both_ways(&mut any(RobustLocator::<50, 16>::new(any(
            robust::Settings::default(),
        ))));
        both_ways(&mut any(Pursuit::<20, 8>::new(any(
            pursuit::Settings::default(),
        ))));
        both_ways(&mut any(Locator::<50, 16>::new(settings).answer()));
        let track = || any(RobustLocator::<20, 8>::new(robust::Settings::default()));
        both_ways(&mut any(Sources::<2, _, 16>::new(
            any(sources::Settings::new()),
            [track(), track()],
        )));
    }

    fn gateway() {
        let settings = gateway::Settings::new()
            .with_reference(any(BearingReference::Relative))
            .with_seed(any(0))
            .with_undated_bearings(any(0))
            .with_sense(any(Sense::Clockwise))
            .with_kraken_confidence(any(KrakenConfidence::Percent))
            .with_ublox_quality(any(UbloxQuality::Best))
            .with_deviation_table(any(Finder::Any), any(&DeviationTable::AGRELO))
            .with_deviations(any(0.0), any(0.0))
            .and_then(|settings| settings.with_minimum_quality(any(0.0)))
            .and_then(|settings| settings.with_kraken_frequency_hz(any(0)))
            .and_then(|settings| settings.with_maximum_age_ms(any(0)))
            .and_then(|settings| settings.with_minimum_speed_m_s(any(0.0)))
            .and_then(|settings| settings.with_report_interval_ms(any(0)));
        let Ok(settings) = settings else { return };
        let knots = any([(0.0, 0.0); 10]);
        if let Ok(table) = DeviationTable::new(some(&knots)) {
            black_box(table.deviation_rad(any(0.0)));
        }
        let mut vehicle = any(Vehicle::<Locator<50, 16>>::new(
            settings,
            any(Locator::new(locator::Settings::new())),
        ));
        for _ in 0..any(100) {
            black_box(vehicle.push(any(0)));
            black_box((
                vehicle.report(),
                vehicle.counters(),
                vehicle.plane(),
                vehicle.locator(),
            ));
            let mut buffer = any([0; 2000]);
            _ = black_box(vehicle.snapshot(some_mut(&mut buffer)));
            _ = black_box(vehicle.restore(some(&any(buffer))));
        }
        vehicle.restart();
        spectrum(settings);
    }

    fn spectrum(settings: gateway::Settings) {
        let Ok(temper) = Temper::new(any(0.0)) else {
            return;
        };
        let mut vehicle = any(Vehicle::<_, SHORT_REPORT, _>::with_spectrum(
            settings,
            RobustLocator::<50, 16>::new(robust::Settings::default()),
            SpectrumReader::new(temper),
        ));
        let mut spectrum = any(Spectrum::new());
        for _ in 0..any(100) {
            black_box(vehicle.push(any(0)));
            black_box((vehicle.line(), vehicle.spectrum().spectrum()));
            _ = black_box(spectrum.push(any(0.0)));
        }
        black_box(spectrum.peaks(temper));
        black_box(spectrum.log_likelihood(any(0.0), temper));
        let axis = Bearing::from_radians(any(0.0));
        let likelihood = SpectrumLikelihood::new(&spectrum, any([0.0; 2]), axis, temper);
        let mut out = any([0.0; 50]);
        let [x, y] = any([[0.0; 50]; 2]);
        likelihood.log_likelihoods(&[some(&x), some(&y)], some_mut(&mut out));
        black_box((likelihood.log_likelihood(&any([0.0; 2])), out));
        spectrum.clear();
    }

    fn site(bytes: &[u8]) -> Option<tracker::Site<'_>> {
        use tracker::{Channel, Motion, Offset, Piece, Settings, Walls};
        let settings = Settings::new()
            .with_motion(any(Motion::new()))
            .and_then(|settings| settings.with_channel(any(Channel::new())))
            .and_then(|settings| settings.with_offset(any(Offset::new())))
            .and_then(|settings| settings.with_window_ms(any(0)))
            .and_then(|settings| settings.with_recovery(any(0.5)))
            .and_then(|settings| settings.with_uncertain_m(any(5.0)));
        const PIECE: Piece = Piece {
            from: [0.0; 2],
            to: [1.0; 2],
            width: 1.0,
        };
        let site = tracker::Site::new(RadioMap::new(bytes).ok()?, settings.ok()?).ok()?;
        Some(site.with_walls(any(Walls::Corridor(&[PIECE, PIECE]))))
    }

    fn track(rng: &mut Xoshiro128PlusPlus) {
        use tracker::{Heard, Tag, Trackers, Workspace};
        let bytes = any([0; 200]);
        let Some(site) = site(some(&bytes)) else {
            return;
        };
        let mut workspace = any(Workspace::<50, 64>::new());
        let mut trackers = any(Trackers::<3, 50, 8>::new());
        let scan = any([Heard {
            beacon: 0,
            mean_dbm: 0.0,
            packets: 1,
        }; 8]);
        for _ in 0..any(100) {
            let (tracker, _) = trackers.of(Tag(any(0)), any(0));
            let (time, beacon, rssi) = any((0, 0, 0.0));
            _ = black_box(tracker.push(time, beacon, rssi, &site, &mut workspace, rng));
            _ = black_box(tracker.scan(time, some(&scan), &site, &mut workspace, rng));
            if let Some(fix) = tracker.flush(&site, &mut workspace, rng) {
                black_box((
                    fix.ellipse(any(0.0)),
                    fix.position_at(any(0)),
                    fix.deviation(),
                ));
            }
            black_box(tracker.particles().get(any(0)));
            tracker.reset();
        }
        black_box(trackers.get(Tag(any(0))).and_then(|tracker| tracker.fix()));
        trackers.clear();
    }

    fn beacons() {
        use gateway::beacon::{BeaconGateway, Framing, Settings};
        let bytes = any([0; 200]);
        let Some(site) = site(some(&bytes)) else {
            return;
        };
        let settings = Settings::new()
            .with_framing(any(Framing::Lines))
            .with_seed(any(0))
            .with_silence_ms(any(0));
        let Ok(settings) = settings else { return };
        let mut gateway = any(BeaconGateway::<3, 50, 64, 8>::new(site, settings));
        for _ in 0..any(100) {
            black_box(gateway.push(any(0)));
            black_box((gateway.report(), gateway.counters(), gateway.tags().count()));
        }
        gateway.restart();
    }

    fn fingerprints() {
        use foxhunt::fingerprint::Settings;
        let settings = Settings::new()
            .with_missing(any(Missing::Modelled))
            .with_inflation_db(any(4.0))
            .and_then(|settings| settings.with_outliers(any(0.001)))
            .and_then(|settings| settings.with_tempering(any(0.5)))
            .and_then(|settings| settings.with_range_dbm(any([-120.0, 0.0])));
        let Ok(settings) = settings else { return };
        let scan = any([Reading {
            beacon: 0,
            rssi_dbm: 0.0,
        }; 8]);
        let scan = some(&scan);
        let mut posterior = any(Posterior::<50>::new());

        let lattice = Lattice::new(any([0.0; 2]), any(1.0), any(3), any(4));
        let values = any([0; 200]);
        if let Ok(samples) =
            lattice.and_then(|lattice| Samples::new(lattice, any(2), some(&values)))
        {
            black_box(samples.of(any(0), any(0)));
            if let Ok(matcher) = KernelDensity::new(samples, any(4.0), &settings) {
                _ = black_box(matcher.locate(scan, &mut posterior));
            }
        }

        let bytes = any([0; 200]);
        let Ok(map) = RadioMap::new(some(&bytes)).and_then(|map| map.limited(any(9), any(9)))
        else {
            return;
        };
        black_box((map.beacon(any(0)), map.beacon_index(any(0))));
        black_box((map.moments(any(0), any(0)), map.is_surveyed(any(0))));
        black_box(map.log_density(any(0), any(0.0), any(0)));
        black_box(map.lattice().position(any(0)));
        if let Ok(matcher) = GaussianMatcher::new(map, &settings) {
            _ = black_box(matcher.locate(scan, &mut posterior));
        }
        if let Ok(matcher) = TableMatcher::new(map, &settings) {
            _ = black_box(matcher.locate(scan, &mut posterior));
        }
        if let Ok(matcher) = Neighbours::new(map, any(3), &settings) {
            _ = black_box(matcher.locate(scan, &mut posterior));
        }
        black_box((posterior.weights(), posterior.covariance(map.lattice())));
        let model = any(PacketModel::new(&settings));
        let packet = any(Packet {
            beacon: 0,
            rssi_dbm: 0,
        });
        if let Ok(likelihood) = map.packet_likelihood(packet, any(0.0), &model) {
            let (x, y, mut out) = (any([0.0; 20]), any([0.0; 20]), any([0.0; 20]));
            likelihood.log_likelihoods(&[some(&x), some(&y)], some_mut(&mut out));
            black_box(likelihood.log_likelihood(&any([0.0; 4])));
        }
    }
}
