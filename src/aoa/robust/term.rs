//! The likelihood of one bearing that may be direct, mirrored or an outlier, with its bias.

use core::f32::consts::{FRAC_PI_2, FRAC_PI_4, PI, TAU};

use crate::aoa::core::{BLOCK, Block};
use crate::aoa::{Mixture, Observation};
use crate::math::{atan_coarse, atan2, exp, exp_of_weight, ln, sin_cos, sqrt, wrap};

/// Metres east and north; the logarithm of the scale of errors in its prior sigmas; and the numbers of the biases in theirs.
pub(super) type State<const D: usize> = [f32; D];

/// Numbers of a state with one bias.
pub(super) const PLAIN: usize = 4;
/// Where the scale is in a state.
pub(super) const SCALE: usize = 2;
/// Where the biases begin.
pub(super) const BIASES: usize = 3;

/// Odds of a bearing not being an outlier, which are its likelihood but for a factor and a summand that no place changes:
/// that is `outlier / (2 pi) (1 + odds)`.
///
/// The direct and the mirrored peak are half a circle apart, so only the nearer counts: the bearing is a line, on either
/// side of which another rate applies, and the odds are one exponential.
#[derive(Debug, Clone, Copy)]
pub(super) struct Term<const D: usize> {
    position: [f32; 2],
    sin: f32,
    cos: f32,
    /// -1 / (2 sigma^2).
    curvature: f32,
    /// Logarithm of the odds of no error, in front of the receiver and behind it.
    direct: f32,
    mirrored: f32,
    /// What it counts for beside bearings that have a part of its error, as a fraction: the power of its odds.
    worth: f32,
    /// No other bearing of its place follows.
    is_last_of_place: bool,
    /// Number of the array that took it.
    station: u8,
    /// How many readings it has, beside that of its place which has most, of 255.
    fraction: u8,
    /// That it is the right one of the bearings of its reading, of 255.
    probability: u8,
    /// Derivatives of its error by the numbers of a state, in radians: those that place and scale have are zero.
    features: State<D>,
}

/// Mean and covariance of place and bias, of those of a state with one bias.
pub(super) fn without_scale(
    mean: &State<PLAIN>,
    [x, y, _, bias]: &[State<PLAIN>; PLAIN],
) -> ([f32; 3], [[f32; 3]; 3]) {
    let of = |[x, y, _, bias]: &State<PLAIN>| [*x, *y, *bias];
    (of(mean), [x, y, bias].map(of))
}

/// What the scale of a state does to the errors of bearings.
#[derive(Clone, Copy)]
pub(super) struct Width {
    /// Logarithm of the height of their density.
    pub(super) log_height: f32,
    /// Their precision.
    pub(super) precision: f32,
}

impl Width {
    #[inline(never)]
    pub(super) fn new<const D: usize>(scale_sigma: f32, state: &State<D>) -> Self {
        let log_height = -scale_sigma * state[SCALE];
        Self {
            log_height,
            precision: exp(2.0 * log_height),
        }
    }

    /// How many times as large as expected the errors are.
    pub(super) fn scale(&self) -> f32 {
        exp(-self.log_height)
    }
}

/// What is computed of a block of states, of one bearing after the other. Side by side, so that one register points at all.
pub(super) struct Lanes {
    /// Logarithms of the heights of the densities of errors, and their precisions.
    pub(super) log_heights: [f32; BLOCK],
    pub(super) precisions: [f32; BLOCK],
    /// Squares of the errors, and the logarithms of the odds of none.
    squares: [f32; BLOCK],
    levels: [f32; BLOCK],
    /// Odds that the bearing is no outlier.
    pub(super) odds: [f32; BLOCK],
    /// Products of such odds of several bearings.
    pub(super) products: [f32; BLOCK],
}

impl Lanes {
    pub(super) const START: Self = Self {
        log_heights: [0.0; BLOCK],
        precisions: [1.0; BLOCK],
        squares: [0.0; BLOCK],
        levels: [0.0; BLOCK],
        odds: [0.0; BLOCK],
        products: [1.0; BLOCK],
    };
}

/// A bearing as a line, seen from a state.
#[derive(Clone, Copy)]
pub(super) struct Line {
    /// Expected less measured direction of the line, bias included, in radians.
    pub(super) error: f32,
    pub(super) mirrored: bool,
}

/// Keeps the ratio finite for a particle that sits on the receiver.
const TINY_M: f32 = 1e-7;

