//! Which particles are within reach of which, in time about proportional to their number.
//!
//! Space is tiled, in the first two dimensions, by squares a little wider than the reach, and every square is
//! given one of 16 x 16 cells, over and over like the pattern of a wallpaper. What is within reach is then in
//! the same cell or one of the eight around it, and one distance settles whether it is. There is no edge and
//! so no outlier that could spoil the grid: particles 16 squares apart share a cell, and know each other only
//! as a comparison in vain. A state of one dimension has 256 cells in a row.

use super::lengths::{Scale, difference, dot};
use super::population::Population;
use crate::model::Likelihood;

pub(super) const CELLS: usize = 256;

/// A particle as it was when the grid was made.
#[derive(Debug, Clone, Copy)]
pub(super) struct Mate<const D: usize> {
    /// In the units of the scale.
    pub(super) position: [f32; D],
    pub(super) log_density: f32,
    pub(super) index: u32,
}

impl<const D: usize> Mate<D> {
    pub(super) const NONE: Self = Self {
        position: [0.0; D],
        log_density: f32::NEG_INFINITY,
        index: 0,
    };
}

/// Memory to sort a cloud by cells in.
#[derive(Debug)]
pub(super) struct Grid<'a, const D: usize> {
    pub(super) mates: &'a mut [Mate<D>],
    pub(super) cells: &'a mut [u32; CELLS + 1],
}

/// A cloud, sorted by cells.
pub(super) struct Neighbours<'a, const D: usize> {
    mates: &'a [Mate<D>],
    /// Where each cell begins among the mates, and the last one ends.
    cells: &'a [u32; CELLS + 1],
    reach_squared: f32,
}

/// The mates of up to nine cells in one piece or two for each row.
pub(super) type Around<'a, const D: usize> = [&'a [Mate<D>]; 6];

impl<'a, const D: usize> Neighbours<'a, D> {
    /// Sorts the population by counting, its order within a cell kept.
    pub(super) fn new<T: Likelihood<D>>(
        population: &Population<'_, '_, D, T>,
        scale: &Scale<D>,
        reach: f32,
        grid: &'a mut Grid<'_, D>,
    ) -> Self {
        let cells = &mut *grid.cells;
        let particles = population.len().min(grid.mates.len());
        let mates = grid.mates.get_mut(..particles).unwrap_or_default();
        let tiles = Tiles::new(scale.measure(population.state(0)), reach);
        cells.fill(0);
        for i in 0..particles {
            let cell = tiles.cell(&scale.measure(population.state(i)));
            cells[usize::from(cell)] += 1;
        }
        let mut end = 0;
        for cell in cells.iter_mut() {
            end += *cell;
            *cell = end;
        }
        for i in (0..particles).rev() {
            let position = scale.measure(population.state(i));
            let place = &mut cells[usize::from(tiles.cell(&position))];
            *place -= 1;
            if let Some(mate) = mates.get_mut(*place as usize) {
                *mate = Mate {
                    position,
                    log_density: population.log_density(i),
                    index: i as u32,
                };
            }
        }
        Self {
            mates,
            cells,
            reach_squared: reach * reach,
        }
    }

    /// The particles of each cell, with those around them.
    pub(super) fn cells(&self) -> impl Iterator<Item = (&'a [Mate<D>], Around<'a, D>)> {
        (0..=u8::MAX).map(|cell| (self.span(cell, cell), self.around(cell)))
    }

