//! The scenarios, and what is asked of the locator in each.

use std::f64::consts::PI;

use anyhow::{Result, ensure};
use foxhunt_host::{
    channel::{Channel, Heard, Reading},
    tracks::Track,
};
use foxhunt_simulation::random::generator;

const DEGREE: f64 = PI / 180.0;
/// The sides of the squares, in metres.
const SIDES: [(&str, f64); 2] = [("s12", 12.0), ("s1200", 1200.0)];
const READINGS: [usize; 3] = [1, 5, 50];
const SIGMAS: [(&str, f64); 2] = [("sigma2", 2.0 * DEGREE), ("sigma6", 6.0 * DEGREE)];
const STOP_SIGMA: f64 = 5.0 * DEGREE;
/// Of the side of a square: what is farther from a source is none of it.
const CUTOFF: f64 = 0.25;
/// Of two sources and of one, in metres.
const FAR_M: f64 = 200.0;
/// Of the bearings on two sources and on one, in radians: as in the tests of the locator.
const SIGMA: f64 = 0.0195;

/// A channel, and what is asked of the locator there.
#[derive(Debug, Clone)]
pub struct Scenario {
    /// What its figures are called, dotted.
    pub name: String,
    kind: Kind,
    /// Runs, unless told otherwise.
    pub runs: u32,
    /// Distance from which on an estimate is none of the source.
    pub cutoff_m: f64,
    pub(super) limits: Limits,
}

#[derive(Debug, Clone, Copy)]
enum Kind {
    Stops {
        side_m: f64,
        readings: usize,
        sigma: f64,
        stop_sigma: f64,
        outliers: f64,
    },
    Drive {
        side_m: f64,
        sigma: f64,
        outliers: f64,
    },
    /// The first is heard with this probability.
    Pair(f64),
    /// One source along an L, with outliers.
    One(f64),
}

/// The least and the most that passes.
#[derive(Debug, Clone, Copy)]
pub struct Limits {
    /// Least fraction of runs in which all sources are found.
    pub found: f64,
    /// Largest fraction of runs with a ghost at the end.
    pub ghosts: f64,
    /// Largest RMSE, in that of locators that are told the identities.
    pub ratio: f64,
    /// The least and the most that the 95 % regions hold the source.
    pub covered: [f64; 2],
}

const LIMITS: Limits = Limits {
    found: 0.95,
    ghosts: 0.03,
    ratio: 1.2,
    covered: [0.92, 0.98],
};

impl Scenario {
    /// All of them.
    pub fn all() -> Vec<Self> {
        let mut all = Vec::new();
        for (side, side_m) in SIDES {
            for readings in READINGS {
                for (name, sigma) in SIGMAS {
                    for (stop, stop_sigma) in [("", STOP_SIGMA), (".own", 0.0)] {
                        // Without an error in common, more readings are but better ones.
                        if readings > 1 && stop_sigma == 0.0 {
                            continue;
                        }
                        for (what, outliers) in [("", 0.0), (".outliers", 0.1)] {
                            let name = format!("stops.{side}.n{readings}.{name}{stop}{what}");
                            let kind = Kind::Stops {
                                side_m,
                                readings,
                                sigma,
                                stop_sigma,
                                outliers,
                            };
                            all.push(Self::square(name, kind));
                        }
                    }
                }
            }
        }
        for (name, sigma) in SIGMAS {
            for (what, outliers) in [("", 0.0), (".outliers", 0.1)] {
                let kind = Kind::Drive {
                    side_m: 1200.0,
                    sigma,
                    outliers,
                };
                all.push(Self::square(format!("drive.{name}{what}"), kind));
            }
        }
        for (name, first) in [("even", 0.5), ("four_to_one", 0.8)] {
            all.push(Self {
                name: format!("pair.{name}"),
                kind: Kind::Pair(first),
                runs: 200,
                cutoff_m: FAR_M,
                limits: LIMITS,
            });
        }
        all.push(Self {
            name: "one.outliers".to_owned(),
            kind: Kind::One(0.3),
            runs: 1000,
            cutoff_m: FAR_M,
            limits: Limits {
                ghosts: 0.0,
                ..LIMITS
            },
        });
        all
    }

    /// Those whose names begin with the dotted words of one of these; all, if nothing is asked for.
    ///
    /// # Errors
    /// When no name does.
    pub fn asked(asked: &[String]) -> Result<Vec<Self>> {
        let mut all = Self::all();
        let names: Vec<String> = all.iter().map(|scenario| scenario.name.clone()).collect();
        all.retain(|scenario| {
            let begins = |name: &String| {
                let rest = scenario.name.strip_prefix(name.as_str());
                rest.is_some_and(|rest| rest.is_empty() || rest.starts_with('.'))
            };
            asked.is_empty() || asked.iter().any(begins)
        });
        ensure!(
            !all.is_empty(),
            "no scenario has such a name: they are {}",
            names.join(", ")
        );
        Ok(all)
    }

    fn square(name: String, kind: Kind) -> Self {
        let (Kind::Stops {
            side_m, outliers, ..
        }
        | Kind::Drive {
            side_m, outliers, ..
        }) = kind
        else {
            unreachable!("not about a square")
        };
        let hard = matches!(kind, Kind::Stops { readings: 1, sigma, .. } if sigma > 5.0 * DEGREE);
        let found = match (hard, outliers > 0.0) {
            (true, _) => 0.8,
            (false, true) => 0.9,
            (false, false) => LIMITS.found,
        };
        Self {
            name,
            kind,
            runs: 200,
            cutoff_m: CUTOFF * side_m,
            limits: Limits { found, ..LIMITS },
        }
    }

    /// The part of its name that it has in common with those that it is shown with.
    pub(super) fn group(&self) -> &str {
        let split = self.name.split_once(".sigma");
        let split = split.or(self.name.split_once('.'));
        split.map_or(&self.name, |(group, _)| group)
    }

    /// The sources and the readings of a run.
    pub fn readings(&self, seed: u64, run: u64) -> (Channel, Vec<Reading>) {
        let channel = self.channel(seed, run);
        let readings = channel.readings(&mut generator(seed, run));
        (channel, readings)
    }

    fn channel(&self, seed: u64, run: u64) -> Channel {
        match self.kind {
            Kind::Stops {
                side_m,
                readings,
                sigma,
                stop_sigma,
                outliers,
            } => Channel::stops(side_m, readings, sigma, stop_sigma).with_outliers(outliers),
            Kind::Drive {
                side_m,
                sigma,
                outliers,
            } => Channel::drive(side_m, sigma).with_outliers(outliers),
            Kind::Pair(first) => Channel::pair(first, SIGMA, &mut generator(!seed, run)),
            Kind::One(outliers) => {
                let track = Track::a2();
                Channel {
                    sources: vec![track.source],
                    places: track.receivers,
                    heard: Heard::OneOf(1.0),
                    interval_ms: 0,
                    way_ms: 0,
                    every_ms: 1_000,
                    sigma: SIGMA,
                    stop_sigma: 0.0,
                    outliers,
                }
            }
        }
    }
}
