//! The office floor of [`crate::tetam`], with its radio maps.

use std::path::Path;

use anyhow::{Context, Result, ensure};
use foxhunt::fingerprint::{
    Config, Lattice, Matcher, Posterior, RadioMap, Reading,
    tracker::{self, Fix, Site},
};

use super::{POINTS, fixes};
use crate::{
    radio_map::{Choices, Made, Recipe, SiteSurvey},
    tetam,
};
use foxhunt_simulation::tunnel::Packet;

/// The survey of the data set, and all of its walks.
#[derive(Debug, Clone)]
pub struct Office {
    /// Places of the receivers, in metres.
    pub receivers: Vec<[f64; 2]>,
    /// The readings that maps are made of.
    pub survey: SiteSurvey,
    /// The walks, the straight ones first.
    pub walks: Vec<Walk>,
}

/// A walk, and the map that it is tracked on.
#[derive(Debug, Clone)]
pub struct Walk {
    /// Its name in the data set.
    pub name: String,
    /// What was heard, in order of time; the "beacon" is the receiver.
    pub packets: Vec<Packet>,
    /// Where the tag was at each packet, in metres.
    pub truth: Vec<[f64; 2]>,
    /// Whether it keeps to a corridor, whose map is one row or one column along its middle.
    pub is_straight: bool,
    /// How its map was made.
    pub choices: Choices,
    /// By point of the map, the error of a look that is expected there, in metres.
    pub expected_m: Vec<f64>,
    map: Vec<u8>,
}

/// Seconds from one estimate to the next, and from the first packet to the first estimate.
const EVERY: f64 = 2.0;
/// A walk that does not leave a strip so wide, in metres, keeps to a corridor.
const CORRIDOR: f64 = 1.0;

impl Office {
    /// Reads the data set in `directory`, and makes the maps, with points every metre.
    ///
    /// # Errors
    /// If a file is missing or damaged.
    pub fn open(directory: &Path) -> Result<Self> {
        let survey = tetam::survey(directory)?;
        let receivers = tetam::receivers(directory)?;
        let mut office = Self {
            survey: SiteSurvey::of(&survey, &numbers(&receivers)),
            receivers,
            walks: Vec::new(),
        };
        let walks: Vec<Walk> = tetam::WALKS
            .iter()
            .map(|name| office.walk(directory, name))
            .collect::<Result<_>>()?;
        office.walks = walks;
        Ok(office)
    }

    /// How well the maps predict places that are left out with their neighbours, in dB.
    pub fn left_out_db(&self) -> f64 {
        let first = self.walks.first();
        first.map_or(f64::NAN, |walk| walk.choices.left_out_db)
    }

    /// A map of the survey on a lattice.
    ///
    /// # Errors
    /// If none can be made.
    pub fn map(&self, lattice: Lattice) -> Result<Made> {
        let receivers = self.receivers.iter().copied();
        let recipe = Recipe {
            sources: numbers(&self.receivers)
                .into_iter()
                .zip(receivers)
                .collect(),
            ..Recipe::on(lattice)
        };
        self.survey.map(&recipe, &mut |_| ())
    }

    /// Any walk of the data set in `directory`, with its map: of the corridor that it keeps to, or of the floor.
    ///
    /// # Errors
    /// If there is no such walk.
    pub fn walk(&self, directory: &Path, name: &str) -> Result<Walk> {
        let tetam::Walk { packets, truth } = tetam::walk(directory, name)?;
        let (lattice, is_straight) = lattice(&truth)?;
        let made = self.map(lattice)?;
        Ok(Walk {
            name: name.to_owned(),
            packets,
            truth,
            is_straight,
            choices: made.choices,
            expected_m: made.expected.by_point_m,
            map: made.bytes,
        })
    }
}

/// Where a walk is tracked: along the corridor that it keeps to, or on the whole floor; and whether it keeps to one.
pub(crate) fn lattice(truth: &[[f64; 2]]) -> Result<(Lattice, bool)> {
    ensure!(!truth.is_empty(), "the walk has no packets");
    let [x, y] = [0, 1].map(|axis| {
        let along = truth.iter().map(|place| place[axis]);
        let least = along.clone().fold(f64::INFINITY, f64::min);
        let most = along.fold(f64::NEG_INFINITY, f64::max);
        (0.5 * (least + most), most - least)
    });
    let lattice = if y.1 < CORRIDOR {
        Lattice::new([-0.2, y.0 as f32], 1.0, 22, 1)
    } else if x.1 < CORRIDOR {
        Lattice::new([x.0 as f32, -0.5], 1.0, 1, 20)
    } else {
        Lattice::new([-0.25, -0.5], 1.0, 22, 20)
    }?;
    Ok((lattice, y.1.min(x.1) < CORRIDOR))
}

