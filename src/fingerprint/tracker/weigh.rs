//! Evidence that is no packet: a door, a badge reader, a motion sensor.

use super::fix::seconds;
use super::stored::Grain;
use super::{Fix, Floor, Ground, Stored, Tracker, Workspace};
use crate::error::messages;
use crate::math::larger;
use crate::random::Rng;

/// Why evidence was not used. The tracker is as before.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub enum WeighError {
    /// There is no fix yet, or the last one is a minute old.
    NoFix,
    /// It is older than the last update.
    TooOld,
    /// It makes every place impossible where the tag may be, or a likelihood is infinite.
    Impossible,
    /// The map has more points than there is room for.
    Points,
    /// The map is a plane, and there is room for one axis.
    Axes,
}

messages!(WeighError {
    Self::NoFix => "there is no fix yet, or the last one is a minute old",
    Self::TooOld => "the evidence is older than the last update",
    Self::Impossible => "the evidence makes every place impossible",
    Self::Points => "the map has more points than there is room for",
    Self::Axes => "the map is a plane, and there is room for one axis",
});

impl<const N: usize, const B: usize, const D: usize, S: Stored> Tracker<N, B, D, S> {
    /// Weighs the places of the tag by evidence of another kind, at a time in milliseconds, and returns the fix.
    ///
    /// `ln_likelihood` gives the natural logarithm of how probable the evidence is if the tag is at a place, in metres, on a
    /// floor, up to a constant; minus infinity where it cannot be. Sensors err: let what is improbable be possible, so that a
    /// wrong one is made up for by the next packets. Packets that wait for the end of their window count afterwards.
    ///
    /// ```
    /// # use foxhunt::fingerprint::tracker::{Config, Site, Tracker, Workspace};
    /// # use foxhunt::fingerprint::{RadioMap, Reading};
    /// # use foxhunt::random::{SeedableRng, Xoshiro128PlusPlus};
    /// # static TUNNEL: &[u8] =
    /// #     include_bytes!(concat!(env!("CARGO_MANIFEST_DIR"), "/examples/data/tunnel.map"));
    /// # let site = Site::new(RadioMap::new(TUNNEL)?, Config::TUNNEL)?;
    /// # let mut workspace = Workspace::<300, 81>::EMPTY;
    /// # let mut tracker = Tracker::<300, 4, 1>::EMPTY;
    /// # let mut rng = Xoshiro128PlusPlus::seed_from_u64(1);
    /// # for time_ms in [0, 500] {
    /// #     let packet = Reading { beacon: 0, rssi_dbm: -60.0 };
    /// #     tracker.push(time_ms, packet, &site, &mut workspace, &mut rng)?;
    /// # }
    /// // A badge was read at 20 m; one time in a thousand somebody holds that of a colleague.
    /// let badge = |[x, _]: [f32; 2], _floor| if (x - 20.0).abs() < 1.5 { 0.0 } else { -7.0 };
    /// let fix = tracker.weigh(700, badge, &site, &mut workspace, &mut rng)?;
    /// assert!((fix.position[0] - 20.0).abs() < 2.0);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// See [`WeighError`].
    pub fn weigh<const P: usize, G: Ground<Floor = S::Floor>, R: Rng + ?Sized>(
        &mut self,
        time_ms: u32,
        ln_likelihood: impl Fn([f32; 2], u8) -> f32,
        site: &G,
        workspace: &mut Workspace<N, P, S::Floor>,
        rng: &mut R,
    ) -> Result<Fix, WeighError> {
        let last = self.fix().ok_or(WeighError::NoFix)?;
        let dt = match time_ms.wrapping_sub(last.time_ms) as i32 {
            since @ 0..Self::GAP_MS => seconds(since),
            Self::GAP_MS.. => return Err(WeighError::NoFix),
            _ => return Err(WeighError::TooOld),
        };
        let (config, lattice) = (site.config(), site.lattice());
        if site.points() > P {
            return Err(WeighError::Points);
        }
        if lattice.axes() > S::AXES {
            return Err(WeighError::Axes);
        }
        let dt = larger(dt, 1e-3);
        let grain = Grain::of(lattice, config);
        let variance = self.velocity_variance;
        let moved_m = self.predict(dt, site, &grain, workspace, rng);
        let cloud = &mut workspace.cloud;
        let [x, y] = &cloud.places;
        let places = x.iter().zip(y).zip(&cloud.floors);
        for (weight, ((x, y), floor)) in cloud.weights.iter_mut().zip(places) {
            let said = ln_likelihood(lattice.place_of([*x, *y]), floor.number());
            *weight = if said.is_nan() {
                f32::NEG_INFINITY
            } else {
                said
            };
        }
        cloud.exclude_beyond(lattice);
        self.exclude_walls(site, &grain, workspace);
        let Some(sums) = workspace.cloud.weigh() else {
            self.velocity_variance = variance;
            return Err(WeighError::Impossible);
        };
        self.offset.drift(config, dt);
        let length_m = site.map(self.floor.number()).error_length_m();
        self.memory.fade(dt, moved_m, length_m, config);
        if let Some(redrawn_s) = &mut self.redrawn_s {
            *redrawn_s += dt;
        }
        self.conclude(time_ms, &sums, site, workspace);
        (workspace.cloud).resample(sums.weights, &mut self.particles, &grain, rng);
        Ok(self.fix)
    }
}

