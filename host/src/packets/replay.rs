//! A stream of bytes through the gateway of the firmware, on the host.

use anyhow::Result;
use foxhunt::{
    fingerprint::{RadioMap, tracker::Site},
    gateway::beacon::{BeaconGateway, Config, Event, Framing},
};

use super::Scene;

/// The gateway of the firmware `beacon_gateway`, with as many tags and particles, and room for larger maps.
pub type Gateway = BeaconGateway<8, 300, 4096, 16>;

/// A gateway and all that it has said so far.
#[derive(Debug)]
pub struct Replay<'a> {
    gateway: Box<Gateway>,
    config: Config<'a>,
    output: Vec<u8>,
    events: Vec<Event>,
}

impl<'a> Replay<'a> {
    /// Configured as the firmware.
    ///
    /// # Errors
    /// When the scene has no map of moments, or one that is too large.
    pub fn new(scene: &'a Scene, framing: Framing) -> Result<Self> {
        let map = RadioMap::new(&scene.map)?.limited(4096, 16)?;
        let site = Site::new(map, scene.walks.config())?;
        Ok(Self {
            gateway: Box::new(Gateway::EMPTY),
            config: Config {
                framing,
                ..Config::new(site)
            },
            output: Vec::new(),
            events: Vec::new(),
        })
    }

    /// Lets the gateway read on.
    pub fn push(&mut self, bytes: &[u8]) {
        for byte in bytes {
            if let Some(event) = self.gateway.push(*byte, &self.config) {
                self.output
                    .extend_from_slice(self.gateway.report().as_bytes());
                self.events.push(event);
            }
        }
    }

    /// The reports: to the last byte what the firmware sends.
    pub fn output(&self) -> &[u8] {
        &self.output
    }

    /// What the messages led to, in their order.
    pub fn events(&self) -> &[Event] {
        &self.events
    }

    /// The places of the particles of a tag, in metres; none if it has no fix.
    pub fn particles(&self, tag: u32) -> Vec<[f64; 2]> {
        let mut trackers = self.gateway.tags();
        let Some((_, tracker)) = trackers.find(|(known, _)| *known == tag) else {
            return Vec::new();
        };
        let particles = tracker.particles(&self.config.site);
        particles.map(|[x, y, ..]| [x, y].map(f64::from)).collect()
    }
}
