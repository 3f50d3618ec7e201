//! A part of the plane.

use nalgebra::Vector2;

/// A rectangle whose sides point east and north.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Cell {
    pub centre: Vector2<f64>,
    /// Half of its sides.
    pub half: Vector2<f64>,
}

impl Cell {
    pub fn area(&self) -> f64 {
        4.0 * self.half.x * self.half.y
    }

    /// Its halves, cut across this axis.
    pub fn split(mut self, axis: usize) -> [Self; 2] {
        self.half[axis] *= 0.5;
        [-1.0, 1.0].map(|side| {
            let mut part = self;
            part.centre[axis] += side * self.half[axis];
            part
        })
    }
}
