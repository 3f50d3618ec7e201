//! What the gateways of the firmwares take for a bearing: the recorded drive goes through each, byte by byte.
//!
//! `cargo xtask cost` runs it in the emulator, with a clock that counts instructions.

#![cfg_attr(target_os = "none", no_std, no_main)]

foxhunt_emulated::program!(target::run);

#[cfg(target_os = "none")]
mod target {
    use core::{
        fmt::{Debug, Write},
        hint::black_box,
    };

    use cortex_m_semihosting::hprintln;
    use foxhunt::{
        aoa::{
            Answer, Bearing, Clean, Locate, Locator, MultiTarget, Observation, Robust, clean,
            multi, robust,
        },
        gateway::{
            Config, Event, FullReport, ReportForm, ShortReport, Vehicle,
            formats::{All, Formats},
        },
        random::{SeedableRng, Xoshiro128PlusPlus, normal, uniform},
        refine::{DifferentialEvolution, Firefly, FishSchool, Lengths, Refinement},
        snapshot::Persist,
    };
    use foxhunt_emulated::stopwatch::Stopwatch;
    use foxhunt_gateways::{PORTS, evolution, firefly, fish, kept, plain, robust as city};
    use foxhunt_problems::bearings::Track;
    use heapless::String;

    const DRIVE: &[u8] = include_bytes!("data/drive.nmea");

    /// Runs all gateways and locators.
    pub fn run() {
        let stopwatch = Stopwatch::start();
        let one = &stopwatch;
        Updates::of_drive(plain::Gateway::EMPTY, &plain::CONFIG, one).print("vehicle");
        Updates::of_drive(fish::Gateway::EMPTY, &fish::CONFIG, one).print("vehicle.fish");
        Updates::of_drive(firefly::Gateway::EMPTY, &firefly::CONFIG, one).print("vehicle.firefly");
        Updates::of_drive(evolution::Gateway::EMPTY, &evolution::CONFIG, one)
            .print("vehicle.evolution");
        Updates::of_drive(city::Gateway::EMPTY, &city::CONFIG, one).print("vehicle.robust");
        greedy(school(), one).print("vehicle.fish.greedy");
        greedy(swarm(), one).print("vehicle.firefly.greedy");
        greedy(evolved(), one).print("vehicle.evolution.greedy");
        robust_updates(&stopwatch).print("robust");
        let three = multi::Config::new(robust::Config::DEFAULT);
        sources_updates::<Three>(three, one).print("sources");
        sources_updates::<city::Locator>(city::CONFIG.locator, one).print("vehicle.robust.sources");
        let bytes = core::mem::size_of::<Three>();
        hprintln!("figure\tsources.bytes\t{}\tbytes", bytes);
        snapshots("locator", plain::Gateway::EMPTY, &plain::CONFIG, one);
        let robust = Config::new(robust::Config::DEFAULT);
        snapshots::<Robust<256, 64>, All, FullReport>("robust", Vehicle::EMPTY, &robust, one);
        snapshots("kept", kept::Gateway::EMPTY, &kept::CONFIG, one);
        let worst = worst_byte(&stopwatch);
        hprintln!(
            "figure\tvehicle.byte.worst.instructions\t{}\tinstructions",
            worst
        );
    }

    /// A gateway whose particles move as published, after every bearing.
    fn greedy<M: Refinement<2> + Copy + PartialEq + Debug>(
        refinement: M,
        stopwatch: &Stopwatch,
    ) -> Updates {
        let config = black_box(Config::new(clean::Config {
            resample_below: 1.0,
            ..clean::Config::with_refinement(refinement)
        }));
        let gateway: Vehicle<Clean<200, 64, M>, All, ShortReport, PORTS> = Vehicle::EMPTY;
        Updates::of_drive(gateway, &config, stopwatch)
    }

    /// Steps of ten metres, five tries.
    fn school() -> FishSchool {
        FishSchool {
            perception: 20.0,
            step: 10.0,
            tries: 5,
            ..FishSchool::PUBLISHED
        }
    }

    fn swarm() -> Firefly {
        Firefly {
            lengths: Lengths::Absolute,
            absorption: 0.01,
            flutter: 10.0,
            ..Firefly::DEFAULT
        }
    }

    fn evolved() -> DifferentialEvolution {
        DifferentialEvolution {
            generations: 4,
            ..DifferentialEvolution::DEFAULT
        }
    }

