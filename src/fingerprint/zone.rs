//! Polygons: rooms, stairwells, areas with a name.

use super::Lattice;
use crate::ConfigError;
use crate::config::require;

/// A polygon with a name: a room, a stairwell, an area that nobody may enter.
///
/// Corners are in order round it, either way, in metres; the last one is joined to the first. A place on an edge that two
/// zones have in common is in exactly one of them, if both state the same ends of that edge.
///
/// ```
/// use foxhunt::fingerprint::Zone;
///
/// const STORE: Zone<'static> = foxhunt::config!(Zone {
///     id: 7,
///     floor: 0,
///     corners: &[[0.0, 0.0], [6.0, 0.0], [6.0, 3.0], [3.0, 3.0], [3.0, 5.0], [0.0, 5.0]],
/// });
/// assert!(STORE.contains([2.0, 4.0]) && !STORE.contains([4.0, 4.0]));
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Zone<'a> {
    /// Its name.
    pub id: u16,
    /// The floor that it is on, counted from 0; 0 on a site of one floor.
    pub floor: u8,
    /// Its corners, three to [`Zone::MAX_CORNERS`].
    pub corners: &'a [[f32; 2]],
}

impl Zone<'_> {
    /// The most corners.
    pub const MAX_CORNERS: usize = 64;
    /// The smallest area in square metres: less is a mistake.
    pub const MIN_AREA_M2: f32 = 0.01;

    /// Checks every field. That edges do not cross is not checked: what they enclose an even number of times is outside.
    ///
    /// # Errors
    /// The first field that is out of its range.
    pub const fn check(&self) -> Result<(), ConfigError> {
        require!(
            self.corners.len() >= 3 && self.corners.len() <= Self::MAX_CORNERS,
            "corners must be from 3 to 64"
        );
        let mut corner = 0;
        while corner < self.corners.len() {
            let [x, y] = self.corners[corner];
            require!(
                x.abs() <= Lattice::MAX_COORDINATE_M && y.abs() <= Lattice::MAX_COORDINATE_M,
                "corners must be finite, and less than 1000 km from the origin"
            );
            corner += 1;
        }
        require!(
            self.area_m2() >= Self::MIN_AREA_M2,
            "corners must enclose a square decimetre or more"
        );
        Ok(())
    }

    /// Its area in square metres.
    pub const fn area_m2(&self) -> f32 {
        let mut twice = 0.0;
        let mut corner = 1;
        // As triangles from the first corner, so that nothing is lost far from the origin.
        while corner + 1 < self.corners.len() {
            let [x0, y0] = self.corners[0];
            let [[xa, ya], [xb, yb]] = [self.corners[corner], self.corners[corner + 1]];
            twice += (xa - x0) * (yb - y0) - (xb - x0) * (ya - y0);
            corner += 1;
        }
        0.5 * twice.abs()
    }

    /// Whether a place is in it; false for NaN.
    pub fn contains(&self, [x, y]: [f32; 2]) -> bool {
        let Some(mut from) = self.corners.last() else {
            return false;
        };
        let mut is_inside = false;
        for to in self.corners {
            // An edge that two zones have in common is taken upwards in both, so that rounding is the same.
            let [low, high] = if from[1] < to[1] {
                [from, to]
            } else {
                [to, from]
            };
            if low[1] <= y && y < high[1] {
                let edge = (y - low[1]) * (high[0] - low[0]);
                is_inside ^= (x - low[0]) * (high[1] - low[1]) < edge;
            }
            from = to;
        }
        is_inside
    }
}

#[cfg(test)]
mod tests {
    extern crate std;
    use super::*;
    use proptest::prelude::*;

    const HALL: Zone = Zone {
        id: 1,
        floor: 0,
        corners: &[[0.0, 0.0], [4.0, 1.0], [5.0, 4.0], [1.0, 5.0]],
    };

    #[test]
    fn a_wrong_zone_is_named() {
        let far = [[0.0, 0.0], [2e6, 0.0], [0.0, 1.0]];
        let flat = [[0.0, 0.0], [1.0, 1.0], [2.0, 2.0]];
        let none = [[0.0, 0.0], [1.0, f32::NAN], [0.0, 1.0]];
        for corners in [&far[..], &flat, &none, &far[..2], &[[0.0; 2]; 65]] {
            let zone = Zone { corners, ..HALL };
            assert_eq!(zone.check().unwrap_err().field(), "corners");
        }
        assert_eq!(HALL.check(), Ok(()));
        assert!((HALL.area_m2() - 16.0).abs() < 1e-5);
    }

    #[test]
    fn no_place_is_in_a_zone_of_no_corners_and_none_is_nowhere() {
        assert!(
            !Zone {
                corners: &[],
                ..HALL
            }
            .contains([0.0; 2])
        );
        for place in [[f32::NAN, 1.0], [1.0, f32::NAN], [f32::INFINITY, 1.0]] {
            assert!(!HALL.contains(place));
        }
    }

    /// At the height of a corner, and beside the edge from one corner to the next, which is at x = 4 + (y - 1) / 3.
    #[test]
    fn places_beside_corners_and_edges() {
        for (place, inside) in [
            ([3.0, 4.0], true),
            ([3.0, 1.0], true),
            ([4.2, 2.0], true),
            ([4.6, 2.0], false),
            ([5.5, 4.0], false),
        ] {
            assert_eq!(HALL.contains(place), inside, "{place:?}");
        }
    }

    proptest! {
        /// The plane about the hall, in three pieces that meet: every place is in exactly one.
        #[test]
        fn a_place_is_in_one_of_two_zones_that_meet(
            x in -1.0..6.0f32, y in -1.0..6.0f32, fraction in 0.0..=1.0f32, edge in 0..4usize
        ) {
            let [a, b, c, d] = [HALL.corners[0], HALL.corners[1], HALL.corners[2], HALL.corners[3]];
            let first = Zone { corners: &[a, b, c], ..HALL };
            let second = Zone { corners: &[d, a, c], ..HALL };
            let others = [[a, b], [b, c], [c, d], [a, c]][edge];
            let on_edge = [0, 1].map(|axis| {
                others[0][axis] + fraction * (others[1][axis] - others[0][axis])
            });
            for place in [[x, y], on_edge] {
                let count = u8::from(first.contains(place)) + u8::from(second.contains(place));
                prop_assert_eq!(count, u8::from(HALL.contains(place)), "{:?}", place);
            }
        }
    }
}
