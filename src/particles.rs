//! A cloud of particles: one column of f32 per dimension of the state.
//!
//! Columns let every pass over the cloud stream through memory and touch only what it needs. Only
//! [`Particles`] carries the number of particles in its type; everything that computes takes slices.

use crate::persist;
use crate::random::Rng;
use crate::resample::{Scheme, resample};

/// `N` particles with a state of `D` dimensions, and their log-weights.
///
/// Log-weights are natural logarithms with an arbitrary common offset: [`crate::weights`] turns them into
/// weights that sum to one.
#[derive(Debug, Clone)]
pub struct Particles<const D: usize, const N: usize> {
    columns: [[f32; N]; D],
    log_weights: [f32; N],
}

impl<const D: usize, const N: usize> Particles<D, N> {
    /// All particles at the origin, with equal weights.
    pub const fn new() -> Self {
        const {
            assert!(
                D > 0 && N > 0 && N <= 1 << 16,
                "from one to 65,536 particles"
            )
        };
        Self {
            columns: [[0.0; N]; D],
            log_weights: [0.0; N],
        }
    }

    /// Draws the state of every particle from `draw` and makes their weights equal.
    pub fn initialise<R: Rng + ?Sized>(
        &mut self,
        rng: &mut R,
        mut draw: impl FnMut(&mut R) -> [f32; D],
    ) {
        for i in 0..N {
            self.set(i, draw(rng));
        }
        self.log_weights = [0.0; N];
    }

    /// Replaces light particles by copies of heavy ones, and makes the weights equal. `weights` must sum to one.
    pub fn resample<R: Rng + ?Sized>(
        &mut self,
        scheme: Scheme,
        weights: &mut [f32; N],
        rng: &mut R,
    ) {
        self.resample_columns([true; D], scheme, weights, rng);
    }

    /// The same for some of the columns; the others, which say nothing, stay as they are.
    #[inline(always)]
    pub(crate) fn resample_columns<R: Rng + ?Sized>(
        &mut self,
        wanted: [bool; D],
        scheme: Scheme,
        weights: &mut [f32; N],
        rng: &mut R,
    ) {
        // Both columns of weights are about to be equal: until then they serve as memory.
        let ancestors = resample(scheme, weights, &mut self.log_weights, rng);
        for (column, wanted) in self.columns.iter_mut().zip(wanted) {
            if wanted {
                ancestors.gather(column, weights);
            }
        }
        self.log_weights = [0.0; N];
        *weights = [1.0 / N as f32; N];
    }

    /// The state of particle `i`, or `None` when there are fewer particles.
    pub fn get(&self, i: usize) -> Option<[f32; D]> {
        (i < N).then(|| read(&self.columns(), i))
    }

    /// Moves particle `i`; does nothing when there are fewer particles.
    pub fn set(&mut self, i: usize, state: [f32; D]) {
        write(&mut self.columns_mut(), i, state);
    }

    /// One column per dimension.
    pub fn columns(&self) -> [&[f32]; D] {
        self.columns.each_ref().map(|column| column.as_slice())
    }

    /// One column per dimension, to move the particles.
    pub fn columns_mut(&mut self) -> [&mut [f32]; D] {
        self.columns.each_mut().map(|column| column.as_mut_slice())
    }

    /// Natural log-weights with an arbitrary common offset.
    pub fn log_weights(&self) -> &[f32] {
        &self.log_weights
    }

    /// Natural log-weights, to change them.
    pub fn log_weights_mut(&mut self) -> &mut [f32] {
        &mut self.log_weights
    }
}

impl<const D: usize, const N: usize> Default for Particles<D, N> {
    fn default() -> Self {
        Self::new()
    }
}

/// Row `i` of the columns; zero where a column is shorter.
#[inline(always)]
pub fn read<const D: usize>(columns: &[&[f32]; D], i: usize) -> [f32; D] {
    columns.map(|column| column.get(i).copied().unwrap_or(0.0))
}

/// Replaces row `i` of the columns; leaves shorter columns as they are.
#[inline(always)]
pub fn write<const D: usize>(columns: &mut [&mut [f32]; D], i: usize, state: [f32; D]) {
    for (column, value) in columns.iter_mut().zip(state) {
        if let Some(place) = column.get_mut(i) {
            *place = value;
        }
    }
}

persist!(impl[const D: usize, const N: usize] Particles<D, N> as "Particles"(D, N) { columns, log_weights });
