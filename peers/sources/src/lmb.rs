//! The labelled multi-Bernoulli filter of `tracktor`, for bearings.

use std::f64::consts::{PI, TAU};

use foxhunt_simulation::Sight;
use foxhunt_host::channel::{Channel, Heard, Reading};
use nalgebra::{Matrix2, SMatrix, SVector, Vector2};
use tracktor::{
    filters::lmb::{LmbFilterState, LmbTrack, NoBirthModel, extract_lmb_estimates},
    models::{NonlinearObservationModel, TransitionModel, UniformClutter},
    types::{
        gaussian::GaussianState,
        spaces::{Measurement, MeasurementCovariance, StateCovariance, StateVector},
        transforms::{ObservationMatrix, TransitionMatrix},
    },
    utils::{PruningConfig, prune_and_merge},
};

/// Existence of a new track, and that below which one is dropped.
const BORN: f64 = 0.01;
const DROPPED: f64 = 1e-4;
/// Tracks of which this is exceeded explain bearings, for which none is born.
const SURE: f64 = 0.5;
/// Ranges of the tracks that are born along a bearing, as fractions of the extent of the scene, and their relative standard
/// deviation: they overlap.
const RANGES: [f64; 8] = [0.08, 0.12, 0.19, 0.3, 0.46, 0.7, 1.08, 1.65];
const RANGE_SIGMA: f64 = 0.25;
/// Of the walk of a source in a step, as a fraction of the extent: some, so that the filter stays awake.
const WALK: f64 = 1e-3;
const SURVIVAL: f64 = 0.999;
/// Bearings of a stop that differ by less than so many sigmas are averaged.
const ALIKE: f64 = 3.0;
/// What such a mean must rest on, as a fraction of that which rests on most.
const LEAST: f64 = 0.25;

/// The sources at the end. The filter is told how large errors are, those of stops included, how many bearings are
/// outliers, how often a source is heard, and how large the scene is.
pub fn locate(channel: &Channel, readings: &[Reading], extent_m: f64) -> Vec<[f64; 2]> {
    let sigma = channel.sigma.hypot(channel.stop_sigma);
    let outliers = channel.outliers;
    let (detection, clutter) = match channel.heard {
        Heard::Each(1) => {
            let each = outliers / (1.0 - outliers);
            (0.98, channel.sources.len() as f64 * each)
        }
        // Means may be of two sources, and outliers are left out.
        Heard::Each(_) => (0.9, 0.1),
        Heard::OneOf(_) => ((1.0 - outliers) / channel.sources.len() as f64, outliers),
    };
    let sights: Vec<Sight> = readings.iter().map(|reading| reading.sight).collect();
    // A unit vector has a radial part that says nothing: its density stands beside that of clutter on the circle.
    let volume = TAU * TAU.sqrt() * sigma;
    let clutter = UniformClutter::<f64, 2>::new(clutter.max(0.05), volume);
    let mut state = LmbFilterState::<f64, 2, _>::new();
    for stop in sights.chunk_by(|a, b| a.position == b.position) {
        let bearings = match channel.heard {
            Heard::Each(readings) if readings > 1 => means(stop, ALIKE * channel.sigma),
            _ => stop.iter().map(|sight| sight.bearing).collect(),
        };
        let sensor = Sensor {
            position: stop[0].position.into(),
            sigma,
            detection,
        };
        let still = Still {
            walk: WALK * extent_m,
        };
        let vectors: Vec<Measurement<f64, 2>> = bearings
            .iter()
            .map(|bearing| Measurement::from_array([bearing.cos(), bearing.sin()]))
            .collect();
        let unexplained = sensor.unexplained(&state.tracks.tracks, &bearings);
        let predicted = state.predict(&still, &NoBirthModel, 1.0);
        (state, _) = predicted.update_ekf(&vectors, &sensor, &clutter);
        prune(&mut state.tracks.tracks);
        for bearing in unexplained {
            for range in RANGES {
                let label = state.label_gen.next_label();
                let place = sensor.born(bearing, range * extent_m);
                state.tracks.push(LmbTrack::new(label, BORN, place));
            }
        }
    }
    let estimates = extract_lmb_estimates(&state);
    estimates
        .iter()
        .map(|one| (*one.state.as_svector()).into())
        .collect()
}

fn prune(tracks: &mut Vec<LmbTrack<f64, 2>>) {
    tracks.retain(|track| track.existence > DROPPED);
    let config = PruningConfig::new(1e-3, 1.0, 10);
    for track in tracks {
        track.components = prune_and_merge(&track.components, &config);
        track.normalize_weights();
    }
}

