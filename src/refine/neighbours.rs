//! Which particles are within reach of which, in time about proportional to their number.
//!
//! Space is tiled, in the first two dimensions, by squares a little wider than the reach, and every square is
//! given one of 256 cells, over and over like the pattern of a wallpaper: the next cell to its neighbour on the right,
//! the sixteenth from it to the one above. What is within reach is then in the same cell or one of the eight around
//! it, and one distance settles whether it is. There is no edge and so no outlier that could spoil the grid:
//! particles 16 squares apart are in the same cell, and know each other only as a comparison in vain.

use core::ops::Range;

use super::lengths::Scale;
use super::population::Population;
use crate::math::ROUND;
use crate::math::vector::{difference, square};
use crate::model::Likelihood;
use crate::particles::read;

const CELLS: usize = 256;

/// Cells from one row to the next.
const ROW: u8 = 16;

/// A particle as it was when the grid was made.
#[derive(Debug, Clone, Copy)]
pub(super) struct Mate<const D: usize> {
    /// In the units of the scale.
    pub(super) position: [f32; D],
    pub(super) log_density: f32,
    pub(super) index: u16,
    /// How many it has met.
    pub(super) met: u16,
    /// Sum of their offsets.
    pub(super) offsets: [f32; D],
}

impl<const D: usize> Mate<D> {
    /// None yet, in bits that are all zero.
    pub(super) const NONE: Self = Self {
        position: [0.0; D],
        log_density: 0.0,
        index: 0,
        met: 0,
        offsets: [0.0; D],
    };
}

/// Memory to sort a cloud by cells in.
#[derive(Debug, Clone)]
pub(super) struct Grid<const D: usize, const N: usize> {
    mates: [Mate<D>; N],
    cells: [u32; CELLS + 1],
}

impl<const D: usize, const N: usize> Grid<D, N> {
    /// In bits that are all zero.
    pub(super) const EMPTY: Self = Self {
        mates: [Mate::NONE; N],
        cells: [0; CELLS + 1],
    };
}

/// A cloud, sorted by cells.
pub(super) struct Neighbours<'a, const D: usize> {
    mates: &'a mut [Mate<D>],
    /// Where each cell begins among the mates, and the last one ends.
    cells: &'a [u32; CELLS + 1],
    tiles: Tiles<D>,
    reach_squared: f32,
}

/// The mates of up to nine cells, in one piece or two for each row.
pub(super) type Around<'a, const D: usize> = [&'a [Mate<D>]; 6];

impl<'a, const D: usize> Neighbours<'a, D> {
    /// Sorts the population by counting, its order within a cell kept.
    pub(super) fn new<const N: usize, T: Likelihood<D>>(
        population: &Population<'_, '_, D, T>,
        scale: &Scale<D>,
        reach: f32,
        grid: &'a mut Grid<D, N>,
    ) -> Self {
        let cells = &mut grid.cells;
        let particles = population.len().min(grid.mates.len());
        let mates = grid.mates.get_mut(..particles).unwrap_or_default();
        let tiles = Tiles::new(scale.measure(population.state(0)), reach);
        let columns = population.columns();
        cells.fill(0);
        for i in 0..particles {
            let cell = tiles.cell(&scale.measure(read(&columns, i)));
            cells[usize::from(cell)] += 1;
        }
        let mut end = 0;
        for cell in cells.iter_mut() {
            end += *cell;
            *cell = end;
        }
        for i in (0..particles).rev() {
            let position = scale.measure(read(&columns, i));
            let place = &mut cells[usize::from(tiles.cell(&position))];
            *place -= 1;
            if let Some(mate) = mates.get_mut(*place as usize) {
                *mate = Mate {
                    position,
                    log_density: population.log_density(i),
                    index: i as u16,
                    ..Mate::NONE
                };
            }
        }
        Self {
            mates,
            cells,
            tiles,
            reach_squared: reach * reach,
        }
    }

    /// The particles, cell by cell.
    pub(super) fn mates(&self) -> &[Mate<D>] {
        self.mates
    }

    /// The best of all that `eye` sees, itself included.
    pub(super) fn best<'b>(&'b self, eye: &'b Mate<D>) -> &'b Mate<D> {
        let mut best = eye;
        let around = self.around(self.tiles.cell(&eye.position));
        self.within_reach(eye, &around, |mate, _, _| {
            if mate.log_density > best.log_density {
                best = mate;
            }
        });
        best
    }