    /// Instructions of the bytes that end the lines of bearings.
    #[derive(Default)]
    struct Updates {
        count: u64,
        sum: u64,
        worst: u64,
    }

    impl Updates {
        fn of_drive<L: Locate, F: Formats, R: ReportForm>(
            gateway: Vehicle<L, F, R, PORTS>,
            config: &Config<L::Config>,
            stopwatch: &Stopwatch,
        ) -> Self {
            let mut gateway = black_box(gateway);
            let mut updates = Self::default();
            for byte in DRIVE {
                let (event, instructions) =
                    stopwatch.instructions(|| gateway.push(0, *byte, config));
                if let Some(Event::Fix(_) | Event::NotObservable(_)) = event {
                    updates.count += 1;
                    updates.sum += instructions;
                    updates.worst = updates.worst.max(instructions);
                }
            }
            assert!(matches!(gateway.locator().answer(), Answer::Fix(_)));
            updates
        }

        fn print(&self, name: &str) {
            let Self { count, sum, worst } = self;
            hprintln!(
                "figure\t{}.update.mean.instructions\t{}\tinstructions",
                name,
                sum / count
            );
            hprintln!(
                "figure\t{}.update.worst.instructions\t{}\tinstructions",
                name,
                worst
            );
        }
    }

    /// What a robust locator takes for bearings of which three tenths are outliers: along a track, and on a drive towards
    /// the source, whose first fix comes when the memory of bearings is full, of a vehicle that then turns aside.
    fn robust_updates(stopwatch: &Stopwatch) -> Updates {
        let mut updates = Updates::default();
        let mut rng = Xoshiro128PlusPlus::seed_from_u64(1);
        let [x, y] = Track::A2.source();
        let straight = move |i: u32| {
            let along = if i < 70 { i as f32 } else { 70.0 };
            let aside = i as f32 - along;
            [x - 4000.0 + 30.0 * along, y + 60.0 * aside]
        };
        let drives = [
            (0..60).map(|i| Track::A2.receiver(i)).collect(),
            (0..90).map(straight).collect(),
        ];
        for places in drives as [heapless::Vec<[f32; 2], 90>; 2] {
            let mut locator: Locator<Robust<256, 64>> =
                Locator::new(black_box(robust::Config::DEFAULT)).expect("the default is right");
            for (i, [px, py]) in (0..).zip(places) {
                let (error, kind) = (0.0195 * normal(&mut rng), uniform(&mut rng));
                let outlier = if kind < 0.3 { 20.0 * kind } else { 0.0 };
                let bearing = foxhunt::math::atan2(y - py, x - px) + error + outlier;
                let bearing = Bearing::from_radians(bearing);
                let observation =
                    Observation::new(1_000 * i, [px, py], bearing, 0.0195).expect("in range");
                let (_, instructions) =
                    stopwatch.instructions(|| locator.push(&observation, &mut rng));
                updates.count += 1;
                updates.sum += instructions;
                updates.worst = updates.worst.max(instructions);
            }
            assert!(matches!(locator.answer(), Answer::Fix(_)));
        }
        updates
    }

    type Three = MultiTarget<3, Robust<256, 64>>;

    /// Where a bearing is taken, or where its source is.
    type Where = fn(u32) -> [f32; 2];

