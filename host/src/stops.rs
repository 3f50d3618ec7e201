//! A vehicle that stops, and takes many readings at each stop.

use rand::{Rng, RngExt};

use foxhunt_simulation::{
    Sight,
    path::along,
    random::normal,
    sight::{direction, wrap},
};

/// Round a square of 400 m, with a stop every 80 m. What is off at a stop, like its heading or the reflections there, is
/// off in all of its readings.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Stops {
    /// Readings at each stop.
    pub readings: usize,
    /// Standard deviation of the error that all readings of a stop have in common, in radians.
    pub stop_sigma: f64,
    /// Standard deviation of each reading's own error, in radians.
    pub sigma: f64,
}

impl Stops {
    /// Where one source at a time is: within the square, and beyond three of its sides, 100 to 200 m from the road.
    pub const SOURCES: [[f64; 2]; 4] = [
        [150.0, 250.0],
        [500.0, 150.0],
        [200.0, -150.0],
        [250.0, 600.0],
    ];

    /// The places of the stops, in order.
    pub fn places() -> Vec<[f64; 2]> {
        along(
            &[
                [0.0, 0.0],
                [400.0, 0.0],
                [400.0, 400.0],
                [0.0, 400.0],
                [0.0, 0.0],
            ],
            21,
        )
    }

    /// One reading a second, of which each states the sigma of its own error.
    pub fn bearings(&self, source: [f64; 2], rng: &mut impl Rng) -> Vec<Sight> {
        let mut sights = Vec::new();
        for position in Self::places() {
            let common = direction(position, source) + self.stop_sigma * normal(rng);
            for _ in 0..self.readings {
                sights.push(Sight {
                    time_ms: 1000 * sights.len() as u32,
                    position,
                    bearing: wrap(common + self.sigma * normal(rng)),
                    sigma: self.sigma,
                });
            }
        }
        sights
    }

    /// One bearing a stop, with the sigma of its error: exactly what the `sights` say.
    pub fn summary(&self, sights: &[Sight]) -> Vec<Sight> {
        let one = |position| {
            let of_stop: Vec<&Sight> = sights.iter().filter(|s| s.position == position).collect();
            let first = *of_stop.first()?;
            let count = of_stop.len() as f64;
            let turns = of_stop.iter().map(|s| wrap(s.bearing - first.bearing));
            Some(Sight {
                bearing: wrap(first.bearing + turns.sum::<f64>() / count),
                sigma: self.stop_sigma.hypot(self.sigma / count.sqrt()),
                ..*first
            })
        };
        Self::places().into_iter().filter_map(one).collect()
    }
}

/// The same readings in another order, each at the time of that which it takes the place of.
pub fn shuffle(sights: &mut [Sight], rng: &mut impl Rng) {
    let times: Vec<u32> = sights.iter().map(|sight| sight.time_ms).collect();
    for last in (1..sights.len()).rev() {
        sights.swap(last, rng.random_range(0..=last));
    }
    for (sight, time_ms) in sights.iter_mut().zip(times) {
        sight.time_ms = time_ms;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use foxhunt_simulation::random::generator;

    #[test]
    fn a_summary_is_off_by_as_much_as_it_says() {
        let stops = Stops {
            readings: 4,
            stop_sigma: 0.2,
            sigma: 0.3,
        };
        let source = Stops::SOURCES[0];
        let (mut square, mut count) = (0.0, 0.0);
        for run in 0..200 {
            let mut sights = stops.bearings(source, &mut generator(1, run));
            shuffle(&mut sights, &mut generator(2, run));
            assert!(sights.is_sorted_by_key(|sight| sight.time_ms));
            let summary = stops.summary(&sights);
            assert_eq!(summary.len(), 21);
            for sight in summary {
                square += (sight.residual(source) / sight.sigma).powi(2);
                count += 1.0;
            }
        }
        // Three standard errors.
        assert!(
            (square / count - 1.0_f64).abs() < 0.066,
            "{}",
            square / count
        );
    }
}
