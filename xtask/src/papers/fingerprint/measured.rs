//! Walks that were measured in an office: one set of parameters, the library's.

use std::{env, path::Path};

use anyhow::Result;
use comfy_table::{CellAlignment, Table, presets::ASCII_MARKDOWN};
use foxhunt::{
    fingerprint::{
        published::{Cloud, Model},
        tracker::Settings,
    },
    kalman::Covariance,
    random::{SeedableRng, Xoshiro128PlusPlus},
};
use foxhunt_host::{
    picture::{self, Axis, Curves},
    simulate::generator,
    tunnel::Packet,
    walks::{Office, PARTICLES, Walk},
};
use indicatif::ParallelProgressIterator;
use rand::RngExt;
use rayon::prelude::*;

use super::errors::Errors;
use crate::{
    figures::Figure,
    papers::{Study, picture, progress, statistics::median},
};

/// Filter seeds of every walk, and of every set of four receivers.
const SEEDS: u64 = 40;
const SEEDS_OF_SETS: u64 = 4;
/// Receivers that the straight walks do best with, of all sets of four.
const FOUR: [usize; 4] = [0, 4, 9, 10];
/// Share of the readings that may be anything, and what they then are, in dBm.
const WILD: f64 = 0.05;
const WILD_DBM: std::ops::Range<f64> = -100.0..-40.0;
/// What a tag reads too strong, in dB.
const OFFSET: f64 = 10.0;

/// The errors on the straight walks and on those in the plane.
#[derive(Default)]
struct Both {
    straight: Errors,
    plane: Errors,
}

impl Both {
    fn push(&mut self, walk: &Walk, errors: Vec<f64>) {
        let both = if walk.is_straight {
            &mut self.straight
        } else {
            &mut self.plane
        };
        both.push(errors);
    }
}

/// What is changed about the packets of a walk, for a seed.
type Change<'a> = &'a (dyn Fn(&[Packet], u64) -> Vec<Packet> + Sync);

