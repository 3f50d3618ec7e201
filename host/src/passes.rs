//! Drives past a source with a KrakenSDR of every build, some readings of which have a reflection, with default settings, and
//! where the locator is told that errors depend on the direction.

use foxhunt::{
    aoa::{
        Locate, Robust,
        robust::{self, Biases, Errors},
    },
    gateway::{Config, FullReport, Vehicle, formats::All},
};
use foxhunt_gateways::{
    PORTS,
    robust::{CONFIG, Gateway},
};
use rand::RngExt;

use crate::{
    array::{self, Method, Scene},
    geodesy::Place,
};
use foxhunt_simulation::random::{generator, normal};

/// Builds of the KrakenSDR's software that write lines of their own.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Build {
    /// krakensdr_doa of May 2022 to May 2023.
    Doa2022,
    /// krakensdr_doa of May 2023 to July 2024.
    Doa2023,
    /// krakensdr_doa since July 2024.
    Doa2024,
    /// krakensdr_suite.
    Suite2026,
}

impl Build {
    /// All of them.
    pub const ALL: [Self; 4] = [Self::Doa2022, Self::Doa2023, Self::Doa2024, Self::Suite2026];

    /// A name for it.
    pub fn name(self) -> &'static str {
        match self {
            Self::Doa2022 => "doa2022",
            Self::Doa2023 => "doa2023",
            Self::Doa2024 => "doa2024",
            Self::Suite2026 => "suite2026",
        }
    }

    /// The line of a spectrum: the end of its interval, in milliseconds after 1970, and where the vehicle was then, heading
    /// north.
    pub fn line(self, end_ms: u64, spectrum: &[f64], place: Place) -> String {
        let (degrees, ratio) = array::summary(spectrum);
        let decibels = 10.0 * ratio.log10();
        let head = match self {
            Self::Doa2022 => format!(
                "{}, {decibels:.2}, -32.51, 433920000, UCA, 100",
                360 - degrees
            ),
            Self::Doa2023 => format!("{degrees}.0, {decibels}, -32.51, 433920000, UCA, {INTERVAL}"),
            Self::Doa2024 => format!(
                "{}.0, {decibels}, -32.51, 433920000, UCA, {INTERVAL}",
                360 - degrees
            ),
            Self::Suite2026 => format!(
                "{}, {:.2}, 12.3, 433920000, UCA, 0",
                360 - degrees,
                ((ratio - 1.0) / 3.0).min(1.0)
            ),
        };
        let Place {
            latitude,
            longitude,
        } = place;
        let values = array::values(spectrum);
        format!(
            "{end_ms}, {head}, NOCALL, {latitude:.6}, {longitude:.6}, 0.0, 0.0, GPS, R, R, R, R{values} \n"
        )
    }
}

/// Milliseconds that a reading takes.
const INTERVAL: u64 = 437;

/// A drive at 15 m/s to the north, past a source 200 to 800 m to one side.
pub struct Pass {
    /// The lines of the KrakenSDR.
    pub bytes: Vec<u8>,
    /// How many these are.
    pub readings: u64,
    /// Where the source is.
    pub truth: Place,
}

/// Where the drives begin.
const ORIGIN: Place = Place {
    latitude: 47.3769,
    longitude: 8.5417,
};

impl Pass {
    /// One reading in five has a reflection, the array is mounted 3 degrees off, its antennas are off by so many degrees of
    /// phase, and places are off by a metre.
    pub fn new(build: Build, method: Method, phase_sigma: f64, seed: u64, run: u64) -> Self {
        /// Milliseconds after 1970.
        const START: u64 = 1_795_348_800_000;
        const SPEED: f64 = 15.0;
        const LENGTH: f64 = 900.0;
        const REFLECTED: f64 = 0.2;
        let mut rng = generator(seed, run);
        let side: f64 = if rng.random_bool(0.5) { 1.0 } else { -1.0 };
        let source = [
            side * rng.random_range(200.0..800.0),
            rng.random_range(300.0..600.0),
        ];
        let bias = f64::from(CONFIG.locator.track.stationary.errors.bias_sigma_rad).to_degrees()
            * normal(&mut rng);
        let (radius, signal_db) = (rng.random_range(0.2..0.42), rng.random_range(10.0..30.0));
        let errors = std::array::from_fn(|_| phase_sigma.to_radians() * normal(&mut rng));
        let mut bytes = Vec::new();
        let readings = (LENGTH / SPEED * 1e3) as u64 / INTERVAL;
        for reading in 1..=readings {
            let end_ms = reading * INTERVAL;
            let north = SPEED * 1e-3 * (end_ms - INTERVAL / 2) as f64;
            let compass = source[0].atan2(source[1] - north).to_degrees();
            let scene = Scene {
                radius,
                signal_db,
                angle: bias - compass,
                errors,
                ..if rng.random_bool(REFLECTED) {
                    Scene::reflected(&mut rng)
                } else {
                    Scene::CLEAN
                }
            };
            let spectrum = method.spectrum(&scene, &mut rng);
            let seen = [
                normal(&mut rng),
                SPEED * 1e-3 * end_ms as f64 + normal(&mut rng),
            ];
            let line = build.line(START + end_ms, &spectrum, ORIGIN.offset(seen));
            bytes.extend(line.bytes());
        }
        Self {
            bytes,
            readings,
            truth: ORIGIN.offset(source),
        }
    }
}

