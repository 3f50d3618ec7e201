//! Several sources at rest on one channel, heard from a vehicle: one stream of readings.

use std::f64::consts::PI;

use rand::{Rng, RngExt, seq::SliceRandom};

use foxhunt_simulation::{
    Sight,
    path::along,
    random::normal,
    sight::{direction, wrap},
};

/// One reading.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Reading {
    /// What a locator gets.
    pub sight: Sight,
    /// The number of the source whose frequency or tag it has. An outlier has one, too.
    pub source: usize,
}

/// How the vehicle goes, and which sources it hears where.
#[derive(Debug, Clone, PartialEq)]
pub struct Channel {
    /// Where the sources are, in metres east and north.
    pub sources: Vec<[f64; 2]>,
    /// Places in the order in which the vehicle comes to them.
    pub places: Vec<[f64; 2]>,
    /// The sources that it hears at each place.
    pub heard: Heard,
    /// Milliseconds from one reading to the next at a place.
    pub interval_ms: u32,
    /// Milliseconds from the last reading of a place to the first one of the next, at least.
    pub way_ms: u32,
    /// Milliseconds from the first reading of a place to the first one of the next, at least.
    pub every_ms: u32,
    /// Standard deviation of each reading's own error, in radians: what it states.
    pub sigma: f64,
    /// Standard deviation of the error that all readings of a place have in common, whatever their source, in radians.
    pub stop_sigma: f64,
    /// Outliers among all readings, as a fraction.
    pub outliers: f64,
}

/// The sources that a vehicle hears at a place.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Heard {
    /// So many readings of each, in random order, and outliers on top.
    Each(usize),
    /// One reading of either source, the first with this probability, or an outlier instead of it.
    OneOf(f64),
}

impl Channel {
    /// How many columns and rows of stops there are.
    pub const GRID: [usize; 2] = [7, 3];
    /// The part of the square between its edge and the outermost stops, as a fraction of its side.
    pub const MARGIN: f64 = 0.2;

    /// Four sources at the corners of a square, and the stops of a vehicle: three rows of seven between a fifth and four
    /// fifths of either side, along which it drives to and fro. It reads four times a second, and takes three seconds
    /// from stop to stop.
    pub fn stops(side_m: f64, readings: usize, sigma: f64, stop_sigma: f64) -> Self {
        let at = |index: usize, count: usize| {
            let part = index as f64 / (count - 1) as f64;
            side_m * (Self::MARGIN + (1.0 - 2.0 * Self::MARGIN) * part)
        };
        let [columns, rows] = Self::GRID;
        let place = |index: usize| {
            let (row, column) = (index / columns, index % columns);
            let column = if row % 2 == 0 {
                column
            } else {
                columns - 1 - column
            };
            [at(column, columns), at(row, rows)]
        };
        Self {
            sources: Self::corners(side_m).to_vec(),
            places: (0..columns * rows).map(place).collect(),
            heard: Heard::Each(readings),
            interval_ms: 250,
            way_ms: 3_000,
            every_ms: 0,
            sigma,
            stop_sigma,
            outliers: 0.0,
        }
    }

    /// The same sources, and a drive between them at 15 m/s, from the middle of one side to that of the other. It hears each
    /// once a second.
    pub fn drive(side_m: f64, sigma: f64) -> Self {
        let middle = 0.5 * side_m;
        let seconds = (side_m / 15.0).floor() as usize;
        Self {
            places: along(
                &[[0.0, middle], [15.0 * seconds as f64, middle]],
                seconds + 1,
            ),
            interval_ms: 50,
            way_ms: 50,
            every_ms: 1_000,
            ..Self::stops(side_m, 1, sigma, 0.0)
        }
    }

    /// Two sources 500 to 1,500 m from the corner of an L of 3 km, 60 degrees apart, and one reading every 25 m, of the first
    /// with a probability; a tenth are outliers.
    pub fn pair(first: f64, sigma: f64, rng: &mut impl Rng) -> Self {
        let turn = rng.random_range(-PI..PI);
        let sources = [turn, turn + PI / 3.0].map(|angle| {
            let range = rng.random_range(500.0..1500.0);
            [1500.0 + range * angle.cos(), range * angle.sin()]
        });
        let end = 25.0 * 119.0;
        Self {
            sources: sources.to_vec(),
            places: along(&[[0.0, 0.0], [1500.0, 0.0], [1500.0, end - 1500.0]], 120),
            heard: Heard::OneOf(first),
            interval_ms: 0,
            way_ms: 0,
            every_ms: 1_000,
            sigma,
            stop_sigma: 0.0,
            outliers: 0.1,
        }
    }

