//! A stream of bytes through the gateway of the firmware, on the host.

use foxhunt::{
    ConfigError,
    aoa::{Cloud, Fix, Locate, geodesy::LocalPlane},
    gateway::{Config, Event, FullReport, Gateway, ReportForm, ShortReport, Vehicle, formats::All},
    random::{SeedableRng, Xoshiro128PlusPlus},
    resample::{Scheme, resample},
};

use foxhunt_gateways::plain;

use foxhunt_simulation::Sight;

/// A gateway and all that it has said so far.
#[derive(Debug)]
pub struct Replay<L: Locate = plain::Locator, R = ShortReport> {
    gateway: Box<Gateway<L, All, R>>,
    plane: Option<LocalPlane>,
    output: Vec<u8>,
    events: Vec<Event>,
    sights: Vec<Sight>,
}

/// The most sources that are asked for.
pub(crate) const SOURCES: usize = 16;

impl Default for Replay {
    /// The gateway of the firmware `vehicle`.
    fn default() -> Self {
        Self::new(plain::CONFIG).expect("the firmware's own configuration")
    }
}

impl Replay {
    /// What `bytes` lead to in the firmware `vehicle`.
    pub fn of(bytes: &[u8]) -> Self {
        let mut replay = Self::default();
        replay.push(bytes);
        replay
    }
}

/// A gateway whose reports say all that its locator knows.
pub type FullReplay<L> = Replay<L, FullReport>;

impl<L: Locate, R: ReportForm> Replay<L, R> {
    /// A gateway that has read nothing yet.
    ///
    /// # Errors
    /// Names the field of the configuration that is out of range.
    pub fn new(config: Config<L::Config>) -> Result<Self, ConfigError> {
        Ok(Self {
            gateway: Box::new(Gateway::new(config)?),
            plane: None,
            output: Vec::new(),
            events: Vec::new(),
            sights: Vec::new(),
        })
    }

    /// Lets the gateway read on.
    pub fn push(&mut self, bytes: &[u8]) {
        for &byte in bytes {
            self.step(byte);
        }
    }

    /// Lets the gateway read one byte, and says what it led to.
    pub fn step(&mut self, byte: u8) -> Option<Event> {
        let event = self.gateway.push(0, byte)?;
        let vehicle = self.gateway.vehicle();
        self.output.extend_from_slice(vehicle.report().as_bytes());
        self.events.push(event);
        let plane = vehicle.plane().copied();
        if plane != self.plane {
            // A new search, with an origin of its own.
            self.plane = plane;
            self.sights.clear();
        }
        if let Event::Fix(_) | Event::NotObservable(_) = event {
            self.sights
                .extend(vehicle.observation().as_ref().map(Sight::from));
        }
        Some(event)
    }

    /// The gateway, with its counters and its plane.
    pub fn gateway(&self) -> &Vehicle<L, All, R> {
        self.gateway.vehicle()
    }

    /// What the locator was told.
    pub fn config(&self) -> &L::Config {
        &self.gateway.config().locator
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

    /// Where the source is, if that is known by now; the best known, where there are several.
    pub fn fix(&self) -> Option<Fix> {
        self.gateway().locator().fix()
    }

    /// The clouds of all sources, in metres east and north of the origin; none before the first fix. Resampled: each
    /// particle is there as often as its weight says.
    pub fn particles(&self) -> Vec<[f64; 2]> {
        self.clouds().flat_map(|cloud| by_weight(&cloud)).collect()
    }

    /// The cloud of each source that has a fix.
    pub fn clouds(&self) -> impl Iterator<Item = Cloud<'_>> {
        (0..SOURCES).map_while(|index| self.gateway().locator().cloud(index))
    }
}

/// Its particles, each as often as its weight says.
pub(crate) fn by_weight(cloud: &Cloud<'_>) -> Vec<[f64; 2]> {
    let mut memory = vec![0.0; cloud.weights.len()];
    let mut generator = Xoshiro128PlusPlus::seed_from_u64(1);
    resample(
        Scheme::Systematic,
        cloud.weights,
        &mut memory,
        &mut generator,
    )
    .iter()
    .map(|ancestor| [cloud.east[ancestor], cloud.north[ancestor]].map(f64::from))
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
        let drawn = by_weight(&Cloud {
            east: &east,
            north: &north,
            weights: &[0.0, 0.75, 0.0, 0.25],
        });
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
