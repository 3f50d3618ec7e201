//! Eight people in a tunnel, through the gateway of the tunnel.

use foxhunt::fingerprint::tracker::State as Reliability;
use foxhunt_gateways::tunnel::{Gateway, LINES};
use foxhunt_simulation::{
    path::Path,
    people::{self, EXAMPLE_SEED, Minute},
    random::generator,
    sentence::of_packet,
    tunnel::{Radio, Tunnel},
};
use serde::{Deserialize, Serialize};

use crate::messages::Ellipse;

/// What is simulated in the tunnel whose radio map comes with the project.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Options {
    /// The seed of the packets' noise and losses. That of the recorded minute gives another one: it was drawn after the survey.
    pub seed: u64,
    /// Standard deviation of a packet, in dB.
    pub noise_db: f64,
    /// Rate of packets that are lost.
    pub loss: f64,
    /// Whether the last radio loses its power for a while.
    pub outage: bool,
}

/// A minute that can be gone through to and fro.
pub struct Walkers {
    minute: Minute,
    radios: Vec<[f64; 2]>,
    gateway: Box<Gateway>,
    /// How many packets were heard.
    heard: usize,
}

/// The state at one time.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct State {
    /// Metres along and across.
    pub size: [f64; 2],
    /// Where the radios are.
    pub radios: Vec<[f64; 2]>,
    /// How many packets were heard.
    pub packets: usize,
    /// The tags that have a fix.
    pub tags: Vec<Tag>,
    /// Where everybody is: tag, metres along and across.
    pub truth: Vec<(u32, [f64; 2])>,
}

/// Where a tag is.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Tag {
    /// Its number.
    pub id: u32,
    /// When it was there.
    pub time_ms: u32,
    /// Metres along.
    pub x: f32,
    /// Metres across.
    pub y: f32,
    /// In square metres.
    pub covariance: [f32; 3],
    /// What holds it.
    pub ellipse: Ellipse,
    /// How reliable the place is: `tracking`, `uncertain`, `lost` or `recovered`.
    pub state: &'static str,
    /// By how many dB the tag reads stronger than that of the survey.
    pub offset_db: f32,
    /// The particles, along and across, one after the other.
    pub particles: Vec<f32>,
}

impl Walkers {
    /// At the beginning.
    ///
    /// # Errors
    /// What is out of range, in plain words.
    pub fn new(options: &Options) -> Result<Self, String> {
        if !(0.0..=1.0).contains(&options.loss) {
            return Err("the rate of lost packets is outside 0 to 1".into());
        }
        if !(0.0..=20.0).contains(&options.noise_db) {
            return Err("the noise is outside 0 to 20 dB".into());
        }
        // The tunnel that was surveyed for the map.
        let site = Tunnel::default().draw(&mut generator(EXAMPLE_SEED, 0));
        let radio = Radio {
            noise: options.noise_db,
            loss: options.loss,
            ..people::RADIO
        };
        let outage = if options.outage {
            people::OUTAGE
        } else {
            0.0..0.0
        };
        let minute = Minute::draw(&site, &radio, outage, &mut generator(options.seed, 1));
        Ok(Self {
            minute,
            radios: site.tunnel.beacons,
            gateway: Box::new(Gateway::EMPTY),
            heard: 0,
        })
    }

    /// Goes to a time.
    pub fn seek(&mut self, time_ms: u32) {
        let packets = &self.minute.packets;
        let until = packets.partition_point(|packet| packet.time_ms <= time_ms);
        if until < self.heard {
            *self.gateway = Gateway::EMPTY;
            self.heard = 0;
        }
        for packet in &packets[self.heard..until] {
            for byte in of_packet(packet).bytes() {
                self.gateway.push(byte, &LINES);
            }
        }
        self.heard = until;
    }

    /// What is known at that time.
    pub fn state(&self, time_ms: u32) -> State {
        let seconds = f64::from(time_ms) / 1e3;
        let place = |(tag, path): &(u32, Path)| Some((*tag, path.at(seconds)?));
        let Tunnel { length, width, .. } = Tunnel::default();
        State {
            size: [length, width],
            radios: self.radios.clone(),
            packets: self.heard,
            tags: self.tags(),
            truth: self.minute.ways.iter().filter_map(place).collect(),
        }
    }

    fn tags(&self) -> Vec<Tag> {
        let tags = self.gateway.tags().filter_map(|(id, tracker)| {
            let fix = tracker.fix()?;
            let particles = tracker.particles(&LINES.site);
            Some(Tag {
                id,
                time_ms: fix.time_ms,
                x: fix.position[0],
                y: fix.position[1],
                covariance: [fix.covariance.xx, fix.covariance.xy, fix.covariance.yy],
                ellipse: Ellipse::of(fix.covariance),
                state: match fix.state {
                    Reliability::Tracking => "tracking",
                    Reliability::Lost => "lost",
                    Reliability::Recovered => "recovered",
                    _ => "uncertain",
                },
                offset_db: fix.offset_db,
                particles: particles.flat_map(|[x, y, ..]| [x, y]).collect(),
            })
        });
        let mut tags: Vec<Tag> = tags.collect();
        tags.sort_by_key(|tag| tag.id);
        tags
    }
}
