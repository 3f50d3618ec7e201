//! Where the points of a radio map lie.

use super::MapError;

/// A regular lattice of points in the plane; a tunnel is one row of it.
///
/// Points are counted row by row: along x first, then along y. Their coordinates follow from their numbers, so a map
/// stores none, and the neighbours of a place are found without a search.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Lattice {
    origin: [f32; 2],
    spacing: f32,
    columns: u16,
    rows: u16,
}

impl Lattice {
    /// Largest coordinate of a point, in metres: beyond it an f32 no longer resolves a decimetre.
    pub const MAX_COORDINATE_M: f32 = 1e6;
    /// Most points.
    pub const MAX_POINTS: usize = 1 << 16;

    /// `columns` points along x in each of `rows` rows along y, `spacing` metres apart; the first one at `origin`.
    ///
    /// # Errors
    /// [`MapError::Lattice`] when it has fewer than two or more than [`Lattice::MAX_POINTS`] points, when a coordinate is
    /// not finite or larger than [`Lattice::MAX_COORDINATE_M`], or when the spacing is not positive.
    pub const fn new(
        origin: [f32; 2],
        spacing: f32,
        columns: u16,
        rows: u16,
    ) -> Result<Self, MapError> {
        const fn near(x: f32) -> bool {
            x.abs() <= Lattice::MAX_COORDINATE_M
        }
        let points = columns as u32 * rows as u32;
        let counted = points >= 2 && points <= Self::MAX_POINTS as u32;
        // A spacing below a millimetre is a mistake, and its inverse should be a sane number.
        let spaced = spacing >= 1e-3 && near(spacing);
        let last = [
            origin[0] + spacing * columns as f32,
            origin[1] + spacing * rows as f32,
        ];
        if !(counted
            && spaced
            && near(origin[0])
            && near(origin[1])
            && near(last[0])
            && near(last[1]))
        {
            return Err(MapError::Lattice);
        }
        Ok(Self {
            origin,
            spacing,
            columns,
            rows,
        })
    }

    /// The first point, in metres.
    pub const fn origin(&self) -> [f32; 2] {
        self.origin
    }

    /// Metres from one point to the next, along x and along y.
    pub const fn spacing(&self) -> f32 {
        self.spacing
    }

    /// Points along x.
    pub const fn columns(&self) -> usize {
        self.columns as usize
    }

    /// Points along y.
    pub const fn rows(&self) -> usize {
        self.rows as usize
    }

    /// All points.
    pub const fn points(&self) -> usize {
        self.columns as usize * self.rows as usize
    }

    /// The place of point number `point`, in metres.
    pub fn position(&self, point: usize) -> [f32; 2] {
        let [column, row] = self.cell(point);
        self.place([column as f32, row as f32])
    }

    /// The number of the point nearest to a place, which may be beyond the lattice; for NaN, the first along that axis.
    #[inline(always)]
    pub fn nearest(&self, [x, y]: [f32; 2]) -> usize {
        let along = |coordinate: f32, origin: f32, points: usize| {
            // Saturates; NaN becomes 0.
            let steps = ((coordinate - origin) * self.per_metre() + 0.5) as usize;
            steps.min(points.saturating_sub(1))
        };
        let [x0, y0] = self.origin;
        let column = along(x, x0, self.columns());
        // A tunnel has one row.
        if self.rows() == 1 {
            column
        } else {
            along(y, y0, self.rows()) * self.columns() + column
        }
    }

    /// The number of the point nearest to a place in steps along the axes. It means nothing for a place beyond the lattice.
    #[inline(always)]
    pub(super) fn nearest_to_steps(&self, [x, y]: [f32; 2]) -> usize {
        // Saturates; NaN becomes 0.
        let nearest = |steps: f32| (steps + 0.5) as usize;
        if self.is_plane() {
            nearest(y) * self.columns() + nearest(x)
        } else {
            nearest(x)
        }
    }

    /// One over the spacing.
    pub(super) const fn per_metre(&self) -> f32 {
        1.0 / self.spacing
    }

    /// The axes along which there are several points: two, or one on a map of one row or one column.
    pub const fn axes(&self) -> usize {
        if self.is_plane() { 2 } else { 1 }
    }

