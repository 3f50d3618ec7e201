//! Whether each radio still fits the map, by what it hears of all tags.
//!
//! A radio that was moved, or whose antenna is damaged, hears tags at other levels than the map says where they are. Each
//! region of the map keeps the mean of those differences: a tag at rest, which may be anywhere wrong, counts for one region
//! however long it stays. And of the radios in reach of a tag, the one that the map says is the loudest should hear it at
//! least as often as the others do.

use crate::fingerprint::RadioMap;
use crate::fingerprint::tracker::{Fix, Ground, State};
use crate::math::sqrt;
use crate::persist;
use crate::snapshot::value;

/// Regions of a map: of points that follow each other. Fewer would hear of few places; more, of a few packets each.
const REGIONS: usize = 16;
/// How much a packet counts in the mean of its region: more is noise, less forgets a radio that was put back late.
const GAIN: f32 = 1.0 / 16.0;
/// Differences count up to so many sigmas: further away is an outlier, or a tag that was lost.
const MOST_SIGMAS: f32 = 8.0;
/// Units of a mean in a sigma.
const UNITS: f32 = 256.0;
/// A radio counts less when the squares of its means add up to the number of its regions and so much more: one in ten does
/// that a right map fits as well as it says. The others then show all the more which one is wrong.
const EXCESS: f32 = 8.0;
/// It is told of when they are so many times the number of regions, of which there are so many at least, and so much more:
/// of right ones among 4 regions one in 500,000 is.
const TIMES: f32 = 4.0;
/// See [`TIMES`].
const MORE: f32 = 16.0;
/// See [`TIMES`].
const LEAST_REGIONS: f32 = 4.0;
/// Packets by which is judged how often the loudest radio hears a tag, and the fraction of its part that is far too few.
const PACKETS: u16 = 512;
/// See [`PACKETS`].
const FAR_TOO_FEW: u32 = 4;
/// A fix says nothing of a packet that is so many milliseconds later.
const LATE_MS: u32 = 2_000;

/// What was found of a radio.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Finding {
    /// Its levels are not those of the map.
    Moved,
    /// They are again.
    Fits,
    /// It hears tags far less often than those that are further away.
    Rare,
    /// No longer.
    Usual,
}

impl Finding {
    /// As it stands in a report.
    pub fn word(self) -> &'static str {
        match self {
            Self::Moved => "MOVED",
            Self::Fits => "FITS",
            Self::Rare => "RARE",
            Self::Usual => "USUAL",
        }
    }
}

/// What is known of a radio.
#[derive(Debug, Clone, Copy)]
struct Radio {
    /// By region, the mean difference from the map.
    means: [i16; REGIONS],
    /// The regions that have one, a bit each.
    seen: u16,
    /// Packets of tags for which it is the loudest, and those of them that it heard.
    all: u16,
    own: u16,
    is_rare: bool,
    is_moved: bool,
}

value!(Radio {
    means,
    seen,
    all,
    own,
    is_rare,
    is_moved
});

impl Radio {
    const EMPTY: Self = Self {
        means: [0; REGIONS],
        seen: 0,
        all: 0,
        own: 0,
        is_rare: false,
        is_moved: false,
    };

    /// Takes a difference in a region, of which so large a variance was expected; sets what it has beyond that.
    fn differ(
        &mut self,
        region: usize,
        (difference, variance): (f32, f32),
        doubt_db2: &mut f32,
    ) -> Option<Finding> {
        let sigmas = (difference / sqrt(variance)).clamp(-MOST_SIGMAS, MOST_SIGMAS);
        let mean = self.means.get_mut(region)?;
        let bit = 1 << region;
        let before = f32::from(*mean);
        // The first ones count as if the map had been right before: a few outliers move no radio.
        *mean = (before + GAIN * (UNITS * sigmas - before)) as i16;
        self.seen |= bit;
        let regions = self.seen.count_ones() as f32;
        let square = |mean: &i16| {
            let sigmas = f32::from(*mean) * (1.0 / UNITS);
            sigmas * sigmas
        };
        let sum: f32 = self.means.iter().map(square).sum();
        let is_doubted = sum > regions + EXCESS;
        *doubt_db2 = if is_doubted {
            variance * sum / regions
        } else {
            0.0
        };
        let is_moved = if self.is_moved {
            is_doubted
        } else {
            sum > TIMES * regions + MORE && regions >= LEAST_REGIONS
        };
        turn(
            &mut self.is_moved,
            is_moved,
            [Finding::Moved, Finding::Fits],
        )
    }

