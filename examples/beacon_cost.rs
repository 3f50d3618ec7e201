//! What a second of a full gateway costs: 64 tags, each of which is heard twice by eight radios, in windows of a second, on a
//! map of 80 points; the packets come as sentences.
//!
//! Run by the tasks in the emulator like `cost`.

#![cfg_attr(target_os = "none", no_std, no_main)]

foxhunt_emulated::program!(target::run);

#[cfg(target_os = "none")]
mod target {
    use core::fmt::Write;
    use core::hint::black_box;

    use cortex_m_semihosting::hprintln;
    use foxhunt::{
        fingerprint::{
            RadioMap,
            tracker::{self, Site},
        },
        gateway::beacon::{BeaconGateway, Config, Event},
        random::{SeedableRng, Xoshiro128PlusPlus, uniform},
    };
    use foxhunt_emulated::{map, region::region};

    const TAGS: usize = 64;
    const RADIOS: usize = 8;
    const POINTS: usize = 80;
    const MAP_BYTES: usize = map::bytes(RADIOS, POINTS);
    /// Half a second of sentences.
    const LINES_BYTES: usize = TAGS * RADIOS * 40;

    type Gateway = BeaconGateway<TAGS, 300, POINTS, RADIOS, 1>;
    type Lines = heapless::String<LINES_BYTES>;

    /// In halves of a dB above -128 dBm.
    fn level(radio: usize, x: f32) -> f32 {
        let distance = (x - 11.0 * radio as f32).abs();
        172.0 - 70.0 * (1.0 + 0.15 * distance).log10_short()
    }

    trait Short {
        fn log10_short(self) -> f32;
    }

    impl Short for f32 {
        /// Good to a tenth, which is enough here.
        fn log10_short(self) -> f32 {
            0.301 * (self.to_bits() as f32 / 8_388_608.0 - 126.94)
        }
    }

    fn write_map(bytes: &mut [u8; MAP_BYTES]) {
        // An error of 4 m length.
        map::write(
            bytes,
            [RADIOS as u8, POINTS as u8, 1],
            4.0,
            |radio, point| {
                let mean = level(radio, point as f32);
                [12 + ((radio * POINTS + point) % 7) as u8, mean as u8]
            },
        );
    }

    /// What the radios hear in a half second: every tag once, at its own time, at a walk along the tunnel.
    fn write_lines(half: u32, rng: &mut Xoshiro128PlusPlus, lines: &mut Lines) {
        lines.clear();
        for tag in 0..TAGS {
            let time_ms = 500 * half + 500 * tag as u32 / TAGS as u32;
            let x = 2.0 + 0.9 * tag as f32 + 0.001 * time_ms as f32;
            for radio in 0..RADIOS {
                let noise = 8.0 * uniform(rng) - 4.0;
                let rssi = (0.5 * level(radio, x) - 128.0 + noise) as i32;
                let from = lines.len() + 1;
                _ = write!(lines, "$PFOXB,{time_ms},{radio},{},{rssi}", 4_000_000 + tag);
                let payload = lines.as_bytes().get(from..).unwrap_or_default();
                let sum = payload.iter().fold(0, |sum, byte| sum ^ byte);
                _ = write!(lines, "*{sum:02X}\r\n");
            }
        }
    }

    /// Half seconds before the cost is taken.
    const BEFORE: u32 = 4;

    /// Runs the second.
    pub fn run() {
        static mut GATEWAY: Gateway = Gateway::EMPTY;
        static mut LINES: Lines = Lines::new();
        // SAFETY: this runs once, and nothing else knows of the two.
        let both = unsafe { ((&raw mut GATEWAY).as_mut(), (&raw mut LINES).as_mut()) };
        let (Some(gateway), Some(lines)) = both else {
            return;
        };
        let mut map = [0; MAP_BYTES];
        write_map(&mut map);
        let map = RadioMap::new(black_box(&map)).expect("it was just written");
        let config = tracker::Config {
            window_ms: 1_000,
            ..tracker::Config::TUNNEL
        };
        let config = Config::new(Site::new(map, config).expect("moments"));
        let mut rng = Xoshiro128PlusPlus::seed_from_u64(1);
        let mut fixes = 0;
        for half in 0..BEFORE + 2 {
            write_lines(half, &mut rng, lines);
            let mut work = || {
                for byte in lines.as_bytes() {
                    if let Some(event) = gateway.push(*byte, &config) {
                        fixes += u32::from(matches!(event, Event::Fix { .. }));
                        black_box(gateway.report());
                    }
                }
            };
            if half < BEFORE {
                work();
            } else {
                // Two halves make one second.
                region("m4f.beacon.t64.second", usize::from(half > BEFORE), work);
            }
        }
        assert_eq!(
            gateway.counters().packets as usize,
            (BEFORE as usize + 2) * TAGS * RADIOS
        );
        assert_eq!(fixes as usize, 2 * TAGS);
        assert_eq!(gateway.tags().count(), TAGS);
        hprintln!(
            "figure\tbeacon.t64.gateway.bytes\t{}\tbytes",
            size_of::<Gateway>()
        );
    }
}