/// A locator that knows a curve of one harmonic: antennas that are off in phase bend bearings like that.
type OfDirections = Robust<256, 64, 6>;

/// The standard deviation of the curve, in radians: three degrees of the mounting and as many of antennas that are off by 10
/// degrees of phase, and some more.
const CURVE_SIGMA: f32 = 0.1;

/// What the locator is told of errors.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Told {
    /// The logarithm of the scale of the stated sigmas has this standard deviation; zero keeps them as stated.
    Scale(f32),
    /// That they depend on the direction: one stationary source, by a locator that learns a curve.
    Directions,
}

/// What has become of drives.
#[derive(Debug, Clone, Copy, Default)]
pub struct Passes {
    /// Drives.
    pub runs: u64,
    /// Those that end with a fix.
    pub fixes: u64,
    /// Fixes whose 95 % ellipse holds the source.
    pub held: u64,
    /// Sum of the distances from the fixes to the source, in metres.
    pub error: f64,
    /// Readings that were not used.
    pub unused: u64,
}

impl Passes {
    /// One drive through the gateway of `vehicle_robust`, or of a locator for errors by direction in its place.
    pub fn one(
        build: Build,
        method: Method,
        phase_sigma: f64,
        told: Told,
        seed: u64,
        run: u64,
    ) -> Self {
        let pass = Pass::new(build, method, phase_sigma, seed, run);
        match told {
            Told::Scale(scale_sigma) => {
                let mut config = CONFIG;
                config.locator.track.stationary.errors.scale_sigma = scale_sigma;
                Self::through(&mut Box::new(Gateway::EMPTY), &config, &pass)
            }
            Told::Directions => {
                type Of = Vehicle<OfDirections, All, FullReport, PORTS>;
                let config = Config::new(robust::Config {
                    errors: Errors {
                        biases: Biases::ByDirection,
                        bias_sigma_rad: CURVE_SIGMA,
                        ..robust::Config::CITY.errors
                    },
                    ..robust::Config::CITY
                });
                Self::through(&mut Box::new(Of::EMPTY), &config, &pass)
            }
        }
    }

    fn through<L: Locate>(
        gateway: &mut Vehicle<L, All, FullReport, PORTS>,
        config: &Config<L::Config>,
        pass: &Pass,
    ) -> Self {
        for byte in &pass.bytes {
            gateway.push(0, *byte, config);
        }
        let mut passes = Self {
            runs: 1,
            unused: pass.readings - u64::from(gateway.counters().bearings),
            ..Self::default()
        };
        if let (Some(fix), Some(plane)) = (gateway.locator().fix(), gateway.plane()) {
            let origin = Place {
                latitude: f64::from(plane.origin().latitude_e7()) * 1e-7,
                longitude: f64::from(plane.origin().longitude_e7()) * 1e-7,
            };
            let truth = origin.local(pass.truth).map(|metres| metres as f32);
            let [x, y] = fix.position;
            passes.fixes = 1;
            passes.held = u64::from(fix.ellipse(0.95).contains(truth));
            passes.error = f64::from((x - truth[0]).hypot(y - truth[1]));
        }
        passes
    }

    /// What has become of these drives and of others.
    #[must_use]
    pub fn and(self, other: Self) -> Self {
        Self {
            runs: self.runs + other.runs,
            fixes: self.fixes + other.fixes,
            held: self.held + other.held,
            error: self.error + other.error,
            unused: self.unused + other.unused,
        }
    }
}
