//! The bearings that say something of a cell, where there are biases.

use std::{borrow::Cow, f64::consts::TAU};

use nalgebra::Vector2;

use super::{
    line::View,
    sums::{Known, Sums, Turned},
};

/// Of so many bearings at most both sides are tried: more are left out.
const EITHER: usize = 3;

/// Those that are not left out of the bound.
#[derive(Default)]
pub(super) struct Kept<'a> {
    sums: Sums,
    either: Vec<Either<'a>>,
    left_out: bool,
    /// Sums of the squares of how far turns and errors in the cell can be from those at its centre, in sigmas.
    squares: [f64; 2],
}

/// A bearing that turns from far left to far right within the cell.
struct Either<'a> {
    sigma: f64,
    turns: Cow<'a, [f64]>,
    errors: [f64; 2],
    slope: Vector2<f64>,
    bend: f64,
}

impl<'a> Kept<'a> {
    /// One more, with the biases' turns and their mean, its slope and bend, and how far turns and error can be from those at the
    /// centre.
    pub fn add(
        &mut self,
        view: &View<'a>,
        turns: Cow<'a, [f64]>,
        mean: f64,
        (slope, bend): (Vector2<f64>, f64),
        changes: [f64; 2],
    ) {
        let (sigma, error) = (view.line.sigma, view.error + mean);
        if view.says_something() {
            self.sums.add(sigma, &turns, error, slope, bend);
        } else if view.wraps() && self.either.len() < EITHER {
            self.either.push(Either {
                sigma,
                turns,
                errors: [error, error - TAU * view.error.signum()],
                slope,
                bend,
            });
        } else {
            self.left_out = true;
            return;
        }
        for (square, change) in self.squares.iter_mut().zip(changes) {
            *square += change * change;
        }
    }

    /// With each side of those that have two; none where there are no bearings. What all bearings `known` is used where all are
    /// kept.
    pub fn patterns(&self, known: Option<&Known>) -> Vec<Turned> {
        if self.sums.is_empty() && self.either.is_empty() {
            return Vec::new();
        }
        let with = |pattern: usize| {
            let mut sums = self.sums.clone();
            for (k, one) in self.either.iter().enumerate() {
                let error = one.errors[pattern >> k & 1];
                sums.add(one.sigma, &one.turns, error, one.slope, one.bend);
            }
            let known = known.filter(|_| !self.left_out).cloned();
            let known = known.unwrap_or_else(|| sums.known());
            sums.turned(known)
        };
        (0..1 << self.either.len()).map(with).collect()
    }

    /// How far turns and errors can be from those at the centre, as norms.
    pub fn changes(&self) -> [f64; 2] {
        self.squares.map(f64::sqrt)
    }
}