    /// What several sources take: three tenths of the bearings outliers, three sources that are heard from the start, along a
    /// track, and three of which the third comes when the memory of outliers is full; one straight ahead, which
    /// becomes observable only then, when the vehicle turns aside, with as many outliers and with none; and one of
    /// two that drives off for a while, round which the vehicle drives.
    fn sources_updates<L: Locate>(config: L::Config, stopwatch: &Stopwatch) -> Updates {
        const PLACES: [[f32; 2]; 3] = [[1200.0, 800.0], [2300.0, 300.0], [600.0, -700.0]];
        let mut updates = Updates::default();
        let mut rng = Xoshiro128PlusPlus::seed_from_u64(1);
        let along: Where =
            |i| Track::A2.receiver(if i / 60 % 2 == 0 { i % 60 } else { 59 - i % 60 });
        let ahead: Where = |i| {
            let along = if i < 70 { i as f32 } else { 70.0 };
            [-2000.0 + 30.0 * along, 60.0 * (i as f32 - along)]
        };
        let round: Where = |i| {
            let (sin, cos) = foxhunt::math::sin_cos(0.025 * i as f32);
            [1200.0 + 500.0 * cos, 800.0 + 500.0 * sin]
        };
        let together: Where = |i| PLACES[i as usize % 3];
        let later: Where = |i| PLACES[i as usize % if i < 240 { 2 } else { 3 }];
        let there: Where = |_| [2000.0, 0.0];
        let driving: Where = |i| {
            let way = 10.0 * i.clamp(120, 210) as f32 - 1200.0;
            if i.is_multiple_of(4) {
                PLACES[1]
            } else {
                [PLACES[0][0], PLACES[0][1] - way]
            }
        };
        let drives: [(u32, Where, Where, f32); 5] = [
            (120, along, together, 0.3),
            (360, along, later, 0.3),
            (130, ahead, there, 0.3),
            (130, ahead, there, 0.0),
            (360, round, driving, 0.3),
        ];
        for (count, place, truth, outlier_rate) in drives {
            let mut sources: Locator<L> = Locator::new(config).expect("it is right");
            for i in 0..count {
                let ([px, py], [x, y]) = (place(i), truth(i));
                let (error, kind) = (0.0195 * normal(&mut rng), uniform(&mut rng));
                let outlier = if kind < outlier_rate {
                    20.0 * kind
                } else {
                    0.0
                };
                let bearing = foxhunt::math::atan2(y - py, x - px) + error + outlier;
                let bearing = Bearing::from_radians(bearing);
                let observation =
                    Observation::new(1_000 * i, [px, py], bearing, 0.0195).expect("in range");
                let (_, instructions) =
                    stopwatch.instructions(|| sources.push(&observation, &mut rng));
                updates.count += 1;
                updates.sum += instructions;
                updates.worst = updates.worst.max(instructions);
            }
            assert!(sources.source(0).is_some());
        }
        updates
    }

    /// What a gateway that knows the recorded drive takes to be saved and restored.
    fn snapshots<L: Locate + Persist, F: Formats, R: ReportForm>(
        name: &str,
        gateway: Vehicle<L, F, R, PORTS>,
        config: &Config<L::Config>,
        stopwatch: &Stopwatch,
    ) {
        let mut gateway = black_box(gateway);
        for byte in DRIVE {
            gateway.push(0, *byte, config);
        }
        let mut buffer = black_box([0; 30_000]);
        let (bytes, save) = stopwatch.instructions(|| gateway.snapshot(&mut buffer));
        let bytes = black_box(bytes.expect("the buffer is large enough"));
        let (result, restore) = stopwatch.instructions(|| gateway.restore(bytes));
        result.expect("it has just been saved");
        hprintln!("figure\tsnapshot.{}.bytes\t{}\tbytes", name, bytes.len());
        for (what, instructions) in [("save", save), ("restore", restore)] {
            hprintln!(
                "figure\tsnapshot.{}.{}.instructions\t{}\tinstructions",
                name,
                what,
                instructions
            );
        }
    }

    /// The byte that takes longest, of a drive whose first fix comes when the memory of bearings is full: for a minute the vehicle is
    /// stationary, and four minutes later it is 400 m further north.
    fn worst_byte(stopwatch: &Stopwatch) -> u64 {
        let mut gateway = black_box(plain::Gateway::EMPTY);
        let mut worst = 0;
        let mut push = |text: &str| {
            for byte in text.bytes() {
                let (_, instructions) =
                    stopwatch.instructions(|| gateway.push(0, byte, &plain::CONFIG));
                worst = worst.max(instructions);
            }
        };
        for minute in 0..2 {
            for second in 0..60 {
                let mut line = String::<100>::new();
                let north = 7.0 + 0.216 * minute as f32;
                let written = write!(
                    line,
                    "GPRMC,12{:02}{second:02},A,48{north:07.4},N,01131.0000,E,20.0,000.0,221126,,,A",
                    5 * minute
                );
                written.expect("there is room");
                let checksum = line.bytes().fold(0, |sum, byte| sum ^ byte);
                let mut sentence = String::<110>::new();
                write!(sentence, "${line}*{checksum:02X}\r\n").expect("there is room");
                push(&sentence);
                let bearing = if minute == 0 { 45 } else { 90 };
                let mut line = String::<20>::new();
                write!(line, "%{bearing:03}/9\r%{bearing:03}/9\r").expect("there is room");
                push(&line);
            }
        }
        assert!(matches!(gateway.locator().answer(), Answer::Fix(_)));
        worst
    }
}
