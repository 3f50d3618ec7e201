//! A cloud of particles: one column of f32 per dimension of the state.
//!
//! Columns let every pass over the cloud stream through memory and touch only what it needs. Only
//! [`Particles`] carries the number of particles in its type; everything that computes takes slices.

use crate::persist;
use crate::random::Rng;
use crate::resample::Ancestors;

/// `N` particles with a state of `D` dimensions.
#[derive(Debug, Clone)]
pub struct Particles<const D: usize, const N: usize> {
    columns: [[f32; N]; D],
}

impl<const D: usize, const N: usize> Particles<D, N> {
    /// All particles at the origin, in bits that are all zero.
    pub const EMPTY: Self = {
        assert!(D > 0, "a state has dimensions");
        Self {
            columns: [[0.0; N]; D],
        }
    };

    /// Draws the state of every particle from `draw`.
    pub fn initialise<R: Rng + ?Sized>(
        &mut self,
        rng: &mut R,
        mut draw: impl FnMut(&mut R) -> [f32; D],
    ) {
        for i in 0..N {
            self.set(i, draw(rng));
        }
    }

    /// Replaces every particle by its ancestor. `scratch` holds nothing of use before or after.
    #[inline(always)]
    pub fn gather(&mut self, ancestors: &Ancestors<'_>, scratch: &mut [f32; N]) {
        for column in &mut self.columns {
            ancestors.gather(column, scratch);
        }
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

persist!(impl[const D: usize, const N: usize] Particles<D, N> as "Particles"(D, N) { columns });

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_particle_has_its_place_and_none_is_beyond() {
        let mut particles = Particles::<2, 3>::EMPTY;
        for i in 0..4 {
            particles.set(i, [1.0 + i as f32, -2.0]);
        }
        assert_eq!(particles.columns(), [&[1.0, 2.0, 3.0], &[-2.0; 3]]);
        assert_eq!(particles.get(0), Some([1.0, -2.0]));
        assert_eq!(particles.get(2), Some([3.0, -2.0]));
        assert_eq!(particles.get(3), None);
    }
}
