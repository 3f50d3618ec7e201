//! A robot's survey of a flat, a map by default, and another drive: beside the match without memory and five nearest neighbours
//! with a Kalman filter.

mod neighbours;

use anyhow::Result;
use foxhunt::fingerprint::{
    Config as Matching, Matcher, Posterior, RadioMap, Reading,
    tracker::{Config, Fix, Site},
};
use foxhunt_host::{
    figures::Figure,
    picture,
    radio_map::{Made, Recipe},
    robot::{self, Drive},
    walks::fixes,
};
use rayon::prelude::*;

use super::coverage::Coverage;
use crate::papers::{statistics::median, study::Study, table::table};

/// Filter seeds.
const SEEDS: u64 = 40;

/// Errors of a method where the robot moved, in metres.
struct Errors(Vec<f64>);

impl Errors {
    fn quantile(&self, fraction: f64) -> f64 {
        let mut all = self.0.clone();
        all.sort_by(f64::total_cmp);
        all[((all.len() - 1) as f64 * fraction) as usize]
    }

    fn near(&self) -> f64 {
        self.0.iter().filter(|error| **error < 2.0).count() as f64 / self.0.len() as f64
    }
}

/// Runs the experiment, if there is data.
pub fn run(study: &Study) -> Result<Vec<Figure>> {
    let Some(data) = study.data("calib2021", "drive of a robot") else {
        return Ok(Vec::new());
    };
    let survey = robot::survey(&data)?;
    let started = std::time::Instant::now();
    let made = survey.map(&Recipe::default(), &mut |_| ())?;
    let seconds = started.elapsed().as_secs_f64();
    println!(
        "A robot's survey of a flat with six beacons, {} places, made a map in {seconds:.1} s: {}.",
        survey.survey().places.len(),
        made.choices
    );
    let drive = robot::drive(&data, "robot", survey.beacons())?;
    let map = RadioMap::new(&made.bytes)?;
    let times = drive.times();
    let tracked = track(map, &drive, &times, study.seed)?;
    let moving = |places: &[[f64; 2]]| {
        let pairs = places.iter().zip(&times).filter(|(_, (_, moves))| *moves);
        Errors(
            pairs
                .map(|(place, (time, _))| error(&drive, *time, *place))
                .collect(),
        )
    };
    let ours = Errors(
        tracked
            .iter()
            .flat_map(|fixes| moving(&places(fixes)).0)
            .collect(),
    );
    let matched = moving(&matches(map, &drive, &times)?);
    let neighbours = moving(&neighbours::track(&survey, &drive, &times));
    let coverage = cover(&drive, &times, &tracked);
    let expected =
        [0.5, 0.9].map(|fraction| made.expected.quantile_m(fraction).unwrap_or(f64::NAN));
    println!(
        "Another drive, the steps of a second in which it moves ({}), {SEEDS} filter seeds; expected before it, of places that were \
         left out, without memory: median {:.2} m, 90 % within {:.2} m.",
        matched.0.len(),
        expected[0],
        expected[1],
    );
    let mut rows = table(["method", "< 2 m", "median m", "90 % below m"], 1);
    for (name, errors) in [
        ("match of the last 2 s, no memory", &matched),
        (
            "five nearest neighbours of the last second, Kalman filter",
            &neighbours,
        ),
        ("tracker", &ours),
    ] {
        rows.add_row([
            name.to_owned(),
            format!("{:.1} %", 100.0 * errors.near()),
            format!("{:.2}", errors.quantile(0.5)),
            format!("{:.2}", errors.quantile(0.9)),
        ]);
    }
    println!("{rows}");
    println!("{coverage}\n");
    draw(
        study,
        &made,
        &drive,
        &times,
        &tracked,
        &survey.survey().places,
    )?;
    Ok(figures(&ours, &matched, &neighbours, &coverage, seconds))
}

fn error(drive: &Drive, time: f64, [x, y]: [f64; 2]) -> f64 {
    let [tx, ty] = drive.at(time);
    (x - tx).hypot(y - ty)
}

fn places(fixes: &[Fix]) -> Vec<[f64; 2]> {
    fixes
        .iter()
        .map(|fix| fix.position.map(f64::from))
        .collect()
}

fn track(
    map: RadioMap<'_>,
    drive: &Drive,
    times: &[(f64, bool)],
    seed: u64,
) -> Result<Vec<Vec<Fix>>> {
    let site = Site::new(map, Config::DEFAULT)?;
    let times: Vec<f64> = times.iter().map(|(time, _)| *time).collect();
    (0..SEEDS)
        .into_par_iter()
        .map(|filter_seed| fixes(&site, &drive.packets, &times, seed << 8 ^ filter_seed))
        .collect()
}