    /// Calls `visit` with every mate within reach of `eye`, itself included, its offset and the square of its distance.
    #[inline(always)]
    pub(super) fn within_reach(
        &self,
        eye: &Mate<D>,
        around: &Around<'a, D>,
        mut visit: impl FnMut(&'a Mate<D>, [f32; D], f32),
    ) {
        for block in around {
            for mate in *block {
                let offset = difference(mate.position, eye.position);
                let square = dot(offset, offset);
                if square <= self.reach_squared {
                    visit(mate, offset, square);
                }
            }
        }
    }

    fn around(&self, cell: u8) -> Around<'a, D> {
        let last = Tiles::<D>::LAST_COLUMN;
        let (row, column) = (cell & !last, cell & last);
        // Above and below the outermost rows are the opposite ones: the sum wraps.
        let rows: &[u8] = if D == 1 { &[0] } else { &[0xf0, 0, 0x10] };
        let mut around = [[].as_slice(); 6];
        for (pieces, offset) in around.as_chunks_mut::<2>().0.iter_mut().zip(rows) {
            let row = row.wrapping_add(*offset);
            let span = |from: u8, to: u8| self.span(row | from, row | to);
            *pieces = if column == 0 {
                [span(0, 1), span(last, last)]
            } else if column == last {
                [span(last - 1, last), span(0, 0)]
            } else {
                [span(column - 1, column + 1), &[]]
            };
        }
        around
    }

    /// The mates of the cells from `first` to `last`.
    #[inline(always)]
    fn span(&self, first: u8, last: u8) -> &'a [Mate<D>] {
        let from = self.cells[usize::from(first)] as usize;
        let to = self.cells[usize::from(last) + 1] as usize;
        self.mates.get(from..to).unwrap_or_default()
    }
}

/// How the plane is tiled.
struct Tiles<const D: usize> {
    origin: [f32; D],
    /// One over the side of a tile.
    inverse: f32,
}

impl<const D: usize> Tiles<D> {
    /// Columns are counted in the low bits of a cell's number, rows in the high ones.
    const LAST_COLUMN: u8 = if D == 1 { 255 } else { 15 };

    fn new(origin: [f32; D], reach: f32) -> Self {
        // A fiftieth wider than the reach, which is more than what rounding moves a tile's border by.
        Self {
            origin,
            inverse: 1.0 / (1.02 * reach),
        }
    }

    #[inline(always)]
    fn cell(&self, position: &[f32; D]) -> u8 {
        // The conversion saturates: from 32,768 tiles away from the origin on, all share a cell. NaN has one as well.
        let tile = |x: f32, origin: f32| ((x - origin) * self.inverse + 32_768.0) as u16 as u8;
        match (position.as_slice(), self.origin.as_slice()) {
            ([x, y, ..], [x0, y0, ..]) => (tile(*y, *y0) << 4) | (tile(*x, *x0) & 15),
            ([x], [x0]) => tile(*x, *x0),
            _ => 0,
        }
    }
}

#[cfg(test)]
mod tests {
    extern crate std;
    use super::*;
    use crate::random::{SeedableRng, Xoshiro128PlusPlus, normal, uniform};
    use crate::refine::Lengths;
    use std::vec;
    use std::vec::Vec;

    /// Asserts that every particle sees exactly those that the definition says, and returns how many it was compared
    /// with on average.
    fn assert_exact<const D: usize>(name: &str, cloud: &[[f32; D]], reach: f32) -> f64 {
        let mut columns: [Vec<f32>; D] =
            core::array::from_fn(|d| cloud.iter().map(|state| state[d]).collect());
        let mut columns = columns.each_mut().map(|column| column.as_mut_slice());
        let target = |state: &[f32; D]| -state[0];
        let mut log_densities = vec![0.0; cloud.len()];
        let population = Population::new(&mut columns, &target, &mut log_densities);
        let mut grid = Grid {
            mates: &mut vec![Mate::NONE; cloud.len()],
            cells: &mut [0; CELLS + 1],
        };
        for lengths in [Lengths::Relative, Lengths::Absolute] {
            let scale = population.scale(lengths, 0..cloud.len());
            let neighbours = Neighbours::new(&population, &scale, reach, &mut grid);
            let mut visited = 0;
            for (cell, around) in neighbours.cells() {
                for eye in cell {
                    visited += 1;
                    let mut seen = Vec::new();
                    neighbours.within_reach(eye, &around, |mate, offset, square| {
                        assert_eq!(dot(offset, offset), square);
                        assert_eq!(
                            mate.log_density,
                            population.log_density(mate.index as usize)
                        );
                        seen.push(mate.index as usize);
                    });
                    seen.sort_unstable();
                    let here = scale.measure(cloud[eye.index as usize]);
                    let by_definition: Vec<usize> = (0..cloud.len())
                        .filter(|j| {
                            let offset = difference(scale.measure(cloud[*j]), here);
                            dot(offset, offset) <= reach * reach
                        })
                        .collect();
                    assert_eq!(seen, by_definition, "{name}, {lengths:?}, reach {reach}");
                }
            }
            assert_eq!(visited, cloud.len());
        }
        let scale = population.scale(Lengths::Relative, 0..cloud.len());
        let neighbours = Neighbours::new(&population, &scale, reach, &mut grid);
        let compared = neighbours.cells().map(|(cell, around)| {
            cell.len() * around.iter().map(|block| block.len()).sum::<usize>()
        });
        compared.sum::<usize>() as f64 / cloud.len() as f64
    }