    /// Takes a packet of a tag for which it is the loudest of so many radios.
    fn count(&mut self, is_own: bool, radios: usize) -> Option<Finding> {
        self.all += 1;
        self.own += u16::from(is_own);
        if self.all < PACKETS {
            return None;
        }
        let is_rare = u32::from(self.own) * FAR_TOO_FEW * (radios as u32) < u32::from(self.all);
        (self.all, self.own) = (self.all / 2, self.own / 2);
        turn(&mut self.is_rare, is_rare, [Finding::Rare, Finding::Usual])
    }
}

/// Sets what was found, and says so if it is another: what begins, or what ends.
fn turn(is: &mut bool, now: bool, [begins, ends]: [Finding; 2]) -> Option<Finding> {
    let was = core::mem::replace(is, now);
    (was != now).then_some(if now { begins } else { ends })
}

/// What is known of the radios of a map.
#[derive(Debug)]
pub(super) struct Health<const B: usize> {
    radios: [Radio; B],
    /// By radio, the variance in dB^2 that it has beyond what the map says; 0 while it fits.
    doubts_db2: [f32; B],
}

impl<const B: usize> Health<B> {
    pub const EMPTY: Self = Self {
        radios: [Radio::EMPTY; B],
        doubts_db2: [0.0; B],
    };

    /// Takes a packet that a radio has heard of a tag with a fix, and calls `tell` with what it shows of a radio.
    #[inline(never)]
    pub fn hear(
        &mut self,
        (radio, rssi_dbm): (usize, f32),
        time_ms: u32,
        (fix, floor): (&Fix, u8),
        site: &impl Ground,
        mut tell: impl FnMut(usize, Finding),
    ) {
        let since = time_ms.wrapping_sub(fix.time_ms);
        if fix.state != State::Tracking || since > LATE_MS {
            return;
        }
        let place = fix.position_at(time_ms);
        let map = site.map(floor);
        let point = map.lattice().nearest(place);
        let number = usize::from(floor) * map.lattice().points() + point;
        let region = (number * REGIONS).checked_div(site.points()).unwrap_or(0);
        let mismatch_db = site.config().mismatch_sigma_db;
        if let Some(difference) = difference(radio, rssi_dbm, place, fix, map, mismatch_db)
            && let (Some(of), Some(doubt_db2)) =
                (self.radios.get_mut(radio), self.doubts_db2.get_mut(radio))
            && let Some(finding) = of.differ(region, difference, doubt_db2)
        {
            tell(radio, finding);
        }
        let radios = map.beacons().min(B);
        let loudest = (0..radios)
            .filter_map(|other| Some((other, map.moments(other, point)?.mean_dbm)))
            .fold(
                None,
                |best: Option<(usize, f32)>, (other, mean_dbm)| match best {
                    Some((_, most)) if most >= mean_dbm => best,
                    _ => Some((other, mean_dbm)),
                },
            );
        if let Some((loudest, _)) = loudest
            && let Some(of) = self.radios.get_mut(loudest)
            && let Some(finding) = of.count(loudest == radio, radios)
        {
            tell(loudest, finding);
        }
    }

    /// By radio, the variance in dB^2 that it has beyond what the map says.
    pub fn doubts_db2(&self) -> &[f32] {
        &self.doubts_db2
    }
}

persist!(impl[const B: usize] Health<B> as "Health"(B) { radios, doubts_db2 });

/// How much louder a packet is than the map says at a place, in dB, and the variance that is expected of the mean of many such
/// differences there. None where the radio was not heard in the survey.
fn difference(
    radio: usize,
    rssi_dbm: f32,
    place: [f32; 2],
    fix: &Fix,
    map: &RadioMap<'_>,
    mismatch_db: f32,
) -> Option<(f32, f32)> {
    let at = |place: [f32; 2]| map.moments(radio, map.lattice().nearest(place));
    let there = at(place)?;
    // What the place is wrong by: as the level changes within its sigma.
    let aside = [fix.covariance.xx, fix.covariance.yy].map(sqrt);
    let ends = [-1.0, 1.0].map(|sign| [place[0] + sign * aside[0], place[1] + sign * aside[1]]);
    let change = match ends.map(at) {
        [Some(a), Some(b)] => 0.5 * (a.mean_dbm - b.mean_dbm),
        _ => 0.0,
    };
    let noise = map.noise_db();
    let variance = there.sigma_db * there.sigma_db
        + mismatch_db * mismatch_db
        + change * change
        + 0.5 * GAIN * noise * noise;
    Some((rssi_dbm - fix.offset_db - there.mean_dbm, variance))
}