/// What one bearing says of a state.
pub(super) struct Reading {
    pub(super) line: Line,
    pub(super) odds: f32,
    /// What it tells of the direction if it is no outlier, in 1 / rad^2.
    pub(super) precision: f32,
    /// What it counts for, as a fraction.
    pub(super) worth: f32,
}

impl Reading {
    /// Counts the bearing for as much as it is no outlier.
    pub(super) fn count(&self, counts: &mut Mixture, fitted: f32) {
        if self.line.mirrored {
            counts.mirrored += fitted;
        } else {
            counts.direct += fitted;
        }
    }
}

impl<const D: usize> Term<D> {
    /// Of an error with this variance, in square radians.
    #[inline(never)]
    pub(super) fn new(observation: &Observation, rates: &Mixture, variance: f32) -> Self {
        let (sin, cos) = sin_cos(observation.bearing().radians());
        let peak = sqrt(TAU) / (sqrt(variance) * rates.outlier);
        Self {
            position: observation.position(),
            sin,
            cos,
            curvature: -0.5 / variance,
            direct: ln(peak * rates.direct),
            mirrored: ln(peak * rates.mirrored),
            worth: 1.0,
            is_last_of_place: false,
            station: observation.station(),
            fraction: u8::MAX,
            probability: u8::MAX,
            features: [0.0; D],
        }
    }

    /// Of one with so many readings, as a fraction of those of the one of its place that has most.
    pub(super) fn with_fraction(mut self, fraction: f32) -> Self {
        self.fraction = of_255(fraction);
        self
    }

    pub(super) const fn ends_place(&mut self) {
        self.is_last_of_place = true;
    }

    pub(super) const fn station(&self) -> u8 {
        self.station
    }

    pub(super) const fn is_last_of_place(&self) -> bool {
        self.is_last_of_place
    }

    /// The same with sigmas that are so many times as large, and with that of the bias, which then is none.
    #[inline(never)]
    pub(super) fn widened(&self, times: f32, bias_sigma: f32) -> Self {
        let ratio = times * times + bias_sigma * bias_sigma * self.precision() / self.worth;
        let lower = 0.5 * self.worth * ln(ratio);
        Self {
            curvature: self.curvature / ratio,
            direct: self.direct - lower,
            mirrored: self.mirrored - lower,
            features: [0.0; D],
            ..*self
        }
    }

    /// Of a bearing that counts for a fraction of what it tells.
    pub(super) fn with_worth(mut self, worth: f32) -> Self {
        self.worth = worth;
        self.curvature *= worth;
        self.direct *= worth;
        self.mirrored *= worth;
        self
    }

    /// What it counts for among those of several sources, and the bearing as if it counted in full.
    pub(super) fn in_full(&self) -> (f32, Self) {
        let fraction = f32::from(self.fraction) / 255.0;
        (fraction * self.worth, self.with_worth(1.0 / self.worth))
    }

    /// The probability that it is the right one of the bearings of its reading.
    pub(super) fn probability(&self) -> f32 {
        f32::from(self.probability) / 255.0
    }

    /// With its part in the biases, of which it is off by `known` radians for certain.
    #[inline(never)]
    pub(super) fn with_biases(mut self, features: State<D>, known: f32) -> Self {
        self.features = features;
        if known != 0.0 {
            let (sin, cos) = sin_cos(wrap(known));
            (self.sin, self.cos) = (
                self.sin * cos - self.cos * sin,
                self.cos * cos + self.sin * sin,
            );
        }
        self
    }

    pub(super) const fn features(&self) -> &State<D> {
        &self.features
    }

    /// What it tells of the direction if it is no outlier, in 1 / rad^2.
    pub(super) fn precision(&self) -> f32 {
        -2.0 * self.curvature
    }

    /// Of a state with the expected scale and a source there, up to a constant.
    #[inline(never)]
    pub(super) fn log_likelihood(&self, state: &State<D>) -> f32 {
        ln(1.0 + self.odds(self.line(state), 0.0, 1.0))
    }

    /// What the biases of a state add to the error, in radians.
    fn bias(&self, state: &State<D>) -> f32 {
        let pairs = self.features.iter().zip(state).skip(BIASES);
        pairs.map(|(feature, z)| feature * z).sum()
    }

    /// The same of a bearing that has alternatives: of those that lie apart, 1 + a + b is nearly (1 + a) (1 + b).
    pub(super) fn with_probability(mut self, probability: f32) -> Self {
        if probability < 1.0 {
            let log = ln(probability);
            self.direct += log;
            self.mirrored += log;
            self.probability = of_255(probability);
        }
        self
    }