/// Runs all experiments, if there is data.
pub fn run(study: &Study) -> Result<Vec<Figure>> {
    let Some(data) = env::var_os("FOXHUNT_DATA") else {
        println!(
            "the measured walks, and their figures, are skipped: FOXHUNT_DATA does not name the directory of the \
             measured data\n"
        );
        return Ok(Vec::new());
    };
    let office = Office::open(&Path::new(&data).join("tetam"))?;
    let receivers = office.receivers.len();
    let bar = progress(receivers as u64 + 5, "measured walks")?;
    let tracked = |change: Change<'_>| -> Result<Both> {
        let both = track(&office, study.seed, change);
        bar.inc(1);
        both
    };
    let all = tracked(&|packets, _| packets.to_vec())?;
    let four = tracked(&|packets, _| only(packets, &FOUR))?;
    let [louder, quieter] = [OFFSET, -OFFSET]
        .map(|offset| tracked(&move |packets, _| changed(packets, |p| p.level += offset)));
    let (louder, quieter) = (louder?, quieter?);
    let wild = tracked(&|packets, seed| {
        let mut rng = generator(study.seed ^ 9, seed);
        changed(packets, |packet| {
            if rng.random_bool(WILD) {
                packet.level = rng.random_range(WILD_DBM).round();
            }
        })
    })?;
    let dead: Vec<Both> = (0..receivers)
        .map(|dead| {
            tracked(&move |packets, _| {
                packets
                    .iter()
                    .filter(|p| p.beacon != dead)
                    .copied()
                    .collect()
            })
        })
        .collect::<Result<_>>()?;
    bar.finish_and_clear();
    let matched = memoryless(&office)?;
    let printed = two_stage(&office, study.seed, false)?;
    let fitted = two_stage(&office, study.seed, true)?;
    let sets = sets_of_four(&office, study.seed)?;

    println!(
        "Walks measured in an office with {receivers} receivers: three along corridors, two in the plane. A step is every \
         2 s, from 2 s after the start; errors in the plane, {SEEDS} filter seeds of every walk, the tracker with the \
         library's own settings. The radio map errs by {:.2} dB where a place of the survey is left out.",
        office.left_out_db
    );
    let worst = |of: fn(&Both) -> &Errors| {
        let worst = dead
            .iter()
            .enumerate()
            .max_by(|a, b| of(a.1).quantile(0.9).total_cmp(&of(b.1).quantile(0.9)));
        worst.expect("there are receivers")
    };
    let straight: fn(&Both) -> &Errors = |both| &both.straight;
    let plane: fn(&Both) -> &Errors = |both| &both.plane;
    let (dead_straight, dead_plane) = (worst(straight), worst(plane));
    let four_label = format!("tracker, receivers {FOUR:?}");
    let dead_label = format!(
        "tracker, worst receiver dead ({}; {} in the plane)",
        dead_straight.0, dead_plane.0
    );
    let rows = [
        (
            "match of the last 2 s, no memory",
            &matched.straight,
            &matched.plane,
        ),
        (
            "match, then PF, 200/40 as printed",
            &printed.straight,
            &printed.plane,
        ),
        (
            "match, then PF, what these matches err by",
            &fitted.straight,
            &fitted.plane,
        ),
        ("tracker", &all.straight, &all.plane),
        (&four_label, &four.straight, &four.plane),
        (
            "tracker, tag 10 dB too strong",
            &louder.straight,
            &louder.plane,
        ),
        (
            "tracker, tag 10 dB too weak",
            &quieter.straight,
            &quieter.plane,
        ),
        (
            "tracker, 5 % of the readings anything",
            &wild.straight,
            &wild.plane,
        ),
        (&dead_label, &dead_straight.1.straight, &dead_plane.1.plane),
    ];
    print(&rows);
    let good = sets.iter().filter(|near| **near >= 0.85).count() as f64 / sets.len() as f64;
    let middle = median(sets.iter().copied());
    println!(
        "Four receivers: those were chosen by these walks, as the best of {} sets. The median set has {:.1} % of the steps of \
         the straight walks below 2 m, {:.0} % of the sets have 85 %.\n\
         A tag 10 dB too strong is found late on the straight walks, 90 % of the steps within {:.2} m instead of {:.2} m: an \
         end of a corridor and an offset look alike to the first scans.\n",
        sets.len(),
        100.0 * middle,
        100.0 * good,
        louder.straight.quantile(0.9),
        all.straight.quantile(0.9),
    );
    draw(&rows)?;
    for walk in office.walks.iter().filter(|walk| !walk.is_straight).take(1) {
        super::pictures::measured(&office, walk, study.seed)?;
    }

    let figure = |name: &str, value: f64, unit: &str| {
        Figure::new(format!("papers.fingerprint.measured.{name}"), value, unit)
    };
    let beyond = |errors: &Errors| 1.0 - errors.near().value;
    let ratio = |changed: &Errors, clean: &Errors| changed.quantile(0.9) / clean.quantile(0.9);
    Ok(vec![
        figure("map.left_out", office.left_out_db, "dB"),
        figure(
            "straight.12_receivers.beyond_2_m",
            beyond(&all.straight),
            "of steps",
        )
        .at_most(0.05),
        figure("straight.12_receivers.p90", all.straight.quantile(0.9), "m"),
        figure(
            "straight.4_receivers.beyond_2_m",
            beyond(&four.straight),
            "of steps",
        )
        .at_most(0.15),
        figure(
            "straight.4_receivers.median_set_beyond_2_m",
            1.0 - middle,
            "of steps",
        ),
        figure("straight.4_receivers.sets_that_miss", 1.0 - good, "of sets"),
        figure(
            "straight.match.beyond_2_m",
            beyond(&matched.straight),
            "of steps",
        ),
        figure(
            "straight.two_stage_printed.beyond_2_m",
            beyond(&printed.straight),
            "of steps",
        ),
        figure(
            "straight.two_stage_fitted.beyond_2_m",
            beyond(&fitted.straight),
            "of steps",
        ),
        figure("plane.12_receivers.p90", all.plane.quantile(0.9), "m").at_most(2.9),
        figure("plane.match.p90", matched.plane.quantile(0.9), "m"),
        figure(
            "plane.two_stage_printed.p90",
            printed.plane.quantile(0.9),
            "m",
        ),
        figure(
            "plane.two_stage_fitted.p90",
            fitted.plane.quantile(0.9),
            "m",
        ),
        figure(
            "plane.10_db_too_strong.p90_ratio",
            ratio(&louder.plane, &all.plane),
            "",
        )
        .at_most(1.10),
        figure(
            "plane.10_db_too_weak.p90_ratio",
            ratio(&quieter.plane, &all.plane),
            "",
        ),
        figure(
            "straight.10_db_too_strong.p90_ratio",
            ratio(&louder.straight, &all.straight),
            "",
        ),
        figure(
            "straight.10_db_too_strong.beyond_2_m",
            beyond(&louder.straight),
            "of steps",
        ),
        figure(
            "plane.5_percent_wild.p90_ratio",
            ratio(&wild.plane, &all.plane),
            "",
        )
        .at_most(1.15),
        figure(
            "straight.5_percent_wild.p90_ratio",
            ratio(&wild.straight, &all.straight),
            "",
        )
        .at_most(1.15),
        figure(
            "plane.one_dead.p90_ratio",
            ratio(&dead_plane.1.plane, &all.plane),
            "",
        )
        .at_most(1.20),
        figure(
            "straight.one_dead.p90_ratio",
            ratio(&dead_straight.1.straight, &all.straight),
            "",
        )
        .at_most(1.20),
    ])
}

