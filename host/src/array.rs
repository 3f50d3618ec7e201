//! A circle of five antennas that hears a source and one reflection of it: the spectra that a KrakenSDR makes of them, as
//! lines, and how far the gateway's bearings can be trusted.

use std::{f64::consts::TAU, fmt::Write};

use foxhunt::{
    aoa::{Robust, robust, spectrum::Spectrum},
    gateway::{
        BearingReference, Config, Event, Gateway, ShortReport,
        formats::{Formats, Kraken},
    },
};
use nalgebra::{Complex, SMatrix, SVector};
use rand::{Rng, RngExt};

use foxhunt_simulation::random::{generator, normal};

const ANTENNAS: usize = 5;
/// Degrees of the circle.
const CELLS: usize = 360;
/// How many samples of all antennas a spectrum is made of.
const SAMPLES: usize = 256;

type Vector = SVector<Complex<f64>, ANTENNAS>;
type Matrix = SMatrix<Complex<f64>, ANTENNAS, ANTENNAS>;

/// How a spectrum is made.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Method {
    /// Multiple signal classification, for one source.
    Music,
    /// Least variance without distortion.
    Capon,
    /// A beam that is turned.
    Bartlett,
}

/// What the array hears; angles are in degrees counter-clockwise from its axis.
#[derive(Debug, Clone, Copy)]
pub struct Scene {
    /// Of the circle, in wavelengths.
    pub radius: f64,
    /// Of the direct path, over the noise of one antenna, in decibels.
    pub signal_db: f64,
    /// Where the source is.
    pub angle: f64,
    /// The amplitude of the reflection over that of the direct path.
    pub reflection: f64,
    /// Where the reflection comes from.
    pub reflected: f64,
    /// By how much the reflection is late, in radians.
    pub phase: f64,
    /// By how much every antenna is off, in radians, as cables, neighbours and the roof make it.
    pub errors: [f64; ANTENNAS],
}

impl Method {
    /// All of them.
    pub const ALL: [Self; 3] = [Self::Music, Self::Capon, Self::Bartlett];

    /// A name for it.
    pub fn name(self) -> &'static str {
        match self {
            Self::Music => "music",
            Self::Capon => "capon",
            Self::Bartlett => "bartlett",
        }
    }

    /// The spectrum of a scene, in decibels over its least, a value for each degree counter-clockwise from the axis.
    pub fn spectrum(self, scene: &Scene, rng: &mut impl Rng) -> Vec<f64> {
        let covariance = scene.covariance(rng);
        let form = match self {
            Self::Bartlett => covariance,
            Self::Capon => covariance.try_inverse().expect("there is noise"),
            Self::Music => {
                let eigen = covariance.symmetric_eigen();
                let signal = eigen.eigenvectors.column(eigen.eigenvalues.imax());
                Matrix::identity() - signal * signal.adjoint()
            }
        };
        let level = |degree: usize| {
            let steering = steering(scene.radius, degree as f64);
            let power = (steering.adjoint() * form * steering)[0].re.abs();
            let level = 10.0 * power.max(1e-12).log10();
            if self == Self::Bartlett {
                level
            } else {
                -level
            }
        };
        let levels: Vec<f64> = (0..CELLS).map(level).collect();
        let least = levels.iter().copied().fold(f64::INFINITY, f64::min);
        levels.iter().map(|level| level - least).collect()
    }
}

/// How the antennas hear a wave from so many degrees.
fn steering(radius: f64, degrees: f64) -> Vector {
    Vector::from_fn(|antenna, _| {
        let angle = degrees.to_radians() - TAU * antenna as f64 / ANTENNAS as f64;
        Complex::from_polar(1.0, TAU * radius * angle.cos())
    })
}

impl Scene {
    /// 20 dB on a circle of 0.3 wavelengths, straight ahead, without a reflection.
    pub const CLEAN: Self = Self {
        radius: 0.3,
        signal_db: 20.0,
        angle: 0.0,
        reflection: 0.0,
        reflected: 0.0,
        phase: 0.0,
        errors: [0.0; ANTENNAS],
    };

    /// 10 to 30 dB on a circle of 0.2 to 0.42 wavelengths, with a reflection of 0.2 to 0.6 from anywhere.
    pub fn reflected(rng: &mut impl Rng) -> Self {
        Self {
            radius: rng.random_range(0.2..0.42),
            signal_db: rng.random_range(10.0..30.0),
            angle: rng.random_range(0.0..360.0),
            reflection: rng.random_range(0.2..0.6),
            reflected: rng.random_range(0.0..360.0),
            phase: rng.random_range(0.0..TAU),
            ..Self::CLEAN
        }
    }

    fn covariance(&self, rng: &mut impl Rng) -> Matrix {
        let reflection = Complex::from_polar(self.reflection, self.phase);
        let path =
            steering(self.radius, self.angle) + steering(self.radius, self.reflected) * reflection;
        let errors = self.errors.map(|error| Complex::from_polar(1.0, error));
        let path = path.component_mul(&Vector::from(errors));
        let noise = 10.0_f64.powf(-0.05 * self.signal_db);
        let mut draw =
            |scale: f64| Complex::new(normal(rng), normal(rng)) * (scale * 0.5_f64.sqrt());
        let mut sum = Matrix::zeros();
        for _ in 0..SAMPLES {
            let source = draw(1.0);
            let heard = Vector::from_fn(|antenna, _| path[antenna] * source + draw(noise));
            sum += heard * heard.adjoint();
        }
        sum / Complex::new(SAMPLES as f64, 0.0)
    }
}

