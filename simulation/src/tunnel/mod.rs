//! A simulated tunnel: beacons on its walls, shadowing, noise, a survey and walks.
//!
//! The tunnel of Cui, Wu, He and Wu (Application Research of Computers 34(5), 2017), 80 by 3.5 metres with
//! four beacons 20 metres apart, with the radio channel that the paper leaves open: a path loss of
//! -40 - 20 log10 d, shadowing that stays in its place and hence is in the survey as well as in the walk,
//! and noise that is new in every packet.

mod shadow;

use alloc::{vec, vec::Vec};

use rand::{Rng, RngExt};

pub use shadow::Shadow;

use crate::{random::normal, survey::Survey};

/// What a tunnel is made of.
#[derive(Debug, Clone)]
pub struct Tunnel {
    /// Metres along x, from zero.
    pub length: f64,
    /// Metres along y, from zero.
    pub width: f64,
    /// Places of the beacons, in metres.
    pub beacons: Vec<[f64; 2]>,
    /// Standard deviation of the shadowing, in dB.
    pub shadowing: f64,
    /// Distance over which the correlation of the shadowing falls to 1 / e, along either axis, in metres.
    pub correlation: f64,
}

impl Default for Tunnel {
    /// The tunnel of the paper.
    fn default() -> Self {
        Self {
            length: 80.0,
            width: 3.5,
            beacons: vec![[10.0, 0.0], [30.0, 3.5], [50.0, 0.0], [70.0, 3.5]],
            shadowing: 4.0,
            correlation: 5.0,
        }
    }
}

/// How a radio hears the beacons.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Radio {
    /// Standard deviation of the noise of a packet, in dB.
    pub noise: f64,
    /// What this radio reads too high, in dB.
    pub offset: f64,
    /// Rate of packets that are lost.
    pub loss: f64,
}

impl Radio {
    /// A radio with noise, and neither offset nor loss.
    pub fn new(noise: f64) -> Self {
        Self {
            noise,
            offset: 0.0,
            loss: 0.0,
        }
    }
}

/// A packet, as it was heard.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Packet {
    /// Seconds since the start of the walk.
    pub time: f64,
    /// Index of the beacon.
    pub beacon: usize,
    /// Whole dBm.
    pub level: f64,
}

/// A tunnel with its shadowing drawn.
#[derive(Debug, Clone)]
pub struct Site {
    /// What it was made of.
    pub tunnel: Tunnel,
    shadows: Vec<Shadow>,
}

impl Tunnel {
    /// Draws the shadowing of every beacon.
    pub fn draw(&self, rng: &mut impl Rng) -> Site {
        let shadow = |_: &[f64; 2]| {
            Shadow::draw(
                [self.length, self.width],
                self.shadowing,
                self.correlation,
                rng,
            )
        };
        Site {
            shadows: self.beacons.iter().map(shadow).collect(),
            tunnel: self.clone(),
        }
    }
}

impl Site {
    /// Level of a beacon at `place` without noise, in dBm.
    pub fn level(&self, beacon: usize, place: [f64; 2]) -> f64 {
        let [x, y] = self.tunnel.beacons[beacon];
        let (east, north) = (place[0] - x, place[1] - y);
        let squared = east * east + north * north + 1.0;
        -40.0 - 10.0 * libm::log10(squared) + self.shadows[beacon].at(place)
    }

    /// One packet of a beacon at `place`, rounded to 1 dB; `None` if it was lost.
    pub fn packet(
        &self,
        beacon: usize,
        place: [f64; 2],
        radio: &Radio,
        rng: &mut impl Rng,
    ) -> Option<f64> {
        if radio.loss > 0.0 && rng.random_bool(radio.loss) {
            return None;
        }
        let level = self.level(beacon, place) + radio.offset + radio.noise * normal(rng);
        Some(libm::round(level))
    }

    /// The mean of up to `packets` packets from every beacon, all at `place`; `None` where all were lost.
    pub fn scan(
        &self,
        place: [f64; 2],
        packets: usize,
        radio: &Radio,
        rng: &mut impl Rng,
    ) -> Vec<Option<f64>> {
        let mean = |beacon| {
            let heard: Vec<f64> = (0..packets)
                .filter_map(|_| self.packet(beacon, place, radio, rng))
                .collect();
            (!heard.is_empty()).then(|| heard.iter().sum::<f64>() / heard.len() as f64)
        };
        (0..self.tunnel.beacons.len()).map(mean).collect()
    }

