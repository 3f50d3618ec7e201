//! A stream of bytes through the gateway of the firmware, on the host.

use anyhow::Result;
use foxhunt::{
    fingerprint::{RadioMap, tracker::Site},
    gateway::beacon::{BeaconGateway, Config, Event, Framing},
};

use super::Scene;

/// The gateway of the firmware `beacon_gateway`, with as many tags and particles, and room for larger maps, of so many axes.
pub type Gateway<const D: usize> = BeaconGateway<64, 300, 4096, 16, D>;

/// The gateway for a map.
#[derive(Debug)]
enum ForMap {
    Line(Box<Gateway<1>>),
    Plane(Box<Gateway<2>>),
}

/// A gateway and all that it has said so far.
#[derive(Debug)]
pub struct Replay<'a> {
    gateway: ForMap,
    config: Config<Site<'a>>,
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
            gateway: match map.lattice().axes() {
                1 => ForMap::Line(Box::new(Gateway::EMPTY)),
                _ => ForMap::Plane(Box::new(Gateway::EMPTY)),
            },
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
            let (event, report) = match &mut self.gateway {
                ForMap::Line(gateway) => (gateway.push(*byte, &self.config), gateway.report()),
                ForMap::Plane(gateway) => (gateway.push(*byte, &self.config), gateway.report()),
            };
            if let Some(event) = event {
                self.output.extend_from_slice(report.as_bytes());
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
        match &self.gateway {
            ForMap::Line(gateway) => particles(gateway, tag, &self.config.site),
            ForMap::Plane(gateway) => particles(gateway, tag, &self.config.site),
        }
    }
}

fn particles<const D: usize>(gateway: &Gateway<D>, tag: u32, site: &Site<'_>) -> Vec<[f64; 2]> {
    let mut trackers = gateway.tags();
    let Some((_, tracker)) = trackers.find(|(known, _)| *known == tag) else {
        return Vec::new();
    };
    let particles = tracker.particles(site);
    particles.map(|[x, y, ..]| [x, y].map(f64::from)).collect()
}
