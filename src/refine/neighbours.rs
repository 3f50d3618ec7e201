//! Which particles are within reach of which, in time about proportional to their number.
//!
//! Space is tiled, in the first two dimensions, by squares a little wider than the reach, and every square is
//! given one of 16 x 16 cells, over and over like the pattern of a wallpaper. What is within reach is then in
//! the same cell or one of the eight around it, and one distance settles whether it is. There is no edge and
//! so no outlier that could spoil the grid: particles 16 squares apart share a cell, and know each other only
//! as a comparison in vain. A state of one dimension has 256 cells in a row.

use super::lengths::Scale;
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
        mates: &'a mut [Mate<D>],
        cells: &'a mut [u32; CELLS + 1],
    ) -> Self {
        let particles = population.len().min(mates.len());
        let mates = mates.get_mut(..particles).unwrap_or_default();
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

    /// Every particle with those of the cells around it.
    pub(super) fn iter(&self) -> impl Iterator<Item = (&'a Mate<D>, Around<'a, D>)> {
        (0..=u8::MAX).flat_map(|cell| {
            let around = self.around(cell);
            self.span(cell, cell).iter().map(move |mate| (mate, around))
        })
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
                let mut offset = mate.position;
                let mut square = 0.0;
                for (offset, eye) in offset.iter_mut().zip(eye.position) {
                    *offset -= eye;
                    square += *offset * *offset;
                }
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