/// Where the maximum of a spectrum is, in degrees counter-clockwise, and the ratio of its power to the mean.
pub fn summary(spectrum: &[f64]) -> (u32, f64) {
    let higher = |best: (u32, f64), (degree, level): (u32, &f64)| {
        if *level > best.1 {
            (degree, *level)
        } else {
            best
        }
    };
    let (top, highest) = (0..).zip(spectrum).fold((0, f64::MIN), higher);
    let power = |level: &f64| 10.0_f64.powf(0.1 * (level - highest));
    let sum: f64 = spectrum.iter().map(power).sum();
    (top, spectrum.len() as f64 / sum)
}

/// The values of a spectrum as they stand in a line, each after a comma.
pub fn values(spectrum: &[f64]) -> String {
    let mut text = String::new();
    for level in spectrum {
        // Writing to a string does not fail.
        let _ = write!(text, ", {level:.2}");
    }
    text
}

/// What a spectrum says, as a line of krakensdr_doa since July 2024 has it at its end: the bearing, the confidence, and the
/// values after the fields that stand between.
pub fn fields(spectrum: &[f64], between: &str) -> String {
    let (top, ratio) = summary(spectrum);
    let (degrees, decibels) = (360 - top, 10.0 * ratio.log10());
    format!("{degrees}.0, {decibels}, {between}{} ", values(spectrum))
}

/// How far the stated errors of bearings among reflections can be trusted.
#[derive(Debug, Clone, Copy, Default)]
pub struct Coverage {
    /// Rate of readings of which the 95 % interval of any bearing holds the truth.
    pub any: f64,
    /// Rate of those of which that of the most probable bearing does.
    pub best: f64,
    /// Root of the mean square of the stated standard deviations of those, in degrees.
    pub stated: f64,
    /// Root of the mean square of their errors, in degrees.
    pub error: f64,
    /// Bearings of a reading.
    pub bearings: f64,
}

/// Readings of scenes, by the format that reads the bearing or by the one that reads the spectrum.
pub fn coverage(method: Method, spectra: bool, runs: u64, seed: u64) -> Coverage {
    if spectra {
        of_format::<(Kraken<Spectrum>,)>(method, runs, seed)
    } else {
        of_format::<(Kraken,)>(method, runs, seed)
    }
}

fn of_format<F: Formats>(method: Method, runs: u64, seed: u64) -> Coverage {
    type Whole<F> = Gateway<Robust<64, 8>, F, ShortReport>;
    /// Milliseconds after 1970.
    const START: u64 = 1_795_348_800_000;
    const BETWEEN: &str = "-32.5, 433920000, UCA, 437, array, 47.0, 8.0, 0.0, 0.0, GPS, R, R, R, R";
    let mut gateway: Box<Whole<F>> = Box::new(
        Gateway::new(Config {
            reference: BearingReference::TrueNorth,
            ..Config::new(robust::Config::DEFAULT)
        })
        .expect("it is in range"),
    );
    let mut sums = Coverage::default();
    for run in 0..runs {
        let mut rng = generator(seed, run);
        let scene = Scene::reflected(&mut rng);
        let spectrum = method.spectrum(&scene, &mut rng);
        let line = format!("{}, {}\n", START + 1_000 * run, fields(&spectrum, BETWEEN));
        gateway.vehicle_mut().restart();
        let event = line.bytes().find_map(|byte| gateway.push(0, byte));
        assert!(matches!(event, Some(Event::NotObservable(_))), "{event:?}");
        let vehicle = gateway.vehicle();
        let best = vehicle.observation().expect("it was used");
        // Its axis points north.
        let truth = (90.0 + scene.angle).to_radians();
        let error = |bearing: f32| {
            let turn = f64::from(bearing) - truth;
            turn.sin().atan2(turn.cos()).to_degrees()
        };
        let holds =
            |bearing: f32, sigma: f32| error(bearing).abs() <= 1.96 * f64::from(sigma).to_degrees();
        let all = vehicle.locator().observations();
        sums.bearings += all.len() as f64;
        let any = all
            .into_iter()
            .any(|seen| holds(seen.bearing().radians(), seen.sigma_rad()));
        sums.any += f64::from(u8::from(any));
        let (bearing, sigma) = (best.bearing().radians(), best.sigma_rad());
        sums.best += f64::from(u8::from(holds(bearing, sigma)));
        sums.stated += f64::from(sigma).to_degrees().powi(2);
        sums.error += error(bearing).powi(2);
    }
    let mean = |sum: f64| sum / runs as f64;
    Coverage {
        any: mean(sums.any),
        best: mean(sums.best),
        stated: mean(sums.stated).sqrt(),
        error: mean(sums.error).sqrt(),
        bearings: mean(sums.bearings),
    }
}
