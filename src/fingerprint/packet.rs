//! How well one packet fits the places of particles.

use core::f32::consts::TAU;

use super::map::LOWEST_MEAN_DBM;
use super::{Config, RadioMap, Reading, ReadingError};
use crate::ConfigError;
use crate::math::ln;
use crate::model::Likelihood;

/// The terms of the likelihood by the sigma in a map, computed once for all packets. Takes 524 bytes.
#[derive(Debug, Clone, PartialEq)]
pub struct PacketModel {
    config: Config,
    /// By sigma in quarters of a dB: the log-likelihood at distance zero, and what a square of 2^-18 dB^2 adds.
    curves: [[f32; 2]; 64],
    /// The log-likelihood of an outlier.
    floor: f32,
}

impl PacketModel {
    /// With the inflation, outlier rate, tempering and range of a configuration.
    ///
    /// # Errors
    /// When a field of the configuration is out of range.
    pub fn new(config: &Config) -> Result<Self, ConfigError> {
        config.check()?;
        let tempering = config.tempering;
        let floor = tempering * config.log_floor();
        // Where the map has no mean, every reading is an outlier.
        let mut curves = [[floor, 0.0]; 64];
        for (code, curve) in curves.iter_mut().enumerate().skip(1) {
            let sigma = 0.25 * code as f32;
            let variance = sigma * sigma + config.inflation_variance();
            let peak = ln(config.inlier_rate()) - 0.5 * ln(TAU * variance);
            *curve = [tempering * peak, -0.5 * tempering * UNIT * UNIT / variance];
        }
        Ok(Self {
            config: *config,
            curves,
            floor,
        })
    }
}

/// Steps in which a packet is compared with interpolated means, in dB.
const UNIT: f32 = 1.0 / 512.0;
/// Steps from one point of the lattice to the next.
const STEPS: u32 = 256;

/// See [`RadioMap::packet_likelihood`].
#[derive(Debug, Clone, Copy)]
struct PacketLikelihood<'a> {
    model: &'a PacketModel,
    row: &'a [[u8; 2]],
    /// In steps of [`UNIT`] above the lowest mean.
    strength: i32,
    origin: [f32; 2],
    /// Steps of the lattice in a metre.
    steps: f32,
    /// Points along x and along y.
    points: [u16; 2],
}

impl<'a> RadioMap<'a> {
    /// How well a packet of a receiver that reads `offset_db` too strong fits the places of particles: a normal density,
    /// with the mean and the sigma of the map interpolated between its points, or the density of outliers where that is
    /// larger.
    ///
    /// Works on any state whose first two dimensions are metres along x and y. Places beyond the lattice count as the
    /// nearest ones on it: walls are the business of the dynamics.
    ///
    /// # Errors
    /// [`ReadingError::Beacon`], or [`ReadingError::Strength`], also for an offset that is not finite.
    pub fn packet_likelihood<const D: usize>(
        &self,
        packet: Reading,
        offset_db: f32,
        model: &'a PacketModel,
    ) -> Result<impl Likelihood<D> + use<'a, D>, ReadingError> {
        let row = self.moments_row(packet.beacon.into());
        let row = row.ok_or(ReadingError::Beacon)?;
        if !(model.config.accepts(packet.rssi_dbm) && offset_db.is_finite()) {
            return Err(ReadingError::Strength);
        }
        // Larger offsets do not occur; one that does makes the packet an outlier everywhere.
        let strength = (packet.rssi_dbm - offset_db - LOWEST_MEAN_DBM).clamp(-1000.0, 1000.0);
        let lattice = self.lattice();
        Ok(PacketLikelihood {
            model,
            row,
            strength: (strength / UNIT) as i32,
            origin: lattice.origin(),
            steps: STEPS as f32 / lattice.spacing(),
            points: [lattice.columns() as u16, lattice.rows() as u16],
        })
    }
}