    /// Whether there are several points along x and along y. There are along one of them at least.
    pub(super) const fn is_plane(&self) -> bool {
        self.columns > 1 && self.rows > 1
    }

    /// A vector by its components along the axes that have several points: on a map of one column, the first is along y.
    pub(super) const fn along_axes(&self, [first, second]: [f32; 2]) -> [f32; 2] {
        if self.columns > 1 {
            [first, second]
        } else {
            [second, first]
        }
    }

    /// Metres from steps along the axes that have several points.
    #[inline(always)]
    pub(super) fn place_of(&self, [first, second]: [f32; 2]) -> [f32; 2] {
        // Along a line there is no second axis.
        let second = if self.is_plane() { second } else { 0.0 };
        self.place(self.along_axes([first, second]))
    }

    /// Whether it has the points of another one.
    pub(super) const fn is_same(&self, other: &Self) -> bool {
        self.origin[0] == other.origin[0]
            && self.origin[1] == other.origin[1]
            && self.spacing == other.spacing
            && self.columns == other.columns
            && self.rows == other.rows
    }

    /// A place in the cell of a point, in steps, by fractions from 0 to 1 of its sides; a cell at the edge is cut off there.
    pub(super) fn in_cell(&self, point: usize, fractions: [f32; 2]) -> [f32; 2] {
        let along = |number: usize, fraction: f32, points: usize| {
            let last = points.saturating_sub(1) as f32;
            (number as f32 - 0.5 + fraction).clamp(0.0, last)
        };
        let [column, row] = self.cell(point);
        [
            along(column, fractions[0], self.columns()),
            along(row, fractions[1], self.rows()),
        ]
    }

    /// Column and row of a point.
    pub(super) fn cell(&self, point: usize) -> [usize; 2] {
        // There is at least one column, which the compiler does not know.
        let row = point.checked_div(self.columns()).unwrap_or(0);
        [point - row * self.columns(), row]
    }

    /// Metres from columns and rows, whole or not.
    pub(super) fn place(&self, [column, row]: [f32; 2]) -> [f32; 2] {
        [
            self.origin[0] + self.spacing * column,
            self.origin[1] + self.spacing * row,
        ]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn points_are_counted_row_by_row() {
        let lattice = Lattice::new([1.0, -2.0], 0.5, 3, 2).unwrap();
        assert_eq!(lattice.points(), 6);
        assert_eq!(lattice.position(0), [1.0, -2.0]);
        assert_eq!(lattice.position(2), [2.0, -2.0]);
        assert_eq!(lattice.position(3), [1.0, -1.5]);
        assert_eq!(lattice.position(5), [2.0, -1.5]);
    }

    #[test]
    fn the_nearest_point_is_found_within_and_beyond() {
        let lattice = Lattice::new([1.0, -2.0], 0.5, 3, 2).unwrap();
        for point in 0..6 {
            let [x, y] = lattice.position(point);
            assert_eq!(lattice.nearest([x + 0.2, y - 0.2]), point);
        }
        assert_eq!(lattice.nearest([1e30, f32::INFINITY]), 5);
        assert_eq!(lattice.nearest([f32::NEG_INFINITY, f32::NAN]), 0);
    }

    #[test]
    fn impossible_lattices_are_refused() {
        for (origin, spacing, columns, rows) in [
            ([f32::NAN, 0.0], 1.0, 2, 2),
            ([0.0, f32::INFINITY], 1.0, 2, 2),
            ([0.0, 2e6], 1.0, 2, 2),
            ([0.0; 2], 0.0, 2, 2),
            ([0.0; 2], -1.0, 2, 2),
            ([0.0; 2], f32::NAN, 2, 2),
            ([0.0; 2], 1e5, 20, 2),
            ([0.0; 2], 1.0, 1, 1),
            ([0.0; 2], 1.0, 0, 80),
            ([0.0; 2], 1.0, 300, 300),
        ] {
            assert_eq!(
                Lattice::new(origin, spacing, columns, rows),
                Err(MapError::Lattice)
            );
        }
    }
}