    /// The particles of each cell, with those around them.
    pub(super) fn cells(&self) -> impl Iterator<Item = (&[Mate<D>], Around<'_, D>)> {
        (0..=u8::MAX).map(|cell| {
            let own = self.cell(cell);
            (self.mates.get(own).unwrap_or_default(), self.around(cell))
        })
    }

    /// Calls `visit` with every mate within reach of `eye`, itself included, its offset and the square of its distance.
    #[inline(always)]
    pub(super) fn within_reach<'b>(
        &'b self,
        eye: &Mate<D>,
        around: &Around<'b, D>,
        mut visit: impl FnMut(&'b Mate<D>, [f32; D], f32),
    ) {
        for block in around {
            for mate in *block {
                let offset = difference(mate.position, eye.position);
                let distance_squared = square(offset);
                if distance_squared <= self.reach_squared {
                    visit(mate, offset, distance_squared);
                }
            }
        }
    }

    /// Lets every two particles that are within reach meet: each counts the other, and adds its offset.
    #[inline(never)]
    pub(super) fn meet(&mut self) {
        for cell in 0..=u8::MAX {
            // Half of what is around a cell: each of the others has it in its own half.
            let own = self.cell(cell);
            let [right, wrapped] = self.span(cell, cell.wrapping_add(1));
            let mut group = self.mates.get_mut(right).unwrap_or_default();
            for _ in own.clone() {
                let Some((eye, others)) = group.split_first_mut() else {
                    break;
                };
                eye.meet(others, self.reach_squared);
                group = others;
            }
            let [above, above_wrapped] = self.row_above(cell);
            for block in [above, wrapped, above_wrapped] {
                if block.is_empty() {
                    continue;
                }
                if let Ok([eyes, others]) = self.mates.get_disjoint_mut([own.clone(), block]) {
                    for eye in eyes {
                        eye.meet(others, self.reach_squared);
                    }
                }
            }
        }
    }

    fn around(&self, cell: u8) -> Around<'_, D> {
        let row = |offset: u8| {
            let middle = cell.wrapping_add(offset);
            self.span(middle.wrapping_sub(1), middle.wrapping_add(1))
        };
        let rows = if D == 1 {
            [const { [0..0, 0..0] }, row(0), const { [0..0, 0..0] }]
        } else {
            [row(ROW.wrapping_neg()), row(0), row(ROW)]
        };
        let [[a, b], [c, d], [e, f]] = rows;
        [a, b, c, d, e, f].map(|range| self.mates.get(range).unwrap_or_default())
    }

    fn row_above(&self, cell: u8) -> [Range<usize>; 2] {
        if D == 1 {
            return [0..0, 0..0];
        }
        self.span(cell.wrapping_add(ROW - 1), cell.wrapping_add(ROW + 1))
    }

    /// Where the mates of a cell are.
    #[inline(always)]
    fn cell(&self, cell: u8) -> Range<usize> {
        let cell = usize::from(cell);
        self.cells[cell] as usize..self.cells[cell + 1] as usize
    }

    /// Where the mates of the cells from `first` to `last` are, which may begin anew after the last cell of all.
    #[inline(always)]
    fn span(&self, first: u8, last: u8) -> [Range<usize>; 2] {
        let (from, to) = (self.cell(first).start, self.cell(last).end);
        if first <= last {
            [from..to, 0..0]
        } else {
            [from..self.mates.len(), 0..to]
        }
    }
}

impl<const D: usize> Mate<D> {
    /// Meets those of a group that are within reach.
    #[inline(always)]
    fn meet(&mut self, group: &mut [Self], reach_squared: f32) {
        // In registers, as long as the group lasts.
        let (mut met, mut offsets) = (self.met, self.offsets);
        let position = self.position;
        let mut meet = |mate: &mut Self| {
            let offset = difference(mate.position, position);
            if square(offset) <= reach_squared {
                met = met.wrapping_add(1);
                mate.met = mate.met.wrapping_add(1);
                for ((a, b), x) in offsets.iter_mut().zip(&mut mate.offsets).zip(offset) {
                    *a += x;
                    *b -= x;
                }
            }
        };
        let (blocks, rest) = group.as_chunks_mut::<4>();
        for [a, b, c, d] in blocks {
            meet(a);
            meet(b);
            meet(c);
            meet(d);
        }
        for mate in rest {
            meet(mate);
        }
        (self.met, self.offsets) = (met, offsets);
    }
}

/// How the plane is tiled.
struct Tiles<const D: usize> {
    origin: [f32; D],
    /// One over the side of a tile.
    inverse: f32,
}

