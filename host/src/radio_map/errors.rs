//! How the places of a survey that are left out differ from what the others predict.

use super::{
    cells::{Cells, distance},
    kriging::Kriging,
};
use foxhunt_simulation::survey::Survey;

/// The mean level of each beacon at each place, less what the places outside of its block predict.
pub(super) struct Errors {
    places: Vec<[f64; 2]>,
    /// By place, then by beacon; none where it was not heard.
    errors: Vec<Vec<Option<Error>>>,
    /// Mean square, in dB^2.
    pub squares: f64,
}

#[derive(Clone, Copy)]
struct Error {
    error: f64,
    /// What the fields expect of its square.
    variance: f64,
    /// One over the number of its readings.
    each: f64,
}

/// The variance of the map's error is at least that of rounding, in dB^2.
const LEAST: f64 = 0.25;

impl Errors {
    pub fn new(survey: &Survey, cells: &Cells, blocks: &[Vec<usize>], kriging: &Kriging) -> Self {
        let mut block_of = vec![None; cells.places.len()];
        for (number, block) in blocks.iter().enumerate() {
            for cell in block {
                block_of[*cell] = Some(number);
            }
        }
        let each = survey
            .places
            .iter()
            .zip(&survey.samples)
            .zip(&cells.of_place);
        let errors = each.map(|((place, samples), cell)| {
            let Some(block) = block_of[*cell] else {
                return vec![None; samples.len()];
            };
            let (means, variance) = kriging.without(block, *place);
            let error = |(readings, mean): (&Vec<f64>, &f64)| {
                let n = readings.len() as f64;
                (n > 0.0).then(|| Error {
                    error: readings.iter().sum::<f64>() / n - mean,
                    variance,
                    each: 1.0 / n,
                })
            };
            samples.iter().zip(&means).map(error).collect()
        });
        let mut all = Self {
            places: survey.places.clone(),
            errors: errors.collect(),
            squares: 0.0,
        };
        all.squares = all.mean(|error| error.error * error.error);
        all
    }

    /// Of all; 0 of none.
    fn mean(&self, of: impl Fn(&Error) -> f64) -> f64 {
        let all = self.errors.iter().flatten().flatten();
        let (count, sum) = all.fold((0.0, 0.0), |(n, sum), error| (n + 1.0, sum + of(error)));
        sum / f64::max(count, 1.0)
    }

    pub fn left_out_db(&self) -> f64 {
        self.squares.sqrt()
    }

    /// Standard deviation of what neither the fields nor the noise of packets explain, in dB.
    pub fn sigma_db(&self, packets: f64) -> f64 {
        let rest =
            |error: &Error| error.error * error.error - error.variance - packets * error.each;
        self.mean(rest).max(LEAST).sqrt()
    }

    /// Over which distance the correlation of errors that follow each other falls to 1 / e, in metres: by least squares.
    ///
    /// Not below half of the distance between neighbours, because errors that are shorter cannot be told from those of the
    /// places.
    pub fn length_m(&self, packets: f64, neighbour_m: f64) -> f64 {
        /// Places that follow each other, of which pairs are taken.
        const NEXT: usize = 8;
        const BINS: usize = 24;
        const LENGTHS: i32 = 40;
        let all = self.mean(|error| error.error * error.error - packets * error.each);
        let all = all.max(LEAST);
        // From 5 cm to 20 m.
        let bin = |d: f64| {
            let bin = ((d.max(0.05) / 0.05).ln() / 400f64.ln() * BINS as f64) as usize;
            (bin < BINS).then_some(bin)
        };
        let mut sums = [(0.0, 0.0, 0.0); BINS];
        for (i, (a, at)) in self.errors.iter().zip(&self.places).enumerate() {
            let next = self.errors.iter().zip(&self.places).skip(i + 1).take(NEXT);
            for (b, place) in next {
                let d = distance(*at, *place);
                let Some(bin) = bin(d) else { continue };
                for (a, b) in a.iter().zip(b) {
                    if let (Some(a), Some(b)) = (a, b) {
                        sums[bin].0 += 1.0;
                        sums[bin].1 += d;
                        sums[bin].2 += a.error * b.error;
                    }
                }
            }
        }
        let misfit = |length: f64| -> f64 {
            let of = |(count, distances, products): &(f64, f64, f64)| {
                if *count == 0.0 {
                    return 0.0;
                }
                let expected = all * (-distances / count / length).exp();
                count * (products / count - expected).powi(2)
            };
            sums.iter().map(of).sum()
        };
        // From 10 cm to 10 m.
        let lengths = (0..=LENGTHS).map(|n| 0.1 * 100f64.powf(f64::from(n) / f64::from(LENGTHS)));
        let best = lengths.min_by(|a, b| misfit(*a).total_cmp(&misfit(*b)));
        best.unwrap_or(1.0).max(0.5 * neighbour_m)
    }
}