#[cfg(test)]
mod tests {
    extern crate std;
    use super::*;
    use crate::fingerprint::tracker::{Config, Site, tests::map};
    use crate::fingerprint::{RadioMap, Reading};
    use crate::random::{SeedableRng, Xoshiro128PlusPlus};
    use crate::snapshot;
    use std::vec::Vec;

    type Tag = Tracker<200, 4>;

    fn saved(tag: &Tag) -> Vec<u8> {
        let mut buffer = std::vec![0; snapshot::largest::<Tag>()];
        snapshot::save(tag, &mut buffer).unwrap().to_vec()
    }

    #[test]
    fn what_was_refused_changes_nothing_and_what_was_not_moves_the_fix() {
        let bytes = map(1);
        let site = Site::new(RadioMap::new(&bytes).unwrap(), Config::DEFAULT).unwrap();
        let mut rng = Xoshiro128PlusPlus::seed_from_u64(5);
        let mut room = Workspace::<200, 64>::EMPTY;
        let mut tag = Tag::EMPTY;
        let anywhere = |_: [f32; 2], _| 0.0;
        assert_eq!(
            tag.weigh(5, anywhere, &site, &mut room, &mut rng),
            Err(WeighError::NoFix)
        );
        for time_ms in [0, 300, 600] {
            for beacon in 0..4 {
                let packet = Reading {
                    beacon,
                    rssi_dbm: -65.0,
                };
                tag.push(time_ms, packet, &site, &mut room, &mut rng)
                    .unwrap();
            }
        }
        let before = saved(&tag);
        let time_ms = tag.fix().unwrap().time_ms;
        for (time_ms, said, reason) in [
            (time_ms - 1, 0.0, WeighError::TooOld),
            (time_ms + 60_000, 0.0, WeighError::NoFix),
            (time_ms + 100, f32::NAN, WeighError::Impossible),
            (time_ms + 100, f32::NEG_INFINITY, WeighError::Impossible),
            (time_ms + 100, f32::INFINITY, WeighError::Impossible),
        ] {
            let refused = tag.weigh(time_ms, |_, _| said, &site, &mut room, &mut rng);
            assert_eq!(refused, Err(reason), "{said}");
            assert_eq!(saved(&tag), before);
        }
        let mut small = Workspace::<200, 40>::EMPTY;
        let refused = tag.weigh(time_ms, anywhere, &site, &mut small, &mut rng);
        assert_eq!(refused, Err(WeighError::Points));
        let place = tag.fix().unwrap().position[0] + tag.fix().unwrap().sigma_m();
        let door = |[x, _]: [f32; 2], _| -2.0 * (x - place) * (x - place);
        let fix = tag.weigh(700, door, &site, &mut room, &mut rng).unwrap();
        assert!((fix.position[0] - place).abs() < 0.5, "{fix:?}");
        assert_eq!((fix.time_ms, Some(fix)), (700, tag.fix()));
    }

    #[test]
    fn evidence_of_a_plane_is_refused_on_a_line() {
        let (line, plane) = (map(1), map(2));
        let [line, plane] = [&line, &plane]
            .map(|bytes| Site::new(RadioMap::new(bytes).unwrap(), Config::DEFAULT).unwrap());
        let mut rng = Xoshiro128PlusPlus::seed_from_u64(5);
        let mut room = Workspace::<200, 82>::EMPTY;
        let mut tag = Tracker::<200, 4, 1>::EMPTY;
        let anywhere = |_: [f32; 2], _| 0.0;
        let packet = Reading {
            beacon: 0,
            rssi_dbm: -65.0,
        };
        tag.push(0, packet, &line, &mut room, &mut rng).unwrap();
        tag.flush(&line, &mut room, &mut rng).unwrap();
        let refused = tag.weigh(100, anywhere, &plane, &mut room, &mut rng);
        assert_eq!(refused, Err(WeighError::Axes));
        let used = tag.weigh(100, anywhere, &line, &mut room, &mut rng);
        assert_eq!(used.unwrap().time_ms, 100);
    }
}