fn changed(packets: &[Packet], mut change: impl FnMut(&mut Packet)) -> Vec<Packet> {
    let mut packets = packets.to_vec();
    packets.iter_mut().for_each(&mut change);
    packets
}

fn only(packets: &[Packet], receivers: &[usize]) -> Vec<Packet> {
    let heard = |packet: &&Packet| receivers.contains(&packet.beacon);
    packets.iter().filter(heard).copied().collect()
}

/// Every walk with every seed.
fn track(office: &Office, seed: u64, change: Change<'_>) -> Result<Both> {
    let jobs: Vec<(usize, u64)> = (0..office.walks.len())
        .flat_map(|walk| (0..SEEDS).map(move |seed| (walk, seed)))
        .collect();
    let errors: Vec<Vec<f64>> = jobs
        .par_iter()
        .map(|(number, filter_seed)| {
            let walk = &office.walks[*number];
            let packets = change(&walk.packets, *number as u64 * SEEDS + filter_seed);
            let times = walk.times();
            let places = walk.follow(&packets, &times, Settings::new(), seed << 8 ^ filter_seed)?;
            Ok(walk.errors(&times, &places))
        })
        .collect::<Result<_>>()?;
    let mut both = Both::default();
    for ((number, _), errors) in jobs.iter().zip(errors) {
        both.push(&office.walks[*number], errors);
    }
    Ok(both)
}

fn memoryless(office: &Office) -> Result<Both> {
    let mut both = Both::default();
    for walk in &office.walks {
        let times = walk.times();
        let places = walk.matched(&walk.packets, &times)?;
        both.push(walk, walk.errors(&times, &places));
    }
    Ok(both)
}

/// The published filter; if fitted, with what the matches of the very walks err by, which is more than it could know.
fn two_stage(office: &Office, seed: u64, is_fitted: bool) -> Result<Both> {
    let mut both = Both::default();
    for straight in [true, false] {
        let walks = office
            .walks
            .iter()
            .filter(|walk| walk.is_straight == straight);
        // In the frame of the maps, in which corridors go along x.
        let matched: Vec<(&Walk, Vec<[f64; 2]>)> = walks
            .map(|walk| {
                let places = walk.matched(&walk.packets, &walk.times())?;
                Ok((
                    walk,
                    places.into_iter().map(|place| walk.turn(place)).collect(),
                ))
            })
            .collect::<Result<_>>()?;
        let mut model = Model::AS_PRINTED;
        if !straight {
            // Nothing tells one direction from another.
            model = model.with_acceleration([0.5; 2])?.with_velocity([1.5; 2])?;
        }
        if is_fitted {
            let (mut count, mut squares) = (0.0, [0.0; 2]);
            for (walk, places) in &matched {
                for (place, time) in places.iter().zip(walk.times()) {
                    let truth = walk.turn(walk.truth_at(time));
                    count += 1.0;
                    for axis in 0..2 {
                        squares[axis] += (place[axis] - truth[axis]).powi(2);
                    }
                }
            }
            let deviations = squares.map(|square: f64| (square / count).sqrt() as f32);
            model = model.with_observation(Covariance::diagonal(deviations))?;
        }
        for (walk, places) in &matched {
            for filter_seed in 0..SEEDS {
                let mut rng = Xoshiro128PlusPlus::seed_from_u64(seed << 8 ^ filter_seed);
                let mut cloud = Cloud::<PARTICLES>::new();
                let mut found = Vec::new();
                for (step, place) in places.iter().enumerate() {
                    let place = place.map(|x| x as f32);
                    if step == 0 {
                        cloud.start_around(place, &model, &mut rng)?;
                    } else {
                        cloud.step(2.0, place, &model, &mut rng)?;
                    }
                    let [x, y, ..] = cloud.mean();
                    found.push(walk.turn([x.into(), y.into()]));
                }
                both.push(walk, walk.errors(&walk.times(), &found));
            }
        }
    }
    Ok(both)
}