#[cfg(test)]
mod tests {
    extern crate std;
    use super::*;
    use crate::fingerprint::tracker::tests::{map, seal, turned};
    use crate::fingerprint::tracker::{self, Site};
    use crate::random::{SeedableRng, Xoshiro128PlusPlus, normal};
    use std::vec::Vec;

    fn site(bytes: &[u8]) -> Site<'_> {
        let map = RadioMap::new(bytes).unwrap();
        Site::new(map, tracker::Config::DEFAULT).unwrap()
    }

    fn fix(time_ms: u32, x: f32) -> Fix {
        Fix {
            time_ms,
            state: State::Tracking,
            position: [x, 0.0],
            covariance: [[1.0, 0.0], [0.0, 0.0]].into(),
            velocity: [0.0; 2],
            offset_db: 0.0,
            effective_sample_size: 100.0,
        }
    }

    /// Packets of tags on their way along the tunnel, of which radio 2 is as many metres further east as `shift` says and
    /// hears so many of a hundred.
    fn findings(health: &mut Health<4>, shift: f32, heard: u32) -> Vec<(usize, Finding)> {
        let bytes = map(1);
        let site = site(&bytes);
        let mut rng = Xoshiro128PlusPlus::seed_from_u64(1);
        let mut found = Vec::new();
        for packet in 0..12_000u32 {
            let radio = packet as usize % 4;
            let point = (packet as usize / 100) % 41;
            if radio == 2 && (packet / 4) % 100 >= heard {
                continue;
            }
            let from = if radio == 2 {
                (point as f32 - shift).clamp(0.0, 40.0)
            } else {
                point as f32
            };
            let at = site.map.lattice().nearest([from, 0.0]);
            let rssi = site.map.moments(radio, at).unwrap().mean_dbm + 3.0 * normal(&mut rng);
            let fix = fix(packet, point as f32);
            health.hear((radio, rssi), packet, (&fix, 0), &site, |radio, finding| {
                found.push((radio, finding));
            });
        }
        found
    }

    #[test]
    fn a_radio_that_was_moved_is_found_and_so_is_that_it_was_put_back() {
        let mut health = Health::<4>::EMPTY;
        assert_eq!(findings(&mut health, 0.0, 100), []);
        assert_eq!(findings(&mut health, 20.0, 100), [(2, Finding::Moved)]);
        assert!(health.doubts_db2()[2] > 30.0);
        assert_eq!(health.doubts_db2()[1], 0.0);
        assert_eq!(findings(&mut health, 0.0, 100), [(2, Finding::Fits)]);
        assert_eq!(health.doubts_db2()[2], 0.0);
    }

    #[test]
    fn a_radio_that_hears_little_is_found() {
        let mut health = Health::<4>::EMPTY;
        assert_eq!(findings(&mut health, 0.0, 3), [(2, Finding::Rare)]);
        assert_eq!(findings(&mut health, 0.0, 100), [(2, Finding::Usual)]);
    }

    /// A sigma of 3 dB, a mismatch of 5, noise of 4 of which a 32nd counts, and half of what the level changes in 4 m.
    #[test]
    fn a_difference_is_as_wide_as_the_errors_of_the_map_the_place_and_the_packet() {
        let [along_x, along_y] = [map(1), turned(1)].map(|mut bytes| {
            let first = bytes.len() - 4 - 4 * 41 * 2;
            for pair in bytes[first..first + 41 * 2].as_chunks_mut::<2>().0 {
                pair[0] = 12;
            }
            bytes[42] = 16;
            seal(&mut bytes);
            bytes
        });
        for (bytes, axis) in [(&along_x, 0), (&along_y, 1)] {
            let map = RadioMap::new(bytes).unwrap();
            let mean = |point| map.moments(0, point).unwrap().mean_dbm;
            assert_eq!([mean(18), mean(20), mean(22)], [-66.0, -66.5, -67.5]);
            let mut fix = fix(0, 0.0);
            fix.offset_db = 1.5;
            fix.covariance = [[0.0; 2]; 2].into();
            let variance = [&mut fix.covariance.xx, &mut fix.covariance.yy];
            for (number, variance) in variance.into_iter().enumerate() {
                *variance = if number == axis { 4.0 } else { 0.0 };
            }
            let mut place = [0.0; 2];
            place[axis] = 20.0;
            let found = difference(0, -60.0, place, &fix, &map, 5.0);
            let (difference, variance) = found.unwrap();
            assert_eq!(difference, -60.0 - 1.5 + 66.5);
            let change = 0.5 * (67.5 - 66.0);
            let expected = 9.0 + 25.0 + change * change + 16.0 / 32.0;
            assert!((variance - expected).abs() < 1e-5, "{variance}");
        }
    }

    /// Four times eight regions and 16 more are 48: the squares of eight means of 2.45 sigmas.
    #[test]
    fn a_radio_is_moved_when_the_squares_of_its_means_are_too_many() {
        for (sigmas, is_moved) in [(2.3, false), (2.6, true)] {
            let mut radio = Radio::EMPTY;
            let mut doubt_db2 = 0.0;
            let found = (0..8 * 100)
                .filter_map(|packet| radio.differ(packet % 8, (2.0 * sigmas, 4.0), &mut doubt_db2));
            let expected = is_moved.then_some(Finding::Moved);
            assert!(found.eq(expected), "{sigmas}");
            assert!((doubt_db2 - 4.0 * sigmas * sigmas).abs() < 0.07 * doubt_db2);
        }
        // In three regions it may be the tags.
        let mut radio = Radio::EMPTY;
        let found = (0..300).filter_map(|packet| radio.differ(packet % 3, (80.0, 4.0), &mut 0.0));
        assert_eq!(found.count(), 0);
    }

    #[test]
    fn a_radio_is_rare_by_512_packets() {
        let mut radio = Radio::EMPTY;
        let found = (1..=512).map(|_| radio.count(false, 4));
        let found: Vec<_> = found.collect();
        assert!(found[..511].iter().all(Option::is_none));
        assert_eq!(found[511], Some(Finding::Rare));
        // Half of what was counted still counts: with as many of its own it is no longer so.
        let found: Vec<_> = (0..256).map(|_| radio.count(true, 4)).collect();
        assert!(found[..255].iter().all(Option::is_none));
        assert_eq!(found[255], Some(Finding::Usual));
        let mut radio = Radio::EMPTY;
        let heard = (0..512 + 256).filter_map(|packet| radio.count(packet < 512, 4));
        assert_eq!(heard.count(), 0);
    }

    #[test]
    fn only_a_sure_fix_of_two_seconds_or_less_tells_of_a_radio() {
        let bytes = map(1);
        let site = site(&bytes);
        for (state, late_ms, is_told) in [
            (State::Tracking, 2_000, true),
            (State::Tracking, 2_001, false),
            (State::Tracking, 60_000, false),
            (State::Uncertain, 0, false),
        ] {
            let mut health = Health::<4>::EMPTY;
            let mut told = 0;
            for packet in 0..2_000u32 {
                let point = (packet as usize / 4) % 41;
                let rssi = site.map.moments(1, point).unwrap().mean_dbm + 40.0;
                let mut fix = fix(packet, point as f32);
                fix.state = state;
                let time_ms = packet + late_ms;
                health.hear((1, rssi), time_ms, (&fix, 0), &site, |radio, finding| {
                    told += u32::from((radio, finding) == (1, Finding::Moved));
                });
            }
            assert_eq!(told, u32::from(is_told), "{state:?} {late_ms}");
        }
    }

    #[test]
    fn a_tag_at_rest_moves_no_radio() {
        let bytes = map(1);
        let site = site(&bytes);
        let mut health = Health::<4>::EMPTY;
        for packet in 0..20_000u32 {
            let radio = packet as usize % 4;
            let fix = fix(packet, 20.0);
            let error = if radio == 1 { 40.0 } else { 0.0 };
            let rssi = site.map.moments(radio, 20).unwrap().mean_dbm + error;
            health.hear((radio, rssi), packet, (&fix, 0), &site, |_, _| {
                panic!("told")
            });
        }
    }
}
