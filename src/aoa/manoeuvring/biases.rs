//! What a component knows of the biases of fixed stations: jointly with where the source is, for a bearing tells of both.

use crate::aoa::Observation;
use crate::snapshot::{Error, Reader, Value, Writer};

/// Biases of `K` stations in radians, by the stations' numbers; those beyond the last have that one in common. Nothing where
/// there are none.
#[derive(Debug, Clone, Copy)]
pub(super) struct StationBiases<const K: usize> {
    mean: [f32; K],
    /// Covariance of each with the position.
    pub(super) position: [[f32; 2]; K],
    /// Covariance of each with the velocity.
    velocity: [[f32; 2]; K],
    covariance: [[f32; K]; K],
}

impl<const K: usize> Value for StationBiases<K> {
    const SIZE: usize = 4 * K * (5 + K);

    fn write(&self, to: &mut Writer<'_>) {
        to.column(&self.mean);
        to.column(self.position.as_flattened());
        to.column(self.velocity.as_flattened());
        to.column(self.covariance.as_flattened());
    }

    fn read(from: &mut Reader<'_>) -> Result<Self, Error> {
        let mut biases = Self::NONE;
        from.column(&mut biases.mean)?;
        from.column(biases.position.as_flattened_mut())?;
        from.column(biases.velocity.as_flattened_mut())?;
        from.column(biases.covariance.as_flattened_mut())?;
        Ok(biases)
    }
}

/// Covariance of the numbers of a component with a measurement.
pub(super) struct Gain<const K: usize> {
    pub(super) position: [f32; 2],
    pub(super) velocity: [f32; 2],
    pub(super) biases: [f32; K],
}

/// The entry of a station.
pub(super) fn at(biases: &[f32], station: usize) -> f32 {
    biases.get(station).copied().unwrap_or(0.0)
}

impl<const K: usize> StationBiases<K> {
    pub(super) const NONE: Self = Self {
        mean: [0.0; K],
        position: [[0.0; 2]; K],
        velocity: [[0.0; 2]; K],
        covariance: [[0.0; K]; K],
    };

    /// Before any bearing: independent of each other and of all else.
    pub(super) fn new(sigma_rad: f32) -> Self {
        let mut biases = Self::NONE;
        for (i, row) in biases.covariance.iter_mut().enumerate() {
            if let Some(entry) = row.get_mut(i) {
                *entry = sigma_rad * sigma_rad;
            }
        }
        biases
    }

    /// The place of the station of a bearing; `None` where there are no biases.
    pub(super) fn index(observation: &Observation) -> Option<usize> {
        let last = K.checked_sub(1)?;
        Some(usize::from(observation.station()).min(last))
    }

    pub(super) fn mean_of(&self, station: Option<usize>) -> f32 {
        station.map_or(0.0, |station| at(&self.mean, station))
    }

    /// Mean and mean square of the bias of a station.
    pub(super) fn moments_of(&self, station: usize) -> (f32, f32) {
        let mean = at(&self.mean, station);
        let variance = (self.covariance.get(station)).map_or(0.0, |row| at(row, station));
        (mean, mean * mean + variance)
    }

    /// Adds what the bias of a station has in common with everything.
    pub(super) fn add_to(&self, gain: &mut Gain<K>, station: usize) {
        let add = |sum: &mut [f32; 2], [a, b]: [f32; 2]| *sum = [sum[0] + a, sum[1] + b];
        if let (Some(position), Some(velocity), Some(row)) = (
            self.position.get(station),
            self.velocity.get(station),
            self.covariance.get(station),
        ) {
            add(&mut gain.position, *position);
            add(&mut gain.velocity, *velocity);
            for (sum, entry) in gain.biases.iter_mut().zip(row) {
                *sum += entry;
            }
        }
    }

    pub(super) fn shift(&mut self, gain: &Gain<K>, step: f32, factor: f32) {
        let plus = |[a, b]: &mut [f32; 2], times: f32, [x, y]: [f32; 2]| {
            (*a, *b) = (*a + times * x, *b + times * y);
        };
        for (i, own) in gain.biases.iter().enumerate() {
            if let (Some(mean), Some(position), Some(velocity), Some(row)) = (
                self.mean.get_mut(i),
                self.position.get_mut(i),
                self.velocity.get_mut(i),
                self.covariance.get_mut(i),
            ) {
                *mean += step * own;
                plus(position, factor * own, gain.position);
                plus(velocity, factor * own, gain.velocity);
                for (entry, other) in row.iter_mut().zip(&gain.biases) {
                    *entry += factor * own * other;
                }
            }
        }
    }

    /// Of a source that has moved on for `seconds`, and keeps a part of its velocity.
    pub(super) fn travel(&mut self, seconds: f32, keep: f32) {
        for ([x, y], [u, v]) in self.position.iter_mut().zip(&mut self.velocity) {
            (*x, *y) = (*x + seconds * *u, *y + seconds * *v);
            (*u, *v) = (keep * *u, keep * *v);
        }
    }

    pub(super) fn forget_velocity(&mut self) {
        self.velocity = [[0.0; 2]; K];
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn who_moves_on_takes_covariances_along() {
        let mut biases = StationBiases::<2> {
            position: [[1.0, 2.0], [-1.0, 0.5]],
            velocity: [[4.0, -6.0], [2.0, 8.0]],
            ..StationBiases::NONE
        };
        biases.travel(3.0, 0.5);
        assert_eq!(biases.position, [[13.0, -16.0], [5.0, 24.5]]);
        assert_eq!(biases.velocity, [[2.0, -3.0], [1.0, 4.0]]);
        biases.forget_velocity();
        biases.travel(3.0, 1.0);
        assert_eq!(biases.position, [[13.0, -16.0], [5.0, 24.5]]);
    }
}
