//! The places of a survey, put together in cells.

use std::collections::BTreeMap;

use foxhunt_simulation::survey::Survey;

/// Cells of a survey that have readings.
#[derive(Debug, Clone)]
pub(super) struct Cells {
    /// The mean of the places in each, in metres.
    pub places: Vec<[f64; 2]>,
    /// By beacon, the mean level in each, in dBm. Where a beacon was not heard, its weakest.
    pub values: Vec<Vec<f64>>,
    /// By beacon, whether it was heard in each.
    pub heard: Vec<Vec<bool>>,
    /// How much of the variance of the values is noise because there are few readings, by cell.
    pub noise: Vec<f64>,
    /// By place of the survey.
    pub of_place: Vec<usize>,
}

impl Cells {
    /// With cells of so many metres; none makes each place a cell of its own.
    pub fn new(survey: &Survey, side_m: Option<f64>) -> Self {
        let mut numbers = BTreeMap::new();
        let mut members: Vec<Vec<usize>> = Vec::new();
        let mut of_place = Vec::new();
        for (place, coordinates) in survey.places.iter().enumerate() {
            let key = match side_m {
                Some(side) => coordinates.map(|c| (c / side).floor() as i64),
                None => [place as i64, 0],
            };
            let number = *numbers.entry(key).or_insert_with(|| {
                members.push(Vec::new());
                members.len() - 1
            });
            members[number].push(place);
            of_place.push(number);
        }
        let mean = |of: &dyn Fn(usize) -> f64, members: &[usize]| {
            members.iter().map(|place| of(*place)).sum::<f64>() / members.len() as f64
        };
        let places = members
            .iter()
            .map(|members| [0, 1].map(|axis| mean(&|place| survey.places[place][axis], members)));
        let values = (0..survey.beacons()).map(|beacon| levels(survey, &members, beacon));
        let heard = (0..survey.beacons()).map(|beacon| {
            let in_cell = |members: &Vec<usize>| {
                (members.iter()).any(|place| !survey.samples[*place][beacon].is_empty())
            };
            members.iter().map(in_cell).collect()
        });
        let mut cells = Self {
            places: places.collect(),
            values: values.collect(),
            heard: heard.collect(),
            noise: Vec::new(),
            of_place,
        };
        let variance = cells.variance().max(1.0);
        let packets = packet_variance(survey, &cells.of_place);
        let noise = members.iter().map(|members| {
            let readings = members.iter().flat_map(|place| &survey.samples[*place]);
            let count = readings.map(Vec::len).sum::<usize>() as f64 / survey.beacons() as f64;
            (packets / (count.max(0.5) * variance)).min(2.0)
        });
        cells.noise = noise.collect();
        cells
    }

    /// Of the values about the mean of their beacon.
    fn variance(&self) -> f64 {
        let of = |values: &Vec<f64>| {
            let n = values.len() as f64;
            let mean = values.iter().sum::<f64>() / n;
            values.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / n
        };
        self.values.iter().map(of).sum::<f64>() / self.values.len().max(1) as f64
    }

    /// The median distance of a cell to the next one, in metres; 1 for a single one.
    pub fn neighbour_m(&self) -> f64 {
        nearest_neighbour(&self.places).unwrap_or(1.0)
    }

    /// Cells that are left out together: those within squares of two distances between neighbours. Each alone, if all were
    /// in one.
    pub fn blocks(&self) -> Vec<Vec<usize>> {
        let side = 2.0 * self.neighbour_m();
        let mut blocks: BTreeMap<[i64; 2], Vec<usize>> = BTreeMap::new();
        for (cell, place) in self.places.iter().enumerate() {
            // Places at equal distances are not cut by rounding.
            let key = place.map(|c| (c / side + 0.25).floor() as i64);
            blocks.entry(key).or_default().push(cell);
        }
        match self.places.len() {
            1 => Vec::new(),
            n if blocks.len() < 2 => (0..n).map(|cell| vec![cell]).collect(),
            _ => blocks.into_values().collect(),
        }
    }
}

fn levels(survey: &Survey, members: &[Vec<usize>], beacon: usize) -> Vec<f64> {
    let of_place = |place: &usize| survey.samples[*place][beacon].iter().copied();
    let all = survey.samples.iter().flat_map(|beacons| &beacons[beacon]);
    let least = |a: f64, b: &f64| a.min(*b);
    let mut weakest = all.fold(f64::INFINITY, least);
    if weakest.is_infinite() {
        // Heard nowhere: nothing is known but what receivers do hear.
        weakest = survey
            .samples
            .iter()
            .flatten()
            .flatten()
            .fold(f64::INFINITY, least);
    }
    let level = |members: &Vec<usize>| {
        let readings: Vec<f64> = members.iter().flat_map(of_place).collect();
        match readings.len() {
            0 => weakest,
            n => readings.iter().sum::<f64>() / n as f64,
        }
    };
    members.iter().map(level).collect()
}

/// Variance of a reading about the level at its place, in dB^2: half of the mean square of the difference between readings
/// that follow each other there. What lasts longer is no noise.
pub(super) fn packet_variance(survey: &Survey, cell_of_place: &[usize]) -> f64 {
    /// Of a reading by Bluetooth, where the survey has no two at a place.
    const UNKNOWN: f64 = 16.0;
    const LEAST_PAIRS: f64 = 30.0;
    let mut last: BTreeMap<(usize, usize), f64> = BTreeMap::new();
    let (mut count, mut squares) = (0.0, 0.0);
    for (samples, cell) in survey.samples.iter().zip(cell_of_place) {
        for (beacon, readings) in samples.iter().enumerate() {
            for reading in readings {
                if let Some(before) = last.insert((*cell, beacon), *reading) {
                    count += 1.0;
                    squares += (reading - before).powi(2);
                }
            }
        }
    }
    if count < LEAST_PAIRS {
        UNKNOWN
    } else {
        0.5 * squares / count
    }
}

pub(super) fn distance(a: [f64; 2], b: [f64; 2]) -> f64 {
    (a[0] - b[0]).hypot(a[1] - b[1])
}

/// The median distance of a place to the next one, in metres; 1 for a single place, `None` for none.
pub(super) fn nearest_neighbour(places: &[[f64; 2]]) -> Option<f64> {
    let nearest = |place: &[f64; 2]| {
        let others = places.iter().map(|other| distance(*place, *other));
        others.filter(|d| *d > 0.0).fold(f64::INFINITY, f64::min)
    };
    let mut distances: Vec<f64> = places.iter().map(nearest).collect();
    distances.sort_by(f64::total_cmp);
    let median = *distances.get(distances.len() / 2)?;
    Some(if median.is_finite() { median } else { 1.0 })
}

/// The index of the nearest place and how far away it is.
pub(super) fn nearest(places: &[[f64; 2]], place: [f64; 2]) -> Option<(usize, f64)> {
    let distances = places.iter().map(|other| distance(*other, place));
    distances.enumerate().min_by(|a, b| a.1.total_cmp(&b.1))
}
