//! A log from the field through a vehicle's gateway, as `foxhunt replay` reads it.

use foxhunt::{
    aoa::{Locate, Observation, geodesy::LocalPlane},
    gateway::{Event, FullReport, Gateway, Rejected, formats::All},
};
use foxhunt_gateways::{plain, robust};
use serde::{Deserialize, Serialize};

use crate::{
    known,
    messages::{Answer, Taken},
};

/// What locates.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Options {
    /// Several sources that may move, and bearings that may be outliers, as in the firmware `vehicle_robust`; otherwise one
    /// source at rest, and bearings that are all right, as in `vehicle`.
    pub robust: bool,
}

/// A log that is read piece by piece.
pub struct Log {
    gateway: Box<dyn AnyGateway>,
    plane: Option<LocalPlane>,
    /// Each with the probability that it was an outlier when it was taken.
    observations: Vec<(Observation, Option<f32>)>,
    track: Vec<[f32; 2]>,
}

/// What the bytes so far have led to.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct State {
    /// Where the metres count from: degrees north and east. `None` before the first bearing was used.
    pub origin: Option<[f64; 2]>,
    /// Where the vehicle was, east and north, since its first bearing.
    pub track: Vec<[f32; 2]>,
    /// All bearings that were used since the search began.
    pub bearings: Vec<Taken>,
    /// What the locator knows.
    pub answer: Answer,
    /// How many lines there were.
    pub lines: u32,
    /// How many bearings were used.
    pub used: u32,
    /// Why lines were not used, and how many.
    pub refused: Vec<(String, u32)>,
}

trait AnyGateway: Send {
    fn push(&mut self, byte: u8) -> Option<Event>;
    fn plane(&self) -> Option<LocalPlane>;
    /// The last bearing that was used, and the probability that it is an outlier.
    fn observation(&self) -> Option<(Observation, Option<f32>)>;
    /// Where the vehicle is, in the plane.
    fn place(&self) -> Option<[f32; 2]>;
    fn state(&self, observations: &[(Observation, Option<f32>)]) -> (Vec<Taken>, Answer);
    /// Lines, bearings that were used, and reasons.
    fn counts(&self) -> (u32, u32, Vec<(String, u32)>);
}

impl<L: Locate<Config: Send> + Send> AnyGateway for Gateway<L, All, FullReport> {
    fn push(&mut self, byte: u8) -> Option<Event> {
        self.push(0, byte)
    }

    fn plane(&self) -> Option<LocalPlane> {
        self.vehicle().plane().copied()
    }

    fn observation(&self) -> Option<(Observation, Option<f32>)> {
        let observation = self.vehicle().observation()?;
        let (locator, config) = (self.vehicle().locator(), &self.config().locator);
        Some((observation, known::outlier(&observation, locator, config)))
    }

    fn place(&self) -> Option<[f32; 2]> {
        let place = self.vehicle().place()?;
        self.vehicle().plane()?.to_local(place).ok()
    }

    fn state(&self, observations: &[(Observation, Option<f32>)]) -> (Vec<Taken>, Answer) {
        let (locator, config) = (self.vehicle().locator(), &self.config().locator);
        let taken = observations.iter().enumerate();
        let taken = taken.map(|(id, (observation, then))| {
            known::taken((id, observation), *then, locator, config)
        });
        let here = AnyGateway::place(self).unwrap_or_default();
        (taken.collect(), known::answer(locator, config, here))
    }

    fn counts(&self) -> (u32, u32, Vec<(String, u32)>) {
        let counters = self.vehicle().counters();
        let refused = Rejected::ALL
            .iter()
            .map(|reason| (reason.to_string(), counters.rejected(*reason)))
            .filter(|(_, count)| *count > 0);
        (counters.lines, counters.bearings, refused.collect())
    }
}

/// Metres that a vehicle moves from one place of its track to the next, at least.
const STEP_M: f32 = 2.0;

impl Log {
    /// Before the first byte.
    ///
    /// # Errors
    /// Names what is out of range; the configurations are those of the firmware, and are not.
    pub fn new(options: Options) -> Result<Self, String> {
        let gateway: Box<dyn AnyGateway> = if options.robust {
            let gateway = Gateway::<robust::Locator, All, FullReport>::new(robust::CONFIG);
            Box::new(gateway.map_err(|error| error.to_string())?)
        } else {
            let gateway = Gateway::<plain::Locator, All, FullReport>::new(plain::CONFIG);
            Box::new(gateway.map_err(|error| error.to_string())?)
        };
        Ok(Self {
            gateway,
            plane: None,
            observations: Vec::new(),
            track: Vec::new(),
        })
    }

    /// Reads on.
    pub fn push(&mut self, bytes: &[u8]) {
        for &byte in bytes {
            let Some(event) = self.gateway.push(byte) else {
                continue;
            };
            let plane = self.gateway.plane();
            if plane != self.plane {
                // A new search, with an origin of its own.
                self.plane = plane;
                self.observations.clear();
                self.track.clear();
            }
            if let Event::Fix(_) | Event::NotObservable(_) = event {
                self.observations.extend(self.gateway.observation());
            }
            if let Some(place) = self.gateway.place() {
                self.pass(place);
            }
        }
    }

    /// What all bytes so far have led to.
    pub fn state(&self) -> State {
        let (bearings, answer) = self.gateway.state(&self.observations);
        let (lines, used, refused) = self.gateway.counts();
        State {
            origin: self.plane.map(|plane| {
                let origin = plane.origin();
                [origin.latitude_e7(), origin.longitude_e7()].map(|e7| f64::from(e7) / 1e7)
            }),
            track: self.track.clone(),
            bearings,
            answer,
            lines,
            used,
            refused,
        }
    }

    fn pass(&mut self, [x, y]: [f32; 2]) {
        let is_near = (self.track.last())
            .is_some_and(|[u, v]| (x - u) * (x - u) + (y - v) * (y - v) < STEP_M * STEP_M);
        if !is_near {
            self.track.push([x, y]);
        }
    }
}
