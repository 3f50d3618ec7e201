//! The tracker on the measured walks, with all packets and with faults that it should stand.

use anyhow::Result;
use foxhunt::fingerprint::tracker::{Config, Fix};
use foxhunt_host::walks::{Office, Walk};
use foxhunt_simulation::{random::generator, tunnel::Packet};
use indicatif::ParallelProgressIterator;
use rand::RngExt;
use rayon::prelude::*;

use super::both::Both;
use crate::papers::{fingerprint::coverage::Coverage, study::progress};

/// Filter seeds of every walk, and of every set of four receivers.
pub const SEEDS: u64 = 40;
const SEEDS_OF_SETS: u64 = 4;
/// Receivers that the straight walks do best with, of all sets of four.
pub const FOUR: [usize; 4] = [0, 4, 9, 10];
/// Fraction of the readings that are outliers, and what they then are, in dBm.
const OUTLIERS: f64 = 0.05;
const OUTLIER_DBM: std::ops::Range<f64> = -100.0..-40.0;
/// What a tag reads too strong, in dB.
const OFFSET: f64 = 10.0;

/// What is changed about the packets of a walk, for a seed.
type Change<'a> = &'a (dyn Fn(&[Packet], u64) -> Vec<Packet> + Sync);

/// The tracker's errors, with all packets and with changed ones.
pub struct Tracked {
    pub all: Both,
    /// Whether the regions of each walk held the truth, with all packets.
    pub held: Vec<Coverage>,
    pub four: Both,
    pub louder: Both,
    pub quieter: Both,
    pub outliers: Both,
    /// Without the receiver of each number.
    dead: Vec<Both>,
}

impl Tracked {
    /// Runs all of it.
    pub fn new(office: &Office, seed: u64) -> Result<Self> {
        let receivers = office.receivers.len();
        let bar = progress(receivers as u64 + 5, "measured walks")?;
        let followed = |change: Change<'_>| {
            let followed = follow(office, seed, change);
            bar.inc(1);
            followed
        };
        let tracked = |change: Change<'_>| Ok::<_, anyhow::Error>(errors(&followed(change)?));
        let all = followed(&|packets, _| packets.to_vec())?;
        let by = |offset| tracked(&move |packets, _| changed(packets, |p| p.level += offset));
        let tracked = Self {
            all: errors(&all),
            held: held(&all),
            four: tracked(&|packets, _| only(packets, &FOUR))?,
            louder: by(OFFSET)?,
            quieter: by(-OFFSET)?,
            outliers: tracked(&|packets, filter_seed| {
                let mut rng = generator(seed ^ 9, filter_seed);
                changed(packets, |packet| {
                    if rng.random_bool(OUTLIERS) {
                        packet.level = rng.random_range(OUTLIER_DBM).round();
                    }
                })
            })?,
            dead: (0..receivers)
                .map(|dead| tracked(&move |packets, _| without(packets, dead)))
                .collect::<Result<_>>()?,
        };
        bar.finish_and_clear();
        Ok(tracked)
    }

    /// Without the receiver whose loss is worst on the straight walks, and without that whose loss is worst in the plane;
    /// and their numbers.
    pub fn worst(&self) -> (Both, [usize; 2]) {
        let worst = |p90: &dyn Fn(&Both) -> f64| {
            let dead = 0..self.dead.len();
            let by_error =
                |a: &usize, b: &usize| p90(&self.dead[*a]).total_cmp(&p90(&self.dead[*b]));
            dead.max_by(by_error).expect("there are receivers")
        };
        let straight = worst(&|both| both.straight.quantile(0.9));
        let plane = worst(&|both| both.plane.quantile(0.9));
        let both = Both {
            straight: self.dead[straight].straight.clone(),
            plane: self.dead[plane].plane.clone(),
        };
        (both, [straight, plane])
    }
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

fn without(packets: &[Packet], dead: usize) -> Vec<Packet> {
    let packets = packets.iter().filter(|packet| packet.beacon != dead);
    packets.copied().collect()
}

/// What the tracker knows at each step of every walk, with every seed.
fn follow<'a>(
    office: &'a Office,
    seed: u64,
    change: Change<'_>,
) -> Result<Vec<(&'a Walk, Vec<Fix>)>> {
    let jobs: Vec<(usize, u64)> = (0..office.walks.len())
        .flat_map(|walk| (0..SEEDS).map(move |seed| (walk, seed)))
        .collect();
    jobs.par_iter()
        .map(|(number, filter_seed)| {
            let walk = &office.walks[*number];
            let packets = change(&walk.packets, *number as u64 * SEEDS + filter_seed);
            let seed = seed << 8 ^ filter_seed;
            let fixes = walk.fixes(&packets, &walk.times(), Config::DEFAULT, seed)?;
            Ok((walk, fixes))
        })
        .collect()
}

/// The errors of these places.
fn errors(followed: &[(&Walk, Vec<Fix>)]) -> Both {
    let mut both = Both::default();
    for (walk, fixes) in followed {
        let places: Vec<[f64; 2]> = fixes
            .iter()
            .map(|fix| fix.position.map(f64::from))
            .collect();
        both.push(walk, walk.errors(&walk.times(), &places));
    }
    both
}

/// Whether the regions of each walk held the truth.
fn held(followed: &[(&Walk, Vec<Fix>)]) -> Vec<Coverage> {
    let of_walk = |seeds: &[(&Walk, Vec<Fix>)]| {
        let mut coverage = Coverage::default();
        for (walk, fixes) in seeds {
            let times = walk.times();
            let holds = fixes.iter().zip(&times).map(|(fix, time)| {
                let truth = walk.truth_at(*time).map(|c| c as f32);
                fix.contains(truth, 0.95)
            });
            coverage.push(holds.collect());
        }
        coverage
    };
    followed.chunks(SEEDS as usize).map(of_walk).collect()
}

/// For every set of four receivers, the fraction of the steps of the straight walks below 2 m.
pub fn sets_of_four(office: &Office, seed: u64) -> Result<Vec<f64>> {
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
                let places = walk.follow(&packets, &times, Config::DEFAULT, seed)?;
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