    /// Error of the line and which of its sides the state is on, given its bias in radians. Exact up to half a turn,
    /// beyond which a large bias may push an error: the line's other side is as far then.
    #[inline(always)]
    fn fold(&self, [x, y]: [f32; 2], bias: f32) -> Line {
        let (dx, dy) = (x - self.position[0], y - self.position[1]);
        let along = dx * self.cos + dy * self.sin;
        let across = dy * self.cos - dx * self.sin;
        let (a, b) = (along.abs() + TINY_M, across.abs());
        let angle = FRAC_PI_4 + atan_coarse((b - a) / (b + a));
        let sign = (along.to_bits() ^ across.to_bits()) & 0x8000_0000;
        Line {
            error: f32::from_bits(angle.to_bits() ^ sign) + bias,
            mirrored: along < 0.0,
        }
    }

    #[inline(always)]
    fn odds(&self, line: Line, log_height: f32, precision: f32) -> f32 {
        // At most some 1e9, for sigmas and rates of a thousandth; next to none are none.
        let exponent = self.curvature * precision * (line.error * line.error);
        exp_of_weight(self.level(line) + self.worth * log_height + exponent)
    }

    #[inline(always)]
    fn level(&self, line: Line) -> f32 {
        if line.mirrored {
            self.mirrored
        } else {
            self.direct
        }
    }

    /// The odds at some states.
    #[inline(always)]
    pub(super) fn odds_of_block(&self, states: &Block<D>, lanes: &mut Lanes) {
        // A copy, which no store can change: its fields stay in registers. Two loops, for either needs most of them.
        let term = *self;
        let Lanes {
            log_heights,
            precisions,
            squares,
            levels,
            odds,
            ..
        } = lanes;
        for i in 0..BLOCK {
            let mut bias = term.features[BIASES] * states[BIASES][i];
            let mut d = BIASES + 1;
            while d < D {
                bias += term.features[d] * states[d][i];
                d += 1;
            }
            let line = term.fold([states[0][i], states[1][i]], bias);
            squares[i] = line.error * line.error;
            levels[i] = term.level(line);
        }
        for i in 0..BLOCK {
            let exponent = term.curvature * precisions[i] * squares[i];
            odds[i] = exp_of_weight(levels[i] + term.worth * log_heights[i] + exponent);
        }
    }

    #[inline(never)]
    pub(super) fn line(&self, state: &State<D>) -> Line {
        self.line_of(state)
    }

    #[inline(always)]
    pub(super) fn line_of(&self, state: &State<D>) -> Line {
        self.fold([state[0], state[1]], self.bias(state))
    }

    /// For a source so far away that its direction, the first number of the state, is the same from everywhere.
    #[inline(never)]
    pub(super) fn line_far(&self, state: &State<D>) -> Line {
        let (sin, cos) = sin_cos(wrap(state[0]));
        let (along, across) = (
            cos * self.cos + sin * self.sin,
            sin * self.cos - cos * self.sin,
        );
        let turn = atan2(across, along);
        Line {
            error: fold_angle(turn) + self.bias(state),
            mirrored: along < 0.0,
        }
    }

    #[inline(never)]
    pub(super) fn read(&self, line: &Line, width: &Width) -> Reading {
        self.reading(*line, width)
    }

    #[inline(always)]
    pub(super) fn reading(&self, line: Line, width: &Width) -> Reading {
        Reading {
            line,
            odds: self.odds(line, width.log_height, width.precision),
            precision: self.precision() * width.precision,
            worth: self.worth,
        }
    }

    /// Derivative of the error by the position, in radians a metre.
    #[inline(always)]
    pub(super) fn gradient(&self, state: &State<D>) -> [f32; 2] {
        /// Closer to the receiver, in square metres, the direction turns with every step.
        const NEAREST: f32 = 1e-6;
        let (dx, dy) = (state[0] - self.position[0], state[1] - self.position[1]);
        let inverse = 1.0 / (dx * dx + dy * dy + NEAREST);
        [-dy * inverse, dx * inverse]
    }
}

fn of_255(fraction: f32) -> u8 {
    (fraction * 255.0 + 0.5) as u8
}

/// The direction of a line, in (-pi/2, pi/2], from any angle within a circle.
pub(super) fn fold_angle(angle: f32) -> f32 {
    if angle > FRAC_PI_2 {
        angle - PI
    } else if angle <= -FRAC_PI_2 {
        angle + PI
    } else {
        angle
    }
}