impl PacketLikelihood<'_> {
    /// The last point at or before a coordinate, and the steps beyond it.
    #[inline(always)]
    fn before(&self, coordinate: f32, origin: f32, points: u16) -> (usize, u32) {
        // Saturates; NaN becomes 0.
        let steps = (((coordinate - origin) * self.steps) as i32).max(0) as u32;
        let steps = steps.min(u32::from(points.saturating_sub(1)) * STEPS);
        ((steps / STEPS) as usize, steps % STEPS)
    }

    /// Log-likelihood from the sigma and the mean, in steps.
    #[inline(always)]
    fn of_moments(&self, sigma: u32, mean: u32) -> f32 {
        let [peak, curvature] = self.model.curves[(((sigma + STEPS / 2) / STEPS) & 63) as usize];
        let distance = (self.strength - mean as i32) as f32;
        let log_likelihood = peak + curvature * (distance * distance);
        if log_likelihood > self.model.floor {
            log_likelihood
        } else {
            self.model.floor
        }
    }

    /// On a lattice of one row or one column.
    #[inline(always)]
    fn on_line(&self, coordinate: f32, origin: f32, points: u16) -> f32 {
        let (before, steps) = self.before(coordinate, origin, points);
        let row = self.row;
        if before + 1 >= row.len() {
            return self.at_point(before);
        }
        let (a, b) = (row[before], row[before + 1]);
        let [sigma, mean] =
            [0, 1].map(|k| u32::from(a[k]) * (STEPS - steps) + u32::from(b[k]) * steps);
        self.of_moments(sigma, mean)
    }

    /// All on a lattice of one row or one column. A function of its own, so that the loop has all registers.
    #[inline(never)]
    fn line(&self, coordinates: &[f32], origin: f32, points: u16, out: &mut [f32]) {
        let this = *self;
        for (coordinate, out) in coordinates.iter().zip(out) {
            *out = this.on_line(*coordinate, origin, points);
        }
    }

    /// All on a lattice of several rows and columns. A function of its own, so that the loop has all registers.
    #[inline(never)]
    fn plane(&self, x: &[f32], y: &[f32], out: &mut [f32]) {
        let this = *self;
        for ((x, y), out) in x.iter().zip(y).zip(out) {
            *out = this.in_plane(*x, *y);
        }
    }

    /// On a lattice of several rows and columns.
    #[inline(always)]
    fn in_plane(&self, x: f32, y: f32) -> f32 {
        let (column, right) = self.before(x, self.origin[0], self.points[0]);
        let (line, up) = self.before(y, self.origin[1], self.points[1]);
        let columns = usize::from(self.points[0]);
        // What is right of the last column has no weight, so any value will do.
        let below = line * columns + column;
        match self.row.get(below..) {
            Some(points) if columns + 1 < points.len() => {
                let corners = [points[0], points[1], points[columns], points[columns + 1]];
                self.of_corners(corners, right, up)
            }
            _ => self.at_border(below, right, up),
        }
    }

    #[inline(always)]
    fn of_corners(&self, [a, b, c, d]: [[u8; 2]; 4], right: u32, up: u32) -> f32 {
        // The weights of the corners, which sum to the square of the steps.
        let of_d = right * up;
        let (of_b, of_c) = (right * STEPS - of_d, up * STEPS - of_d);
        let of_a = STEPS * STEPS - right * STEPS - of_c;
        let [sigma, mean] = [0, 1].map(|k| {
            let sum = u32::from(a[k]) * of_a
                + u32::from(b[k]) * of_b
                + u32::from(c[k]) * of_c
                + u32::from(d[k]) * of_d;
            sum / STEPS
        });
        self.of_moments(sigma, mean)
    }

    /// On the last row of the lattice, where there is nothing above.
    #[cold]
    #[inline(never)]
    fn at_border(&self, below: usize, right: u32, up: u32) -> f32 {
        let point = |number| self.row.get(number).copied().unwrap_or_default();
        let columns = usize::from(self.points[0]);
        let corners = [below, below + 1, below + columns, below + columns + 1];
        self.of_corners(corners.map(point), right, up)
    }

    /// On the last point of a line.
    #[cold]
    #[inline(never)]
    fn at_point(&self, point: usize) -> f32 {
        let [sigma, mean] = self.row.get(point).copied().unwrap_or_default();
        self.of_moments(u32::from(sigma) * STEPS, u32::from(mean) * STEPS)
    }
}

impl<const D: usize> Likelihood<D> for PacketLikelihood<'_> {
    fn log_likelihood(&self, state: &[f32; D]) -> f32 {
        const { assert!(D >= 2, "a position takes two dimensions") };
        match self.points {
            [columns, 1] => self.on_line(state[0], self.origin[0], columns),
            [1, rows] => self.on_line(state[1], self.origin[1], rows),
            _ => self.in_plane(state[0], state[1]),
        }
    }

    fn log_likelihoods(&self, columns: &[&[f32]; D], out: &mut [f32]) {
        const { assert!(D >= 2, "a position takes two dimensions") };
        match self.points {
            [points, 1] => self.line(columns[0], self.origin[0], points, out),
            [1, points] => self.line(columns[1], self.origin[1], points, out),
            _ => self.plane(columns[0], columns[1], out),
        }
    }
}
