//! Somebody who walks among fixed arrays in a room, each with a bias of its own.

use rand::{Rng, RngExt};

use crate::stations::Stations;
use foxhunt_simulation::{
    Sight,
    random::normal,
    sight::{direction, wrap},
};

/// A way that is straight is so much longer than until a turn: a velocity is kept for so many times as long.
const STRAIGHTNESS: f64 = 20.0;

/// How somebody walks: stands or goes nearly straight on, and turns now and then.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Walker {
    /// Root mean square of the speed, in metres a second.
    pub speed_m_s: f64,
    /// Mean time of standing, in seconds.
    pub standing_s: f64,
    /// Mean time of walking, in seconds.
    pub walking_s: f64,
    /// Mean time of walking straight on, in seconds.
    pub straight_s: f64,
}

/// Where somebody is, and how he moves.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Gait {
    /// In metres.
    pub position: [f64; 2],
    /// In metres a second; `None` while he stands.
    pub velocity: Option<[f64; 2]>,
}

/// A walk, as the arrays heard it.
#[derive(Debug, Clone, PartialEq)]
pub struct Walk {
    /// Where the tag was at every round of readings.
    pub tag: Vec<[f64; 2]>,
    /// The readings of each round in the order of time, each with the number of its array.
    pub sights: Vec<(u8, Sight)>,
}

impl Walker {
    /// Somebody who is anywhere in the room, half a metre from the walls.
    pub fn start(&self, rng: &mut impl Rng) -> Gait {
        self.start_within(-0.5, rng)
    }

    /// The same as far as a distance outside the walls.
    pub(crate) fn start_within(&self, margin: f64, rng: &mut impl Rng) -> Gait {
        let walks = rng.random_bool(self.walking_s / (self.walking_s + self.standing_s));
        let mut within = |side: f64| rng.random_range(-margin..side + margin);
        Gait {
            position: [within(12.0), within(6.0)],
            velocity: walks.then(|| self.velocity(rng)),
        }
    }

    fn velocity(&self, rng: &mut impl Rng) -> [f64; 2] {
        let sigma = self.speed_m_s * std::f64::consts::FRAC_1_SQRT_2;
        [sigma * normal(rng), sigma * normal(rng)]
    }

    /// Moves on for some seconds, few beside the times between events.
    pub fn advance(&self, gait: &mut Gait, seconds: f64, rng: &mut impl Rng) {
        let mut happens = |mean_s: f64| rng.random::<f64>() < -(-seconds / mean_s).exp_m1();
        let (stops, turns) = match gait.velocity {
            None => (false, happens(self.standing_s)),
            Some(_) => (happens(self.walking_s), happens(self.straight_s)),
        };
        if stops {
            gait.velocity = None;
        } else if turns {
            gait.velocity = Some(self.velocity(rng));
        }
        let keep = (-seconds / (STRAIGHTNESS * self.straight_s)).exp();
        let kick = (1.0 - keep * keep).sqrt();
        if let Some(velocity) = &mut gait.velocity {
            let fresh = self.velocity(rng);
            for ((x, v), w) in gait.position.iter_mut().zip(velocity).zip(fresh) {
                let before = *v;
                *v = keep * before + kick * w;
                *x += 0.5 * seconds * (before + *v);
            }
        }
    }

    /// The same within the room: who comes to a wall turns.
    fn advance_within(&self, gait: &mut Gait, seconds: f64, rng: &mut impl Rng) {
        let before = *gait;
        self.advance(gait, seconds, rng);
        while !is_within(gait.position) {
            *gait = Gait {
                velocity: Some(self.velocity(rng)),
                ..before
            };
            let [u, v] = gait.velocity.unwrap_or_default();
            gait.position[0] += seconds * u;
            gait.position[1] += seconds * v;
        }
    }

    /// A walk that arrays hear in rounds, of one reading of each.
    pub fn walk(&self, stations: &Stations, interval_s: f64, rng: &mut impl Rng) -> Walk {
        let correlation = (-interval_s / stations.time_s).exp();
        let biases = Stations::PLACES.map(|_| stations.bias_sigma * normal(rng));
        let mut errors = Stations::PLACES.map(|_| normal(rng));
        let mut gait = self.start(rng);
        let mut walk = Walk {
            tag: Vec::new(),
            sights: Vec::new(),
        };
        for round in 0..stations.readings {
            if round > 0 {
                self.advance_within(&mut gait, interval_s, rng);
                let kick = (1.0 - correlation * correlation).sqrt();
                errors = errors.map(|error| correlation * error + kick * normal(rng));
            }
            walk.tag.push(gait.position);
            for (k, position) in Stations::PLACES.into_iter().enumerate() {
                let error = biases[k] + stations.sigma * errors[k];
                let sight = Sight {
                    time_ms: (1e3 * interval_s) as u32 * round as u32 + k as u32,
                    position,
                    bearing: wrap(direction(position, gait.position) + error),
                    sigma: stations.sigma,
                };
                walk.sights.push((k as u8, sight));
            }
        }
        walk
    }
}

fn is_within([x, y]: [f64; 2]) -> bool {
    (0.5..11.5).contains(&x) && (0.5..5.5).contains(&y)
}