    /// The same channel with outliers.
    #[must_use]
    pub fn with_outliers(self, outliers: f64) -> Self {
        Self { outliers, ..self }
    }

    /// The corners of a square.
    pub fn corners(side_m: f64) -> [[f64; 2]; 4] {
        [[0.0, 0.0], [side_m, 0.0], [side_m, side_m], [0.0, side_m]]
    }

    /// All readings in the order of time.
    pub fn readings(&self, rng: &mut impl Rng) -> Vec<Reading> {
        let mut readings = Vec::new();
        let (mut start_ms, mut time_ms) = (0, 0);
        for &position in &self.places {
            let common = self.stop_sigma * normal(rng);
            for (source, outlier) in self.heard_here(rng) {
                let bearing = if outlier {
                    rng.random_range(-PI..PI)
                } else {
                    let error = common + self.sigma * normal(rng);
                    wrap(direction(position, self.sources[source]) + error)
                };
                let sight = Sight {
                    time_ms,
                    position,
                    bearing,
                    sigma: self.sigma,
                };
                readings.push(Reading { sight, source });
                time_ms += self.interval_ms;
            }
            time_ms = (time_ms - self.interval_ms + self.way_ms).max(start_ms + self.every_ms);
            start_ms = time_ms;
        }
        readings
    }

    /// The sources of the readings of a place, and which are outliers.
    fn heard_here(&self, rng: &mut impl Rng) -> Vec<(usize, bool)> {
        match self.heard {
            Heard::OneOf(first) => {
                let source = usize::from(!rng.random_bool(first));
                vec![(source, rng.random_bool(self.outliers))]
            }
            Heard::Each(readings) => {
                // So many for each that is none.
                let more = self.outliers / (1.0 - self.outliers);
                let mut all = Vec::new();
                for source in (0..self.sources.len()).flat_map(|k| vec![k; readings]) {
                    all.push((source, false));
                    if rng.random_bool(more) {
                        all.push((source, true));
                    }
                }
                all.shuffle(rng);
                all
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use foxhunt_simulation::random::generator;

    #[test]
    fn readings_of_a_stop_have_an_error_in_common() {
        let channel = Channel::stops(12.0, 50, 0.02, 0.1);
        assert_eq!(channel.places.len(), 21);
        let readings = channel.readings(&mut generator(1, 0));
        assert_eq!(readings.len(), 21 * 4 * 50);
        assert!(readings.is_sorted_by_key(|reading| reading.sight.time_ms));
        let residual = |reading: &Reading| reading.sight.residual(channel.sources[reading.source]);
        let mut means = Vec::new();
        for stop in readings.chunk_by(|a, b| a.sight.position == b.sight.position) {
            let mean = stop.iter().map(residual).sum::<f64>() / stop.len() as f64;
            assert!(
                stop.iter()
                    .all(|reading| (residual(reading) - mean).abs() < 0.1)
            );
            means.push(mean);
        }
        let variance = means.iter().map(|mean| mean * mean).sum::<f64>() / 21.0;
        assert!(
            (0.06..0.14).contains(&variance.sqrt()),
            "{}",
            variance.sqrt()
        );
    }

    #[test]
    fn outliers_are_a_fraction_of_all_and_come_on_top() {
        let channel = Channel::stops(1200.0, 50, 0.02, 0.0).with_outliers(0.1);
        let readings = channel.readings(&mut generator(1, 0));
        let far = readings.iter().filter(|reading| {
            reading
                .sight
                .residual(channel.sources[reading.source])
                .abs()
                > 0.1
        });
        let far = far.count() as f64 / readings.len() as f64;
        assert!((0.085..0.11).contains(&far), "{far}");
        assert!((4550..4800).contains(&readings.len()));
    }

    #[test]
    fn a_drive_passes_at_fifteen_metres_a_second() {
        let drive = Channel::drive(1200.0, 0.02).with_outliers(0.1);
        let readings = drive.readings(&mut generator(1, 0));
        assert!((340..380).contains(&readings.len()));
        let [first, last] =
            [readings[0], readings[readings.len() - 1]].map(|reading| reading.sight);
        let seconds = f64::from(last.time_ms - first.time_ms) / 1e3;
        let way = last.position[0] - first.position[0];
        assert!((way / seconds - 15.0).abs() < 0.1, "{way} m in {seconds} s");
    }

    #[test]
    fn one_of_a_pair_is_heard_four_times_as_often() {
        let mut rng = generator(1, 0);
        let pair = Channel::pair(0.8, 0.02, &mut rng);
        let readings = pair.readings(&mut rng);
        assert_eq!(readings.len(), 120);
        let second = readings
            .iter()
            .filter(|reading| reading.source == 1)
            .count();
        assert!((15..35).contains(&second), "{second}");
    }
}