fn numbers(receivers: &[[f64; 2]]) -> Vec<u32> {
    (0..receivers.len() as u32).collect()
}

impl Walk {
    /// The map.
    ///
    /// # Errors
    /// Never: it was made by the same program.
    pub fn map(&self) -> Result<RadioMap<'_>> {
        RadioMap::new(&self.map).context("the bytes of its own map are not valid")
    }

    /// A place with x along the corridor, if the walk keeps to one that goes along y; and the other way round.
    pub fn turn(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        let is_column = RadioMap::new(&self.map).is_ok_and(|map| map.lattice().columns() == 1);
        if is_column { [y, x] } else { [x, y] }
    }

    /// When the tag's place is asked for: every 2 s, from 2 s after the first packet.
    pub fn times(&self) -> Vec<f64> {
        let [first, last] = [self.packets.first(), self.packets.last()]
            .map(|packet| packet.map_or(0.0, |packet| packet.time));
        let steps = ((last - first) / EVERY) as usize;
        (1..=steps)
            .map(|step| first + EVERY * step as f64)
            .collect()
    }

    /// Where the tag was at a time: at the last packet before it.
    pub fn truth_at(&self, time: f64) -> [f64; 2] {
        let packet = self.packets.partition_point(|packet| packet.time < time);
        self.truth[packet.saturating_sub(1)]
    }

    /// What the tracker knew at each of `times`, by `packets`, which may be others than its own.
    ///
    /// # Errors
    /// If a packet is refused.
    pub fn fixes(
        &self,
        packets: &[Packet],
        times: &[f64],
        config: tracker::Config,
        seed: u64,
    ) -> Result<Vec<Fix>> {
        fixes(&Site::new(self.map()?, config)?, packets, times, seed)
    }

    /// Where the tracker thinks the tag was at each of `times`, by `packets`, which may be others than its own.
    ///
    /// # Errors
    /// If a packet is refused.
    pub fn follow(
        &self,
        packets: &[Packet],
        times: &[f64],
        config: tracker::Config,
        seed: u64,
    ) -> Result<Vec<[f64; 2]>> {
        let fixes = self.fixes(packets, times, config, seed)?;
        Ok(fixes
            .into_iter()
            .map(|fix| fix.position.map(f64::from))
            .collect())
    }

    /// Where a matcher with Gaussian levels puts the packets of the last 2 s before each of `times`: the mean over the
    /// posterior.
    ///
    /// # Errors
    /// If nothing can be said.
    pub fn matched(&self, packets: &[Packet], times: &[f64]) -> Result<Vec<[f64; 2]>> {
        let matcher = Matcher::new(self.map()?, &Config::DEFAULT)?;
        let mut posterior = Posterior::<POINTS>::EMPTY;
        let mut at = |time: &f64| {
            let beacons = self.map()?.beacons();
            let scan = mean_levels(packets, beacons, time - EVERY..*time, &Config::DEFAULT);
            let found = matcher.locate(&scan, &mut posterior)?;
            Ok(found.mean.map(f64::from))
        };
        times.iter().map(&mut at).collect()
    }

    /// The distances of places from where the tag was at `times`, in metres.
    pub fn errors(&self, times: &[f64], places: &[[f64; 2]]) -> Vec<f64> {
        let error = |(place, time): (&[f64; 2], &f64)| {
            let truth = self.truth_at(*time);
            (place[0] - truth[0]).hypot(place[1] - truth[1])
        };
        places.iter().zip(times).map(error).collect()
    }
}

fn mean_levels(
    packets: &[Packet],
    beacons: usize,
    times: std::ops::Range<f64>,
    config: &Config,
) -> Vec<Reading> {
    let mut sums = vec![(0.0, 0.0); beacons];
    let [lowest, highest] = config.range_dbm;
    let range = f64::from(lowest)..=f64::from(highest);
    for packet in packets {
        if times.contains(&packet.time) && range.contains(&packet.level) {
            let (count, sum) = &mut sums[packet.beacon];
            *count += 1.0;
            *sum += packet.level;
        }
    }
    let reading = |(beacon, (count, sum)): (usize, (f64, f64))| {
        (count > 0.0).then(|| Reading {
            beacon: beacon as u8,
            rssi_dbm: (sum / count) as f32,
        })
    };
    sums.into_iter().enumerate().filter_map(reading).collect()
}