/// The means of bearings of a stop that are alike.
fn means(stop: &[Sight], alike: f64) -> Vec<f64> {
    let wrap = |angle: f64| (angle + PI).rem_euclid(TAU) - PI;
    let mut groups: Vec<(f64, f64)> = stop.iter().map(|sight| (sight.bearing, 1.0)).collect();
    groups.sort_by(|(a, _), (b, _)| a.total_cmp(b));
    while groups.len() > 1 {
        let gap = |index: usize| {
            let next = groups[(index + 1) % groups.len()].0;
            (next - groups[index].0).rem_euclid(TAU)
        };
        let nearest = (0..groups.len()).min_by(|a, b| gap(*a).total_cmp(&gap(*b)));
        let Some(index) = nearest.filter(|index| gap(*index) < alike) else {
            break;
        };
        let gap = gap(index);
        let (_, weight) = groups.remove((index + 1) % groups.len());
        // What was removed stood before it only if it was the first.
        let index = index.min(groups.len() - 1);
        let (bearing, count) = &mut groups[index];
        *count += weight;
        *bearing = wrap(*bearing + gap * weight / *count);
    }
    let most = groups
        .iter()
        .fold(0.0, |most, (_, count)| f64::max(most, *count));
    groups.retain(|(_, count)| *count >= LEAST * most);
    groups.into_iter().map(|(bearing, _)| bearing).collect()
}

/// A source at rest.
struct Still {
    walk: f64,
}

impl TransitionModel<f64, 2> for Still {
    fn transition_matrix(&self, _dt: f64) -> TransitionMatrix<f64, 2> {
        TransitionMatrix::identity()
    }

    fn process_noise(&self, _dt: f64) -> StateCovariance<f64, 2> {
        StateCovariance::from_matrix(Matrix2::identity() * self.walk.powi(2))
    }

    fn survival_probability(&self, _state: &StateVector<f64, 2>) -> f64 {
        SURVIVAL
    }
}

/// A direction finder, whose bearings are unit vectors: those need not be wrapped, which the filter does not do.
struct Sensor {
    position: Vector2<f64>,
    sigma: f64,
    detection: f64,
}

impl Sensor {
    /// Bearings that no sure track explains.
    fn unexplained(&self, tracks: &[LmbTrack<f64, 2>], bearings: &[f64]) -> Vec<f64> {
        let explains = |track: &LmbTrack<f64, 2>, bearing: f64| {
            let Some(best) = track.best_estimate().filter(|_| track.existence > SURE) else {
                return false;
            };
            let offset = best.mean.as_svector() - self.position;
            let gradient = Vector2::new(-offset.y, offset.x) / offset.norm_squared();
            let spread = gradient.dot(&(best.covariance.as_matrix() * gradient));
            let sight = Vector2::new(bearing.cos(), bearing.sin());
            let error = offset.angle(&sight);
            error < 3.0 * (spread + self.sigma.powi(2)).sqrt()
        };
        let free = |bearing: &&f64| !tracks.iter().any(|track| explains(track, **bearing));
        bearings.iter().filter(free).copied().collect()
    }

    /// Along a bearing, at a range.
    fn born(&self, bearing: f64, range: f64) -> GaussianState<f64, 2> {
        let along = Vector2::new(bearing.cos(), bearing.sin());
        let across = Vector2::new(-along.y, along.x);
        let spread = (RANGE_SIGMA * range).powi(2) * along * along.transpose()
            + (self.sigma * range).powi(2) * across * across.transpose();
        GaussianState::new(
            1.0,
            StateVector::from_svector(self.position + range * along),
            StateCovariance::from_matrix(spread),
        )
    }
}

impl NonlinearObservationModel<f64, 2, 2> for Sensor {
    fn observe(&self, state: &StateVector<f64, 2>) -> Measurement<f64, 2> {
        let offset: SVector<f64, 2> = state.as_svector() - self.position;
        Measurement::from_svector(offset.normalize())
    }

    fn jacobian_at(&self, state: &StateVector<f64, 2>) -> Option<ObservationMatrix<f64, 2, 2>> {
        let offset = state.as_svector() - self.position;
        let range = offset.norm();
        let along = offset / range;
        let across: SMatrix<f64, 2, 2> = Matrix2::identity() - along * along.transpose();
        (range > 0.0).then(|| ObservationMatrix::from_matrix(across / range))
    }

    fn measurement_noise(&self) -> MeasurementCovariance<f64, 2> {
        MeasurementCovariance::from_matrix(Matrix2::identity() * self.sigma.powi(2))
    }

    fn detection_probability(&self, _state: &StateVector<f64, 2>) -> f64 {
        self.detection
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bearings_that_are_alike_are_averaged_round_the_circle() {
        let sight = |bearing| Sight {
            time_ms: 0,
            position: [0.0; 2],
            bearing,
            sigma: 0.1,
        };
        let stop = [3.1, 0.5, -3.1, 0.6, 0.7, 3.13].map(sight);
        let mut found = means(&stop, 0.2);
        found.sort_by(f64::total_cmp);
        assert_eq!(found.len(), 2);
        assert!((found[0] - 0.6).abs() < 1e-9, "{found:?}");
        assert!(found[1] > 3.1, "{found:?}");
    }

    #[test]
    fn four_sources_are_found() {
        let channel = Channel::stops(1200.0, 1, 0.02, 0.0);
        let readings = channel.readings(&mut foxhunt_simulation::random::generator(1, 0));
        let found = locate(&channel, &readings, 1200.0);
        assert_eq!(found.len(), 4);
    }
}