/// The mean over the posterior of the mean levels of the last 2 s.
fn matches(map: RadioMap<'_>, drive: &Drive, times: &[(f64, bool)]) -> Result<Vec<[f64; 2]>> {
    let matcher = Matcher::new(map, &Matching::DEFAULT)?;
    let mut posterior = Box::new(Posterior::<4096>::EMPTY);
    let mut last = [0.0; 2];
    let mut at = |time: f64| {
        let scan: Vec<Reading> = means(drive, map.beacons(), time - 2.0..time)
            .into_iter()
            .enumerate()
            .filter_map(|(beacon, level)| {
                Some(Reading {
                    beacon: beacon as u8,
                    rssi_dbm: level? as f32,
                })
            })
            .collect();
        // Where nothing is heard, it is where it was.
        if let Ok(found) = matcher.locate(&scan, &mut posterior) {
            last = found.mean.map(f64::from);
        }
        last
    };
    Ok(times.iter().map(|(time, _)| at(*time)).collect())
}

/// The mean level of each beacon.
fn means(drive: &Drive, beacons: usize, times: std::ops::Range<f64>) -> Vec<Option<f64>> {
    let mut sums = vec![(0.0, 0.0); beacons];
    for packet in &drive.packets {
        if times.contains(&packet.time) {
            sums[packet.beacon].0 += 1.0;
            sums[packet.beacon].1 += packet.level;
        }
    }
    let mean = |(count, sum): (f64, f64)| (count > 0.0).then(|| sum / count);
    sums.into_iter().map(mean).collect()
}

/// Of all steps, at rest or not.
fn cover(drive: &Drive, times: &[(f64, bool)], tracked: &[Vec<Fix>]) -> Coverage {
    let mut coverage = Coverage::default();
    for fixes in tracked {
        let holds = fixes
            .iter()
            .zip(times)
            .map(|(fix, (time, _))| fix.contains(drive.at(*time).map(|c| c as f32), 0.95));
        coverage.push(holds.collect());
    }
    coverage
}

fn draw(
    study: &Study,
    made: &Made,
    drive: &Drive,
    times: &[(f64, bool)],
    tracked: &[Vec<Fix>],
    survey: &[[f64; 2]],
) -> Result<()> {
    let promised = picture::Field::of_points(
        "promised by the survey: a look without memory",
        &made.lattice,
        &made.expected.by_point_m,
    );
    let mut errors = Vec::new();
    for (step, (time, _)) in times.iter().enumerate() {
        let of_seeds = tracked
            .iter()
            .map(|fixes| error(drive, *time, places(&fixes[step..=step])[0]));
        errors.push((drive.at(*time), median(of_seeds)));
    }
    let heat = picture::Heat {
        title: "Expected error of a map, and the error of the tracker on another drive, in metres"
            .into(),
        panels: vec![
            promised.clone(),
            picture::Field::of_places("had by the tracker", &promised, &errors),
        ],
        places: survey.iter().step_by(8).copied().collect(),
    };
    study.save(&heat.svg()?, "fingerprint-robot")?;
    println!();
    Ok(())
}

fn figures(
    ours: &Errors,
    matched: &Errors,
    neighbours: &Errors,
    coverage: &Coverage,
    seconds: f64,
) -> Vec<Figure> {
    let figure = |name: &str, value, unit: &str| {
        Figure::new(format!("papers.fingerprint.robot.{name}"), value, unit)
    };
    let mut figures = vec![
        figure("tracker.beyond_2_m", 1.0 - ours.near(), "of steps").at_most(0.14),
        figure("tracker.median", ours.quantile(0.5), "m").at_most(1.05),
        figure("tracker.p90", ours.quantile(0.9), "m").at_most(2.1),
        figure("map.seconds", seconds, "s").at_most(10.0),
        figure("tracker.coverage_off_95", coverage.off(0.95), "of steps").at_most(0.0),
    ];
    for (name, errors) in [("match", matched), ("five_neighbours_kalman", neighbours)] {
        figures.push(figure(
            &format!("{name}.beyond_2_m"),
            1.0 - errors.near(),
            "of steps",
        ));
        figures.push(figure(&format!("{name}.median"), errors.quantile(0.5), "m"));
        figures.push(figure(&format!("{name}.p90"), errors.quantile(0.9), "m"));
    }
    figures
}
