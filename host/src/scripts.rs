//! Drives that were written for one purpose each: what goes wrong in the field, and what a gateway is to make of it.

use std::f64::consts::{FRAC_PI_6, TAU};

use rand::RngExt;

use crate::{
    drive::{Drive, Reading, sigma_degrees},
    geodesy::Place,
};
use foxhunt_simulation::{
    path::Path,
    random::{generator, normal},
};

/// What happens on a drive.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Script {
    /// The receiver has no position for a minute, while bearings go on.
    Outage,
    /// There is no compass, and the receiver's course stands still while the vehicle crawls round a corner.
    FrozenCourse,
    /// The source is stationary, drives off round a corner, and stops again.
    Departure,
    /// Two sources take turns, which are 60 degrees apart as seen from the middle of the drive.
    TwoSources,
}

/// Where everything was, in metres east and north of where the drive began.
#[derive(Debug, Clone, PartialEq)]
pub struct Scene {
    /// What the receiver and the direction finder said.
    pub drive: Drive,
    /// Seconds after midnight at the beginning.
    pub departure: f64,
    /// The beginning.
    pub origin: Place,
    /// Where the sources were; the times count from the beginning.
    pub sources: Vec<Path>,
}

impl Script {
    /// All of them.
    pub const ALL: [Self; 4] = [
        Self::Outage,
        Self::FrozenCourse,
        Self::Departure,
        Self::TwoSources,
    ];
    /// The minute of [`Self::Outage`], in seconds from the beginning.
    pub const OUTAGE: [f64; 2] = [120.0, 180.0];
    /// When the vehicle of [`Self::FrozenCourse`] crawls.
    pub const CRAWL: [f64; 2] = [100.0, 140.0];
    /// When the source of [`Self::Departure`] moves.
    pub const MOVES: [f64; 2] = [120.0, 210.0];

    /// A name for it.
    pub fn name(self) -> &'static str {
        match self {
            Self::Outage => "outage",
            Self::FrozenCourse => "frozen-course",
            Self::Departure => "departure",
            Self::TwoSources => "two-sources",
        }
    }

    /// The drive with the errors of a seed.
    pub fn scene(self, seed: u64) -> Scene {
        const ORIGIN: Place = Place {
            latitude: 52.229_675_6,
            longitude: 21.012_228_7,
        };
        const DEPARTURE: f64 = 9.0 * 3600.0;
        let mut rng = generator(seed, self as u64);
        let (vehicle, sources) = self.paths();
        let mut drive = Drive::default();
        let [_, end] = vehicle.times().expect("it has corners");
        for source in &sources {
            let place = source.at(end).expect("as long as the vehicle's");
            drive.truth(ORIGIN.offset(place));
        }
        // What the receiver says of the course while the vehicle is too slow for it.
        let mut frozen = 0.0;
        for second in 0..end as usize {
            let t = second as f64;
            let time = DEPARTURE + t;
            let at = |t| vehicle.at(t).expect("before its end");
            let (here, next) = (at(t), at(t + 1.0));
            let [east, north] = [0, 1].map(|d| next[d] - here[d]);
            let (speed, heading) = (east.hypot(north), east.atan2(north).to_degrees());
            let is_out = self == Self::Outage && within(Self::OUTAGE, t);
            let seen = [0, 1].map(|d| here[d] + 1.5 * normal(&mut rng));
            if is_out {
                drive.no_position(time);
            } else {
                if speed > 1.5 {
                    frozen = heading.rem_euclid(360.0);
                }
                drive.position(time, ORIGIN.offset(seen), speed, frozen);
            }
            let compass = heading + 0.5 * normal(&mut rng);
            if self != Self::FrozenCourse && !is_out {
                drive.heading(compass);
            }
            let source = &sources[self.speaker(second) % sources.len()];
            let [x, y] = source.at(t).expect("as long as the vehicle's");
            let truth = (x - here[0]).atan2(y - here[1]).to_degrees();
            let error = sigma_degrees(QUALITY) * normal(&mut rng);
            let is_outlier = rng.random_bool(OUTLIER_RATE);
            let anywhere = rng.random_range(0.0..360.0);
            drive.kraken(Reading {
                time,
                degrees: if is_outlier {
                    anywhere
                } else {
                    truth - heading + error
                },
                quality: QUALITY,
            });
        }
        Scene {
            drive,
            departure: DEPARTURE,
            origin: ORIGIN,
            sources,
        }
    }

    /// Who speaks in this second.
    fn speaker(self, second: usize) -> usize {
        if self == Self::TwoSources {
            // In words of three seconds.
            second / 3
        } else {
            0
        }
    }

    fn paths(self) -> (Path, Vec<Path>) {
        let stationary = |place, end| Path::new(&[(0.0, place), (end, place)]);
        match self {
            Self::Outage => {
                let vehicle = [
                    (0.0, [0.0, 0.0]),
                    (150.0, [1_800.0, 0.0]),
                    (300.0, [1_800.0, 1_800.0]),
                ];
                (
                    Path::new(&vehicle),
                    vec![stationary([900.0, 1_000.0], 300.0)],
                )
            }
            Self::FrozenCourse => {
                let [slow, fast] = Self::CRAWL;
                let vehicle = [
                    (0.0, [0.0, 0.0]),
                    (slow, [1_200.0, 0.0]),
                    (slow + 15.0, [1_212.0, 0.0]),
                    (fast, [1_212.0, 20.0]),
                    (fast + 100.0, [1_212.0, 1_220.0]),
                ];
                (Path::new(&vehicle), vec![stationary([500.0, 900.0], 300.0)])
            }
            Self::Departure => {
                let [start, stop] = Self::MOVES;
                let middle = 0.5 * (start + stop);
                let source = [
                    (0.0, [100.0, 100.0]),
                    (start, [100.0, 100.0]),
                    (middle, [100.0, 550.0]),
                    (stop, [550.0, 550.0]),
                    (420.0, [550.0, 550.0]),
                ];
                // Round and round, at 12 m/s.
                let circle = (0..=420).map(|t| {
                    let (sin, cos) = (TAU * f64::from(t) / 260.0).sin_cos();
                    (f64::from(t), [350.0 - 500.0 * cos, 300.0 - 500.0 * sin])
                });
                let circle: Vec<_> = circle.collect();
                (Path::new(&circle), vec![Path::new(&source)])
            }
            Self::TwoSources => {
                let vehicle = [
                    (0.0, [0.0, 0.0]),
                    (125.0, [1_500.0, 0.0]),
                    (250.0, [1_500.0, 1_500.0]),
                ];
                // From the corner, 30 degrees left and right of north.
                let sources = [-1.0, 1.0].map(|side: f64| {
                    let (sin, cos) = (side * FRAC_PI_6).sin_cos();
                    stationary([1_500.0 + 900.0 * sin, 900.0 * cos], 250.0)
                });
                (Path::new(&vehicle), sources.to_vec())
            }
        }
    }
}

impl Scene {
    /// Where a place in degrees of 1e-7 is, in metres from the beginning.
    pub fn local(&self, latitude_e7: i32, longitude_e7: i32) -> [f64; 2] {
        self.origin.local(Place {
            latitude: f64::from(latitude_e7) * 1e-7,
            longitude: f64::from(longitude_e7) * 1e-7,
        })
    }
}

const QUALITY: f64 = 97.12;
/// Rate of outliers among the bearings.
const OUTLIER_RATE: f64 = 0.05;

fn within([start, end]: [f64; 2], t: f64) -> bool {
    (start..end).contains(&t)
}