impl<const D: usize> Tiles<D> {
    fn new(origin: [f32; D], reach: f32) -> Self {
        // A fiftieth wider than the reach, which is more than what rounding moves a tile's border by.
        Self {
            origin,
            inverse: 1.0 / (1.02 * reach),
        }
    }

    #[inline(always)]
    fn cell(&self, position: &[f32; D]) -> u8 {
        let tile = |x: f32, origin: f32| nearest((x - origin) * self.inverse);
        match (position.as_slice(), self.origin.as_slice()) {
            ([x, y, ..], [x0, y0, ..]) => {
                tile(*y, *y0).wrapping_mul(ROW).wrapping_add(tile(*x, *x0))
            }
            ([x], [x0]) => tile(*x, *x0),
            _ => 0,
        }
    }
}

/// The nearest integer, modulo 256. From 32,768 away from zero on, where rounding moves borders by more than tiles
/// have to spare, all are zero; so is NaN.
#[inline(always)]
fn nearest(x: f32) -> u8 {
    // The last bits of the sum are the integer.
    let shifted = (x + ROUND).to_bits().wrapping_sub(ROUND.to_bits() - 32_768);
    if shifted < 65_536 { shifted as u8 } else { 0 }
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
        let mut grid = Grid::<D, 1000>::EMPTY;
        for lengths in [Lengths::Relative, Lengths::Absolute] {
            let scale = population.scale(lengths, 0..cloud.len());
            let neighbours = Neighbours::new(&population, &scale, reach, &mut grid);
            let mut visited = 0;
            let mut counts = vec![0; cloud.len()];
            for (cell, around) in neighbours.cells() {
                for eye in cell {
                    visited += 1;
                    let mut seen = Vec::new();
                    neighbours.within_reach(eye, &around, |mate, offset, distance_squared| {
                        assert_eq!(square(offset), distance_squared);
                        assert_eq!(
                            mate.log_density,
                            population.log_density(usize::from(mate.index))
                        );
                        seen.push(usize::from(mate.index));
                    });
                    seen.sort_unstable();
                    let here = scale.measure(cloud[usize::from(eye.index)]);
                    let by_definition: Vec<usize> = (0..cloud.len())
                        .filter(|j| {
                            let offset = difference(scale.measure(cloud[*j]), here);
                            square(offset) <= reach * reach
                        })
                        .collect();
                    assert_eq!(seen, by_definition, "{name}, {lengths:?}, reach {reach}");
                    let others = seen.iter().filter(|j| **j != usize::from(eye.index));
                    counts[usize::from(eye.index)] = others.count();
                }
            }
            assert_eq!(visited, cloud.len());
            assert_all_meet(name, neighbours, &counts);
        }
        let scale = population.scale(Lengths::Relative, 0..cloud.len());
        let neighbours = Neighbours::new(&population, &scale, reach, &mut grid);
        let compared = neighbours.cells().map(|(cell, around)| {
            cell.len() * around.iter().map(|block| block.len()).sum::<usize>()
        });
        compared.sum::<usize>() as f64 / cloud.len() as f64
    }

    /// Asserts that every particle meets as many others as it sees, and knows the sum of their offsets, and that the best
    /// that it sees is as good as any.
    fn assert_all_meet<const D: usize>(
        name: &str,
        mut neighbours: Neighbours<'_, D>,
        counts: &[usize],
    ) {
        neighbours.meet();
        for (cell, around) in neighbours.cells() {
            for eye in cell {
                let (mut sum, mut size) = ([0.0; D], 0.0);
                let mut best = eye.log_density;
                neighbours.within_reach(eye, &around, |mate, offset, _| {
                    for (sum, x) in sum.iter_mut().zip(offset) {
                        *sum += f64::from(x);
                        size += f64::from(x.abs());
                    }
                    best = best.max(mate.log_density);
                });
                assert_eq!(
                    usize::from(eye.met),
                    counts[usize::from(eye.index)],
                    "{name}"
                );
                assert_eq!(neighbours.best(eye).log_density, best, "{name}");
                // Of numbers that a sum of this many may lose the last digits of.
                let lost = size * 1e-7 * counts.len() as f64;
                let finite = size < f64::from(f32::MAX);
                for (sum, x) in sum.into_iter().zip(eye.offsets) {
                    assert!(
                        !finite || (sum - f64::from(x)).abs() <= lost,
                        "{name}: {sum} {x}"
                    );
                }
            }
        }
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
        // With a reach of a tenth of a sigma, the three cells of a line hold 88 of 1000 normal particles on average,
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
        // The outlier makes sigma a hundred times as long, and the reach what it was.
        assert!(assert_exact("outlier", &with_outlier, 0.001) < 45.0);
    }
}
