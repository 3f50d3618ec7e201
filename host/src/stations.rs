//! Fixed arrays in a room, each with a bias of its own, and a tag at rest.

use rand::{Rng, RngExt};

use foxhunt_simulation::{
    Sight,
    random::normal,
    sight::{direction, wrap},
};

/// Four arrays in the middles of the walls of a room of 12 by 6 m, which hear a tag ten times a second.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Stations {
    /// Readings of each array.
    pub readings: usize,
    /// Standard deviation of the bias of each array, in radians.
    pub bias_sigma: f64,
    /// Standard deviation of the error of a reading, in radians.
    pub sigma: f64,
    /// Their errors' correlation falls by a factor of e over this many seconds.
    pub time_s: f64,
}

/// What the arrays heard.
#[derive(Debug, Clone, PartialEq)]
pub struct Heard {
    /// Where the tag is.
    pub tag: [f64; 2],
    /// The readings in the order of time, each with the number of its array.
    pub sights: Vec<(u8, Sight)>,
}

impl Stations {
    /// Where the arrays are.
    pub const PLACES: [[f64; 2]; 4] = [[0.0, 3.0], [6.0, 0.0], [12.0, 3.0], [6.0, 6.0]];

    /// Seconds from one reading of an array to its next.
    const INTERVAL_S: f64 = 0.1;

    /// Of a tag anywhere in the room, half a metre from the walls.
    pub fn hear(&self, rng: &mut impl Rng) -> Heard {
        let tag = [rng.random_range(0.5..11.5), rng.random_range(0.5..5.5)];
        let correlation = self.correlation();
        let biases = Self::PLACES.map(|_| self.bias_sigma * normal(rng));
        let mut errors = Self::PLACES.map(|_| normal(rng));
        let mut sights = Vec::new();
        for reading in 0..self.readings {
            for (k, position) in Self::PLACES.into_iter().enumerate() {
                if reading > 0 {
                    errors[k] = correlation * errors[k]
                        + (1.0 - correlation * correlation).sqrt() * normal(rng);
                }
                let sight = Sight {
                    time_ms: (1e3 * Self::INTERVAL_S) as u32 * reading as u32 + k as u32,
                    position,
                    bearing: wrap(direction(position, tag) + biases[k] + self.sigma * errors[k]),
                    sigma: self.sigma,
                };
                sights.push((k as u8, sight));
            }
        }
        Heard { tag, sights }
    }

    /// One bearing an array, with the sigma of its error: exactly what the readings say of the tag.
    pub fn summary(&self, heard: &Heard) -> Vec<Sight> {
        let correlation = self.correlation();
        let one = |station| {
            let own: Vec<&Sight> = (heard.sights.iter())
                .filter(|(k, _)| *k == station)
                .map(|(_, sight)| sight)
                .collect();
            let first = **own.first()?;
            // The mean of least variance of an autoregression counts its ends more.
            let ends = own.len() - 1;
            let weight = |k| {
                if k == 0 || k == ends {
                    1.0
                } else {
                    1.0 - correlation
                }
            };
            let whole: f64 = (0..=ends).map(weight).sum();
            let turns = own.iter().enumerate();
            let turns = turns.map(|(k, s)| weight(k) * wrap(s.bearing - first.bearing));
            let variance = self.sigma.powi(2) * (1.0 + correlation) / whole;
            let variance = if ends == 0 {
                self.sigma.powi(2)
            } else {
                variance
            };
            Some(Sight {
                bearing: wrap(first.bearing + turns.sum::<f64>() / whole),
                sigma: (self.bias_sigma.powi(2) + variance).sqrt(),
                ..first
            })
        };
        (0..4).filter_map(one).collect()
    }

    /// Of two successive errors of an array.
    fn correlation(&self) -> f64 {
        (-Self::INTERVAL_S / self.time_s).exp()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use foxhunt_simulation::random::generator;

    #[test]
    fn a_summary_is_off_by_as_much_as_it_says() {
        for readings in [1, 2, 30] {
            let stations = Stations {
                readings,
                bias_sigma: 0.01,
                sigma: 0.1,
                time_s: 0.5,
            };
            let (mut square, mut count) = (0.0, 0.0);
            for run in 0..1000 {
                let heard = stations.hear(&mut generator(1, run));
                for sight in stations.summary(&heard) {
                    square += (sight.residual(heard.tag) / sight.sigma).powi(2);
                    count += 1.0;
                }
            }
            // Three standard errors.
            let ratio: f64 = square / count;
            assert!((ratio - 1.0).abs() < 0.067, "{readings}: {ratio}");
        }
    }
}