/// For every set of four receivers, the share of the steps of the straight walks below 2 m.
fn sets_of_four(office: &Office, seed: u64) -> Result<Vec<f64>> {
    let receivers = office.receivers.len();
    let sets: Vec<[usize; 4]> = (0..receivers)
        .flat_map(|a| (a + 1..receivers).map(move |b| (a, b)))
        .flat_map(|(a, b)| (b + 1..receivers).map(move |c| (a, b, c)))
        .flat_map(|(a, b, c)| (c + 1..receivers).map(move |d| [a, b, c, d]))
        .collect();
    let near = |set: &[usize; 4]| -> Result<f64> {
        let (mut count, mut near) = (0.0, 0.0);
        for walk in office.walks.iter().filter(|walk| walk.is_straight) {
            let (packets, times) = (only(&walk.packets, set), walk.times());
            for filter_seed in 0..SEEDS_OF_SETS {
                let seed = seed << 8 ^ filter_seed;
                let places = walk.follow(&packets, &times, Settings::new(), seed)?;
                let errors = walk.errors(&times, &places);
                count += errors.len() as f64;
                near += errors.iter().filter(|error| **error < 2.0).count() as f64;
            }
        }
        Ok(near / count)
    };
    let bar = progress(sets.len() as u64, "sets of four receivers")?;
    sets.par_iter().progress_with(bar).map(near).collect()
}

fn print(rows: &[(&str, &Errors, &Errors)]) {
    let mut table = Table::new();
    table.load_style(ASCII_MARKDOWN).set_header([
        "method",
        "straight: < 2 m",
        "90 % below m",
        "largest m",
        "plane: < 2 m",
        "median m",
        "90 % below m",
        "largest m",
    ]);
    for column in table.column_iter_mut().skip(1) {
        column.set_cell_alignment(CellAlignment::Right);
    }
    for (label, straight, plane) in rows {
        let near = |errors: &Errors| format!("{:.1} %", 100.0 * errors.near().value);
        let quantile = |errors: &Errors, share| format!("{:.2}", errors.quantile(share));
        table.add_row([
            (*label).to_owned(),
            near(straight),
            quantile(straight, 0.9),
            quantile(straight, 1.0),
            near(plane),
            quantile(plane, 0.5),
            quantile(plane, 0.9),
            quantile(plane, 1.0),
        ]);
    }
    println!("{table}");
}

fn draw(rows: &[(&str, &Errors, &Errors)]) -> Result<()> {
    const SHOWN: [usize; 6] = [0, 1, 2, 4, 5, 3];
    let curves = |name: &str, of: &dyn Fn(&(&str, &Errors, &Errors)) -> Errors| Curves {
        title: name.to_owned(),
        horizontal: Axis::linear("error in m"),
        vertical: Axis::linear("% of the steps below"),
        curves: SHOWN
            .iter()
            .map(|row| of(&rows[*row]).curve(rows[*row].0, 6.0))
            .collect(),
    };
    let pictures = [
        curves("Measured walks along corridors", &|row| row.1.clone()),
        curves("Measured walks in the plane", &|row| row.2.clone()),
    ];
    let stem = picture("fingerprint-measured");
    picture::save(&Curves::grid(&pictures, 2)?, &stem)?;
    println!("picture: {}\n", stem.with_extension("svg").display());
    Ok(())
}