    /// The packets heard on a walk of `seconds` seconds along `path`, which gives the place at a time, in
    /// order of time.
    ///
    /// Every beacon sends `rate` packets a second: one at a random time in each of its periods.
    pub fn walk(
        &self,
        path: impl Fn(f64) -> [f64; 2],
        seconds: f64,
        rate: f64,
        radio: &Radio,
        rng: &mut impl Rng,
    ) -> Vec<Packet> {
        let mut packets = Vec::new();
        for beacon in 0..self.tunnel.beacons.len() {
            for period in 0..libm::ceil(seconds * rate) as usize {
                let time = (period as f64 + rng.random::<f64>()) / rate;
                if time >= seconds {
                    continue;
                }
                if let Some(level) = self.packet(beacon, path(time), radio, rng) {
                    packets.push(Packet {
                        time,
                        beacon,
                        level,
                    });
                }
            }
        }
        packets.sort_by(|a, b| a.time.total_cmp(&b.time));
        packets
    }

    /// A survey: `samples` readings of every beacon at every place.
    pub fn survey(
        &self,
        places: &[[f64; 2]],
        samples: usize,
        radio: &Radio,
        rng: &mut impl Rng,
    ) -> Survey {
        let mut at = |&place: &[f64; 2]| {
            let mut of = |beacon| {
                (0..samples)
                    .filter_map(|_| self.packet(beacon, place, radio, rng))
                    .collect()
            };
            (0..self.tunnel.beacons.len()).map(&mut of).collect()
        };
        Survey {
            places: places.to_vec(),
            samples: places.iter().map(&mut at).collect(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::generator;

    fn site() -> Site {
        Tunnel::default().draw(&mut generator(1, 0))
    }

    #[test]
    fn levels_fall_with_the_distance() {
        let tunnel = Tunnel {
            shadowing: 0.0,
            ..Tunnel::default()
        };
        let site = tunnel.draw(&mut generator(1, 0));
        // d^2 = 1 at the beacon itself, 100 at sqrt(99) metres along the wall.
        assert!((site.level(0, [10.0, 0.0]) + 40.0).abs() < 1e-12);
        assert!((site.level(0, [10.0 + 99f64.sqrt(), 0.0]) + 60.0).abs() < 1e-9);
    }

    #[test]
    fn a_packet_is_the_level_with_offset_and_noise() {
        let (site, mut rng) = (site(), generator(2, 0));
        let radio = Radio {
            noise: 3.0,
            offset: 10.0,
            loss: 0.25,
        };
        let place = [33.3, 1.2];
        let heard: Vec<f64> = (0..20_000)
            .filter_map(|_| site.packet(2, place, &radio, &mut rng))
            .collect();
        let count = heard.len() as f64;
        // Four standard deviations each: false alarms in 6 of 100,000 seeds.
        assert!((count - 15_000.0).abs() < 4.0 * (20_000.0f64 * 0.25 * 0.75).sqrt());
        let mean = heard.iter().sum::<f64>() / count;
        assert!((mean - 10.0 - site.level(2, place)).abs() < 4.0 * 3.02 / count.sqrt());
        let variance = heard.iter().map(|l| (l - mean).powi(2)).sum::<f64>() / count;
        // Rounding adds a twelfth.
        assert!((variance - 9.0 - 1.0 / 12.0).abs() < 4.0 * 9.1 * (2.0 / count).sqrt());
        assert!(heard.iter().all(|level| level.fract() == 0.0));
    }

    #[test]
    fn a_walk_hears_every_beacon_at_its_rate_and_where_it_is() {
        let (site, mut rng) = (site(), generator(3, 0));
        let path = |time: f64| [2.5 * time, 1.2];
        let radio = Radio::new(0.0);
        let packets = site.walk(path, 32.0, 2.0, &radio, &mut rng);
        assert_eq!(packets.len(), 4 * 64);
        assert!(packets.windows(2).all(|pair| pair[0].time <= pair[1].time));
        for packet in &packets {
            let level = site.level(packet.beacon, path(packet.time));
            assert!((packet.level - level).abs() <= 0.5);
        }
        let lost = Radio { loss: 1.0, ..radio };
        assert!(site.walk(path, 32.0, 2.0, &lost, &mut rng).is_empty());
        assert_eq!(site.scan([1.0, 1.0], 3, &lost, &mut rng), [None; 4]);
    }

    #[test]
    fn one_seed_makes_one_site_and_one_survey() {
        let survey = |seed| {
            let mut rng = generator(seed, 0);
            let site = Tunnel::default().draw(&mut rng);
            let places = [[1.0, 1.75], [2.0, 1.75]];
            site.survey(&places, 5, &Radio::new(2.0), &mut rng).samples
        };
        assert_eq!(survey(7), survey(7));
        assert_ne!(survey(7), survey(8));
        assert_eq!(survey(7).len(), 2);
    }
}