    fn assert_exact_in<const D: usize>() {
        let mut rng = Xoshiro128PlusPlus::seed_from_u64(81);
        let mut cloud =
            |n: usize, draw: &dyn Fn(&mut Xoshiro128PlusPlus) -> f32| -> Vec<[f32; D]> {
                (0..n)
                    .map(|_| core::array::from_fn(|_| draw(&mut rng)))
                    .collect()
            };
        let normals = cloud(300, &|rng| normal(rng));
        let mut outliers = normals.clone();
        outliers.extend([[1e30; D], [-1e30; D], [1e7; D], [1e7 + 1.0; D], [-3e5; D]]);
        let mut not_numbers = normals.clone();
        not_numbers.extend([[f32::NAN; D], [f32::INFINITY; D], [f32::NEG_INFINITY; D]]);
        let mut first_is_far = vec![[1e9; D]];
        first_is_far.extend(&normals);
        let clouds = [
            ("uniform", cloud(300, &|rng| 10.0 * uniform(rng))),
            ("far from the origin", cloud(300, &|rng| 3e4 + normal(rng))),
            // Distances that are just within reach, or just not.
            (
                "lattice",
                cloud(300, &|rng| (8.0 * uniform(rng)) as u32 as f32 * 0.5),
            ),
            (
                "scattered over a million reaches",
                cloud(300, &|rng| 1e6 * normal(rng).powi(5)),
            ),
            (
                "on tile borders",
                cloud(300, &|rng| ((9.0 * uniform(rng)) as i32 - 4) as f32 * 0.51),
            ),
            ("equal", vec![[7.0; D]; 40]),
            ("one", vec![[7.0; D]]),
            ("none", vec![]),
            ("normal", normals),
            ("outliers", outliers),
            ("not numbers", not_numbers),
            ("first is far", first_is_far),
        ];
        for (name, cloud) in &clouds {
            for reach in [1e-30, 1e-3, 0.1, 0.5, 2.0, 1e4, f32::MAX, f32::INFINITY] {
                assert_exact(name, cloud, reach);
            }
        }
    }

    #[test]
    fn sees_what_the_definition_says() {
        assert_exact_in::<1>();
        assert_exact_in::<2>();
        assert_exact_in::<4>();
    }

    #[test]
    fn comparisons_are_few_whatever_the_outliers() {
        // With a reach of a tenth of a deviation, the three cells of a line hold 88 of 1000 normal particles on average,
        // the nine of the plane 36, both by the normal density and because 16 tiles are narrower than the cloud.
        let mut rng = Xoshiro128PlusPlus::seed_from_u64(82);
        let line: Vec<[f32; 1]> = (0..1000).map(|_| [normal(&mut rng)]).collect();
        let plane: Vec<[f32; 2]> = (0..1000)
            .map(|_| [normal(&mut rng), normal(&mut rng)])
            .collect();
        assert!(assert_exact("line", &line, 0.1) < 100.0);
        assert!(assert_exact("plane", &plane, 0.1) < 45.0);
        let mut with_outlier = plane.clone();
        with_outlier[0] = [3000.0, 3000.0];
        // The outlier makes a deviation a hundred times as long, and the reach what it was.
        assert!(assert_exact("outlier", &with_outlier, 0.001) < 45.0);
    }
}
