//! What gateways take with few and with many particles: the recorded drive, and the recorded walks of a tunnel, go through each,
//! byte by byte.
//!
//! `cargo xtask cost` runs it in the emulator, with a clock that counts instructions.

#![cfg_attr(target_os = "none", no_std, no_main)]

foxhunt_emulated::program!(target::run);

#[cfg(target_os = "none")]
mod target {
    use core::hint::black_box;

    use cortex_m_semihosting::hprintln;
    use foxhunt::{
        aoa::{Clean, clean},
        fingerprint::tracker::Tracker,
        gateway::{
            Event, ShortReport, Vehicle,
            beacon::{self, BeaconGateway},
        },
    };
    use foxhunt_emulated::stopwatch::Stopwatch;
    use foxhunt_gateways::{plain, tunnel};

    const DRIVE: &[u8] = include_bytes!("data/drive.nmea");
    const WALKS: &[u8] = include_bytes!("data/tunnel.packets");
    /// As much of the walks as one tag, or so, takes minutes to send.
    const WALKS_BYTES: usize = 40_000;

    /// Runs all.
    pub fn run() {
        let stopwatch = Stopwatch::start();
        drive::<25>(&stopwatch);
        drive::<50>(&stopwatch);
        drive::<100>(&stopwatch);
        drive::<200>(&stopwatch);
        drive::<400>(&stopwatch);
        drive::<800>(&stopwatch);
        drive::<1600>(&stopwatch);
        walk::<50>(&stopwatch);
        walk::<100>(&stopwatch);
        walk::<200>(&stopwatch);
        walk::<300>(&stopwatch);
        walk::<600>(&stopwatch);
    }

    #[inline(never)]
    fn drive<const N: usize>(stopwatch: &Stopwatch) {
        let mut gateway: Vehicle<Clean<N, 64>, plain::Formats, ShortReport> =
            black_box(Vehicle::EMPTY);
        let config = black_box(foxhunt::gateway::Config::new(clean::Config::DEFAULT));
        let (mut count, mut sum, mut worst) = (0, 0, 0);
        for byte in DRIVE {
            let (event, instructions) = stopwatch.instructions(|| gateway.push(0, *byte, &config));
            if let Some(Event::Fix(_) | Event::NotObservable(_)) = event {
                count += 1;
                sum += instructions;
                worst = instructions.max(worst);
            }
        }
        let mean = sum / count;
        let bytes = size_of_val(&gateway);
        hprintln!("figure\tchoice.n{}.bytes\t{}\tbytes", N, bytes);
        hprintln!(
            "figure\tchoice.n{}.mean.instructions\t{}\tinstructions",
            N,
            mean
        );
        hprintln!(
            "figure\tchoice.n{}.worst.instructions\t{}\tinstructions",
            N,
            worst
        );
    }

    #[inline(never)]
    fn walk<const N: usize>(stopwatch: &Stopwatch) {
        let mut gateway: BeaconGateway<8, N, 81, 4, 1> = black_box(BeaconGateway::EMPTY);
        let (mut count, mut sum) = (0, 0);
        for byte in WALKS.iter().take(WALKS_BYTES) {
            let (event, instructions) =
                stopwatch.instructions(|| gateway.push(*byte, &tunnel::LINES));
            if let Some(beacon::Event::Fix { .. }) = event {
                count += 1;
                sum += instructions;
            }
        }
        let mean = sum / count;
        let bytes = size_of::<Tracker<N, 4, 1>>();
        hprintln!("figure\tchoice.tag.n{}.bytes\t{}\tbytes", N, bytes);
        hprintln!(
            "figure\tchoice.tag.n{}.mean.instructions\t{}\tinstructions",
            N,
            mean
        );
    }
}
