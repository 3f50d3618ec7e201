//! What particles do not pass.

use crate::math::sqrt;

/// Where a tag can be.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub enum Walls<'a> {
    /// Wherever the map is.
    #[default]
    None,
    /// A room.
    Box {
        /// Its least coordinates, in metres.
        least: [f32; 2],
        /// Its largest coordinates, in metres.
        most: [f32; 2],
    },
    /// A corridor, in pieces that meet.
    Corridor(&'a [Piece]),
}

/// A straight piece of a corridor.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Piece {
    /// Where its middle line begins, in metres.
    pub from: [f32; 2],
    /// Where it ends.
    pub to: [f32; 2],
    /// From wall to wall, in metres. It ends in half a circle as wide, so that pieces that turn a corner meet.
    pub width: f32,
}

impl Walls<'_> {
    /// Whether a place is within them.
    pub fn contain(&self, [x, y]: [f32; 2]) -> bool {
        match self {
            Self::None => true,
            Self::Box { least, most } => {
                x >= least[0] && x <= most[0] && y >= least[1] && y <= most[1]
            }
            Self::Corridor(pieces) => pieces.iter().any(|piece| piece.contains([x, y])),
        }
    }

    /// Whether one can go straight from a place within them to another: checked every half metre, at up to eight
    /// places.
    pub fn allow(&self, from: [f32; 2], to: [f32; 2]) -> bool {
        const MOST: u32 = 8;
        let Self::Corridor(_) = self else {
            // A box is convex.
            return self.contain(to);
        };
        let way = [to[0] - from[0], to[1] - from[1]];
        let places = ((2.0 * sqrt(way[0] * way[0] + way[1] * way[1])) as u32 + 1).min(MOST);
        (1..=places).all(|place| {
            let fraction = place as f32 / places as f32;
            self.contain([from[0] + fraction * way[0], from[1] + fraction * way[1]])
        })
    }
}

impl Piece {
    fn contains(&self, [x, y]: [f32; 2]) -> bool {
        let along = [self.to[0] - self.from[0], self.to[1] - self.from[1]];
        let [dx, dy] = [x - self.from[0], y - self.from[1]];
        let square = along[0] * along[0] + along[1] * along[1];
        let fraction = if square > 0.0 {
            ((dx * along[0] + dy * along[1]) / square).clamp(0.0, 1.0)
        } else {
            0.0
        };
        let [ox, oy] = [dx - fraction * along[0], dy - fraction * along[1]];
        let half = 0.5 * self.width;
        ox * ox + oy * oy <= half * half
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// East for 20 m, then north.
    const CORNER: Walls = Walls::Corridor(&[
        Piece {
            from: [0.0, 0.0],
            to: [20.0, 0.0],
            width: 2.0,
        },
        Piece {
            from: [20.0, 0.0],
            to: [20.0, 20.0],
            width: 3.0,
        },
    ]);

    #[test]
    fn within() {
        for (place, inside) in [
            ([10.0, 0.9], true),
            ([10.0, 1.1], false),
            ([-0.9, 0.0], true),
            ([-0.8, 0.8], false),
            ([21.0, -1.0], true),
            ([18.6, 10.0], true),
            ([18.4, 10.0], false),
            ([f32::NAN, 0.0], false),
        ] {
            assert_eq!(CORNER.contain(place), inside, "{place:?}");
        }
        let room = Walls::Box {
            least: [0.0, 0.0],
            most: [4.0, 3.0],
        };
        assert!(room.contain([4.0, 0.0]));
        assert!(!room.contain([4.0, 3.1]));
        assert!(Walls::None.contain([1e9, 0.0]));
    }

    #[test]
    fn nobody_cuts_a_corner() {
        assert!(CORNER.allow([15.0, 0.0], [20.0, 0.5]));
        assert!(!CORNER.allow([15.0, 0.0], [20.0, 5.0]));
        assert!(!CORNER.allow([15.0, 0.0], [15.0, 2.0]));
        let piece = Piece {
            from: [3.0, 0.0],
            to: [3.0, 0.0],
            width: 2.0,
        };
        assert!(Walls::Corridor(&[piece]).allow([3.0, 0.0], [3.9, 0.0]));
        assert!(CORNER.allow([20.0, 12.0], [20.0, 18.0]));
    }

    /// Along a piece that rises 4 m in 3, and 0.1 m to either side of its walls.
    #[test]
    fn a_slanting_piece_is_as_wide_and_as_long_as_it_says() {
        let piece = Piece {
            from: [2.0, 3.0],
            to: [8.0, 11.0],
            width: 4.0,
        };
        for (along, across, inside) in [
            (5.0, 1.9, true),
            (5.0, -1.9, true),
            (5.0, 2.1, false),
            (5.0, -2.1, false),
            (-1.9, 0.0, true),
            (-2.1, 0.0, false),
            (11.9, 0.0, true),
            (12.1, 0.0, false),
        ] {
            let place = [
                2.0 + 0.6 * along - 0.8 * across,
                3.0 + 0.8 * along + 0.6 * across,
            ];
            assert_eq!(piece.contains(place), inside, "{along} {across}");
        }
    }

    #[test]
    fn half_a_metre_of_wall_is_not_passed_in_a_step_of_less_than_four() {
        let halves = Walls::Corridor(&[
            Piece {
                from: [0.0, 5.0],
                to: [9.0, 5.0],
                width: 2.0,
            },
            Piece {
                from: [11.5, 5.0],
                to: [20.0, 5.0],
                width: 2.0,
            },
        ]);
        for centimetre in 0..330 {
            let from = 6.65 + 0.01 * centimetre as f32;
            assert!(!halves.allow([from, 5.0], [from + 3.9, 5.0]), "{from}");
        }
    }
}
