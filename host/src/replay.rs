//! A stream of bytes through the gateway of the firmware, on the host.

use foxhunt::{
    aoa::locator::{self, Answer, Fix, Locator, NotObservable},
    gateway::{Event, Settings, Vehicle},
    random::{SeedableRng, Xoshiro128PlusPlus},
    resample::{Scheme, resample},
};

use crate::Sight;

/// The gateway of the firmware `vehicle`, with as many particles and bearings.
pub type Gateway = Vehicle<Locator<200, 64>>;

/// A gateway and all that it has said so far.
#[derive(Debug)]
pub struct Replay {
    gateway: Box<Gateway>,
    output: Vec<u8>,
    events: Vec<Event>,
    sights: Vec<Sight>,
}

impl Default for Replay {
    /// With the settings of the firmware.
    fn default() -> Self {
        Self::new(Settings::default())
    }
}

impl Replay {
    /// A gateway that has read nothing yet.
    pub fn new(settings: Settings) -> Self {
        Self {
            gateway: Box::new(Gateway::new(
                settings,
                Locator::new(locator::Settings::new()),
            )),
            output: Vec::new(),
            events: Vec::new(),
            sights: Vec::new(),
        }
    }

    /// What `bytes` lead to with the settings of the firmware.
    pub fn of(bytes: &[u8]) -> Self {
        let mut replay = Self::default();
        replay.push(bytes);
        replay
    }

    /// Lets the gateway read on.
    pub fn push(&mut self, bytes: &[u8]) {
        for &byte in bytes {
            let Some(event) = self.gateway.push(byte) else {
                continue;
            };
            self.output
                .extend_from_slice(self.gateway.report().as_bytes());
            self.events.push(event);
            match event {
                // A new search, with an origin of its own.
                Event::Restarted
                | Event::NotObservable(NotObservable::TooFewBearings { have: 1 }) => {
                    self.sights.clear();
                }
                _ => {}
            }
            if let Event::Fix(_) | Event::NotObservable(_) = event {
                self.sights
                    .extend(self.gateway.observation().as_ref().map(Sight::from));
            }
        }
    }

    /// The gateway, with its counters and its plane.
    pub fn gateway(&self) -> &Gateway {
        &self.gateway
    }

    /// The reports: to the last byte what the firmware sends.
    pub fn output(&self) -> &[u8] {
        &self.output
    }

    /// What the lines led to, in their order.
    pub fn events(&self) -> &[Event] {
        &self.events
    }

    /// Every bearing that was used since the gateway began its search, in their order.
    pub fn sights(&self) -> &[Sight] {
        &self.sights
    }

    /// Where the source is, if that is known by now.
    pub fn fix(&self) -> Option<Fix> {
        match self.gateway.locator().answer() {
            Answer::Fix(fix) => Some(fix),
            Answer::NotObservable(_) => None,
        }
    }

    /// The cloud, in metres east and north of the origin; none before the first fix. Resampled: each particle is
    /// there as often as its weight says.
    pub fn particles(&self) -> Vec<[f64; 2]> {
        if self.fix().is_none() {
            return Vec::new();
        }
        let locator = self.gateway.locator();
        by_weight(locator.columns(), locator.weights())
    }
}

fn by_weight([east, north]: [&[f32]; 2], weights: &[f32]) -> Vec<[f64; 2]> {
    let mut memory = vec![0.0; weights.len()];
    let mut generator = Xoshiro128PlusPlus::seed_from_u64(1);
    resample(Scheme::Systematic, weights, &mut memory, &mut generator)
        .iter()
        .map(|ancestor| [east[ancestor], north[ancestor]].map(f64::from))
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{drive, geodesy::Place};

    #[test]
    fn the_example_drive_is_located() {
        let drive = drive::example(1);
        let replay = Replay::of(drive.bytes());
        let fix = replay.fix().unwrap();
        assert_eq!(replay.sights().len() as u32, fix.bearings);
        assert_eq!(replay.particles().len(), 200);

        let origin = replay.gateway().plane().unwrap().origin();
        let origin = Place {
            latitude: f64::from(origin.latitude_e7()) * 1e-7,
            longitude: f64::from(origin.longitude_e7()) * 1e-7,
        };
        let truth = origin.local(drive::truth(drive.bytes()).unwrap());
        assert!(
            fix.ellipse(0.9999).contains(truth.map(|v| v as f32)),
            "{fix:?} for a source at {truth:?}"
        );
        for line in std::str::from_utf8(replay.output()).unwrap().lines() {
            assert!(line.starts_with("$PFOX") && line.is_ascii(), "{line}");
        }
    }

    #[test]
    fn a_restart_forgets_the_bearings() {
        let drive = drive::example(1);
        let mut replay = Replay::of(drive.bytes());
        let count = replay.sights().len();
        replay.push(b"$PFOXR*53\r\n");
        assert!(replay.sights().is_empty());
        // What it heard last is fresh still.
        replay.push(b"%010/9\r%020/9\r");
        assert_eq!(replay.sights().len(), 2);
        assert!(count > 2);
    }

    #[test]
    fn a_particle_is_drawn_as_often_as_its_weight_says() {
        let (east, north) = ([1.0, 2.0, 3.0, 4.0], [5.0, 6.0, 7.0, 8.0]);
        let drawn = by_weight([&east, &north], &[0.0, 0.75, 0.0, 0.25]);
        assert_eq!(drawn, [[2.0, 6.0], [2.0, 6.0], [2.0, 6.0], [4.0, 8.0]]);
    }

    #[test]
    fn pieces_make_no_difference() {
        let bytes = drive::example(2);
        let whole = Replay::of(bytes.bytes());
        let mut pieces = Replay::default();
        for piece in bytes.bytes().chunks(7) {
            pieces.push(piece);
        }
        assert_eq!(pieces.output(), whole.output());
        assert_eq!(pieces.events(), whole.events());
    }
}
