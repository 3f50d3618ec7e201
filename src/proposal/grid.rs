//! A transient grid of equal cells that finds the mass of a density by itself.

use super::moments::Moments;
use crate::math::ln;
use crate::math::vector::{difference, plus_scaled};

/// A box of equal cells in one or two dimensions, the last of which runs fastest. The log-densities at the centres
/// of its cells stand in memory that is lent.
#[derive(Debug, Clone, Copy)]
pub(super) struct Grid<const D: usize> {
    low: [f32; D],
    cell: [f32; D],
}

/// Log-densities this far below the largest are left out: one part in ten million.
const NEGLIGIBLE: f32 = 16.0;
/// A grid settles within this many rounds, each of which shrinks it by a quarter or more: a peak may be ten
/// thousand times narrower than the range that is searched for it, and usually takes three.
const ROUNDS: u32 = 12;

/// Cells along each side, for memory of `G` cells.
pub(super) const fn side<const D: usize, const G: usize>() -> usize {
    const { assert!(D == 1 || D == 2, "grids have one or two dimensions") };
    let side = if D == 1 { G } else { G.isqrt() };
    assert!(
        side >= 16 && G <= 1 << 20,
        "a grid has at least 16 cells to a side"
    );
    side
}

/// The box that holds what a transition with this mean and these sigmas may reach: ten sigmas either way, because
/// one-sided noise has long tails.
pub(super) fn reach<const D: usize>(mean: [f32; D], sigmas: [f32; D]) -> ([f32; D], [f32; D]) {
    let at = |sigmas_away: f32| plus_scaled(mean, sigmas_away, sigmas);
    (at(-10.0), at(10.0))
}

impl<const D: usize> Grid<D> {
    pub(super) const NONE: Self = Self {
        low: [0.0; D],
        cell: [0.0; D],
    };

    /// Covers what matters of a density within the box from `low` to `high`, and writes its logarithm into memory.
    ///
    /// Starts with the box and shrinks it around the cells that may hold something. A narrow peak is found even
    /// between the first cells as long as the density rises towards it; two narrow peaks far apart share the cells.
    pub(super) fn fit<const G: usize>(
        low: [f32; D],
        high: [f32; D],
        log_density: impl Fn(&[f32; D]) -> f32,
        memory: &mut [f32; G],
    ) -> Self {
        let side = const { side::<D, G>() } as f32;
        let cell = difference(high, low).map(|length| length / side);
        let mut grid = Self { low, cell };
        grid.evaluate(&log_density, memory);
        for _ in 1..ROUNDS {
            let Some((first, last)) = occupied::<D, G>(memory) else {
                break;
            };
            // With a margin of one cell, in which a peak may hide.
            let extents = last.iter().zip(first).map(|(l, f)| l - f + 3.0);
            if extents.clone().all(|extent| extent > 0.75 * side) {
                break;
            }
            for (((low, cell), first), extent) in grid
                .low
                .iter_mut()
                .zip(&mut grid.cell)
                .zip(first)
                .zip(extents)
            {
                *low += (first - 1.0) * *cell;
                *cell *= extent / side;
            }
            grid.evaluate(&log_density, memory);
        }
        grid
    }

    /// Writes the log-density at the centre of every cell into memory; minus infinity where there is none.
    pub(super) fn evaluate<const G: usize>(
        &self,
        log_density: impl Fn(&[f32; D]) -> f32,
        memory: &mut [f32; G],
    ) {
        for (value, centre) in memory.iter_mut().zip(self.centres::<G>()) {
            let density = log_density(&centre);
            *value = if density < f32::INFINITY {
                density
            } else {
                f32::NEG_INFINITY
            };
        }
    }

    /// The centres of the cells, in their order.
    pub(super) fn centres<const G: usize>(&self) -> impl Iterator<Item = [f32; D]> + use<D, G> {
        let grid = *self;
        places::<D, G>().map(move |place| grid.centre(place))
    }

    /// The centre of the cell at a place, counted along each side.
    pub(super) fn centre(&self, place: [u32; D]) -> [f32; D] {
        let mut centre = place.map(|k| k as f32 + 0.5);
        for ((x, low), cell) in centre.iter_mut().zip(self.low).zip(self.cell) {
            *x = low + *x * cell;
        }
        centre
    }

    /// A point in the cell round `centre`: `part`, from 0 to 1, of the way along each side.
    pub(super) fn within(&self, centre: [f32; D], part: [f32; D]) -> [f32; D] {
        let mut point = centre;
        for ((x, cell), part) in point.iter_mut().zip(self.cell).zip(part) {
            *x += (part - 0.5) * cell;
        }
        point
    }

    /// Natural logarithm of the volume of a cell.
    pub(super) fn ln_cell(&self) -> f32 {
        self.cell.iter().map(|cell| ln(*cell)).sum()
    }

    /// Mass, mean and covariance of the density in memory.
    pub(super) fn moments<const G: usize>(&self, memory: &[f32; G]) -> Moments<D> {
        let mut sum = Moments::NONE;
        for (centre, log_density) in self.centres::<G>().zip(memory) {
            sum.add(&Moments::point(centre), *log_density);
        }
        let mut moments = Moments::NONE;
        moments.add(&sum, self.ln_cell());
        moments
    }
}

/// Places of the cells: as many as fill the box, in their order.
fn places<const D: usize, const G: usize>() -> impl Iterator<Item = [u32; D]> {
    let side = const { side::<D, G>() } as u32;
    let mut place = [0; D];
    (0..side.pow(D as u32)).map(move |_| {
        let here = place;
        for k in place.iter_mut().rev() {
            *k += 1;
            if *k < side {
                break;
            }
            *k = 0;
        }
        here
    })
}

/// First and last place along each axis that may hold a density that is not negligible: one whose value, and the
/// largest difference from a neighbour on top, comes near the largest of all.
fn occupied<const D: usize, const G: usize>(memory: &[f32; G]) -> Option<([f32; D], [f32; D])> {
    let side = const { side::<D, G>() };
    let cells = memory.get(..side.pow(D as u32)).unwrap_or(memory);
    let largest = cells.iter().fold(f32::NEG_INFINITY, |a, b| a.max(*b));
    if largest == f32::NEG_INFINITY {
        return None;
    }
    let (mut first, mut last) = ([f32::INFINITY; D], [f32::NEG_INFINITY; D]);
    for (i, (value, place)) in cells.iter().zip(places::<D, G>()).enumerate() {
        let mut rise = 0.0f32;
        let mut stride = 1;
        for k in place.iter().rev() {
            let before = i.checked_sub(stride).filter(|_| *k > 0);
            let after = (*k + 1 < side as u32).then_some(i + stride);
            for neighbour in before.into_iter().chain(after) {
                let difference = (value - cells.get(neighbour).unwrap_or(value)).abs();
                if difference < f32::INFINITY {
                    rise = rise.max(difference);
                }
            }
            stride *= side;
        }
        if value + rise >= largest - NEGLIGIBLE {
            for ((first, last), k) in first.iter_mut().zip(&mut last).zip(place) {
                *first = first.min(k as f32);
                *last = last.max(k as f32);
            }
        }
    }
    Some((first, last))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn places_fill_the_box() {
        let rows = (0..17).flat_map(|i| (0..17).map(move |k| [i, k]));
        assert!(places::<2, 300>().eq(rows));
    }
}
