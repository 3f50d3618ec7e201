//! The office floor of [`crate::tetam`], with its radio maps.

use std::path::Path;

use anyhow::{Context, Result};
use foxhunt::fingerprint::{
    Config, Encoding, Lattice, Matcher, Posterior, RadioMap, Reading,
    tracker::{self, Site},
};

use super::{POINTS, follow};
use crate::{
    radio_map::{Options, SiteSurvey},
    survey::Survey,
    tetam,
    tunnel::Packet,
};

/// All walks of the data set.
#[derive(Debug, Clone)]
pub struct Office {
    /// Places of the receivers, in metres.
    pub receivers: Vec<[f64; 2]>,
    /// The walks, the straight ones first.
    pub walks: Vec<Walk>,
    /// The survey's error between its places, in dB: see [`SiteSurvey::left_out`].
    pub left_out_db: f64,
}

/// A walk, and the map that it is tracked on.
#[derive(Debug, Clone)]
pub struct Walk {
    /// Its name in the data set.
    pub name: &'static str,
    /// What was heard, in order of time; the "beacon" is the receiver.
    pub packets: Vec<Packet>,
    /// Where the tag was at each packet, in metres.
    pub truth: Vec<[f64; 2]>,
    /// Whether it keeps to a corridor, whose map is one row along its middle.
    pub is_straight: bool,
    /// Whether the map has x and y exchanged: its row goes north.
    turned: bool,
    map: Vec<u8>,
}

/// Seconds from one estimate to the next, and from the first packet to the first estimate.
const EVERY: f64 = 2.0;
/// Metres within which places count as surveyed: all of the floor does.
const REACH: f64 = 10.0;

impl Office {
    /// Reads the data set in `directory`, and makes the maps, with points every metre.
    ///
    /// # Errors
    /// If a file is missing or damaged.
    pub fn open(directory: &Path) -> Result<Self> {
        let receivers = tetam::receivers(directory)?;
        let survey = tetam::survey(directory)?;
        let plane = map_of(
            &survey,
            &receivers,
            Lattice::new([-0.25, -0.5], 1.0, 22, 20)?,
        )?;
        let straight = |south: f32| -> Result<_> {
            map_of(
                &survey,
                &receivers,
                Lattice::new([-0.2, south], 1.0, 22, 1)?,
            )
        };
        let turn = |places: &[[f64; 2]]| places.iter().map(|&[x, y]| [y, x]).collect();
        let turned = Survey {
            places: turn(&survey.places),
            ..survey.clone()
        };
        let turned_receivers: Vec<[f64; 2]> = turn(&receivers);
        let north = map_of(
            &turned,
            &turned_receivers,
            Lattice::new([-0.5, 11.5], 1.0, 20, 1)?,
        )?;
        let maps = [
            straight(8.46)?,
            straight(4.36)?,
            north,
            plane.clone(),
            plane,
        ];
        let walks = tetam::WALKS.into_iter().zip(maps).enumerate();
        let walk = |(number, (name, map)): (usize, (&'static str, Vec<u8>))| {
            let walk = tetam::walk(directory, name)?;
            Ok(Walk {
                name,
                packets: walk.packets,
                truth: walk.truth,
                is_straight: number < 3,
                turned: number == 2,
                map,
            })
        };
        let site = SiteSurvey::of(&survey, &numbers(&receivers));
        Ok(Self {
            walks: walks.map(walk).collect::<Result<_>>()?,
            left_out_db: site.left_out(&options(&receivers)),
            receivers,
        })
    }
}

fn numbers(receivers: &[[f64; 2]]) -> Vec<u32> {
    (0..receivers.len() as u32).collect()
}

fn options(receivers: &[[f64; 2]]) -> Options {
    Options {
        reach: Some(REACH),
        sources: numbers(receivers)
            .into_iter()
            .zip(receivers.iter().copied())
            .collect(),
        ..Options::default()
    }
}

fn map_of(survey: &Survey, receivers: &[[f64; 2]], lattice: Lattice) -> Result<Vec<u8>> {
    let site = SiteSurvey::of(survey, &numbers(receivers));
    site.radio_map(&lattice, Encoding::Moments, &options(receivers))
}

impl Walk {
    /// The map: in its frame, not in that of the truth.
    ///
    /// # Errors
    /// Never: it was made by the same program.
    pub fn map(&self) -> Result<RadioMap<'_>> {
        RadioMap::new(&self.map).context("the bytes of its own map are not valid")
    }

    /// A place of the map's frame in that of the truth, and the other way round.
    pub fn turn(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        if self.turned { [y, x] } else { [x, y] }
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
        let site = Site::new(self.map()?, config)?;
        let places = follow(&site, packets, times, seed)?;
        Ok(places.into_iter().map(|place| self.turn(place)).collect())
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
            Ok(self.turn(found.mean.map(f64::from)))
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
