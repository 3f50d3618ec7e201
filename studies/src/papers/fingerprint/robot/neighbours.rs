//! The usual way: five nearest neighbours in strength, and a Kalman filter after them.

use std::collections::BTreeMap;

use foxhunt_host::{radio_map::SiteSurvey, robot::Drive};
use nalgebra::{Matrix2, Matrix2x4, Matrix4, Vector2, Vector4};

/// Side of the cells whose mean strengths are the neighbours, in metres.
const CELL: f64 = 0.5;
const NEIGHBOURS: usize = 5;
/// Variance of a match along an axis in m^2, and of the acceleration in m^2/s^3: of a person on foot.
const MATCH: f64 = 1.5;
const ACCELERATION: f64 = 0.09;

/// Where each cell is, and how strong every beacon is there.
type Cells = Vec<([f64; 2], Vec<Option<f64>>)>;

/// The places at `times`.
pub fn track(survey: &SiteSurvey, drive: &Drive, times: &[(f64, bool)]) -> Vec<[f64; 2]> {
    let cells = cells(survey);
    let mut filter: Option<(f64, Vector4<f64>, Matrix4<f64>)> = None;
    let mut found = Vec::new();
    for (time, _) in times {
        let levels = super::means(drive, survey.beacons().len(), time - 1.0..*time);
        let place = nearest(&cells, &levels);
        let state = match (filter.take(), place) {
            (None, place) => {
                let [x, y] = place.unwrap_or([0.0; 2]);
                let covariance = Matrix4::from_diagonal(&Vector4::new(MATCH, MATCH, 0.25, 0.25));
                (*time, Vector4::new(x, y, 0.0, 0.0), covariance)
            }
            (Some((last, mean, covariance)), place) => {
                let (mean, covariance) = predict(mean, covariance, time - last);
                let (mean, covariance) = match place {
                    Some(place) => update(mean, covariance, place),
                    None => (mean, covariance),
                };
                (*time, mean, covariance)
            }
        };
        found.push([state.1[0], state.1[1]]);
        filter = Some(state);
    }
    found
}

fn predict(mean: Vector4<f64>, covariance: Matrix4<f64>, dt: f64) -> (Vector4<f64>, Matrix4<f64>) {
    let mut step = Matrix4::identity();
    step[(0, 2)] = dt;
    step[(1, 3)] = dt;
    let mut noise = Matrix4::zeros();
    for axis in 0..2 {
        noise[(axis, axis)] = dt.powi(3) / 3.0;
        noise[(axis, axis + 2)] = dt.powi(2) / 2.0;
        noise[(axis + 2, axis)] = dt.powi(2) / 2.0;
        noise[(axis + 2, axis + 2)] = dt;
    }
    (
        step * mean,
        step * covariance * step.transpose() + ACCELERATION * noise,
    )
}

fn update(
    mean: Vector4<f64>,
    covariance: Matrix4<f64>,
    [x, y]: [f64; 2],
) -> (Vector4<f64>, Matrix4<f64>) {
    let look = Matrix2x4::new(1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0);
    let innovation = look * covariance * look.transpose() + MATCH * Matrix2::identity();
    let Some(inverse) = innovation.try_inverse() else {
        return (mean, covariance);
    };
    let gain = covariance * look.transpose() * inverse;
    (
        mean + gain * (Vector2::new(x, y) - look * mean),
        covariance - gain * look * covariance,
    )
}

/// The mean of the cells whose strengths are nearest.
fn nearest(cells: &Cells, levels: &[Option<f64>]) -> Option<[f64; 2]> {
    let mut distances: Vec<(f64, [f64; 2])> = cells
        .iter()
        .filter_map(|(place, known)| {
            let pairs = known.iter().zip(levels);
            let squares = pairs.filter_map(|(a, b)| Some(((*a)? - (*b)?).powi(2)));
            let (count, sum) = squares.fold((0.0, 0.0), |(n, sum), square| (n + 1.0, sum + square));
            (count > 0.0).then(|| (sum / count, *place))
        })
        .collect();
    distances.sort_by(|a, b| a.0.total_cmp(&b.0));
    distances.truncate(NEIGHBOURS);
    let n = distances.len() as f64;
    (n > 0.0).then(|| [0, 1].map(|axis| distances.iter().map(|(_, p)| p[axis]).sum::<f64>() / n))
}

fn cells(survey: &SiteSurvey) -> Cells {
    let beacons = survey.beacons().len();
    let survey = survey.survey();
    let mut members: BTreeMap<[i64; 2], Vec<usize>> = BTreeMap::new();
    for (place, coordinates) in survey.places.iter().enumerate() {
        let key = coordinates.map(|c| (c / CELL).floor() as i64);
        members.entry(key).or_default().push(place);
    }
    let cell = |members: &Vec<usize>| {
        let n = members.len() as f64;
        let place =
            [0, 1].map(|axis| members.iter().map(|p| survey.places[*p][axis]).sum::<f64>() / n);
        let level = |beacon: usize| {
            let readings = members
                .iter()
                .flat_map(|place| &survey.samples[*place][beacon]);
            let (count, sum) = readings.fold((0.0, 0.0), |(n, sum), rssi| (n + 1.0, sum + rssi));
            (count > 0.0).then(|| sum / count)
        };
        (place, (0..beacons).map(level).collect())
    };
    members.values().map(cell).collect()
}
