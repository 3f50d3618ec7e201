//! The distance of a set of estimates from a set of sources: GOSPA (Rahmathullah, García-Fernández and Svensson 2017),
//! with p = 2 and alpha = 2.

use std::iter::Sum;

use pathfinding::{kuhn_munkres::kuhn_munkres_min, matrix::Matrix};

/// The square of the distance by its parts, in square metres.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Gospa {
    /// Squares of the distances of all estimates from their sources.
    pub localisation: f64,
    /// Half the square of the cutoff for each source without an estimate.
    pub missed: f64,
    /// As much for each estimate without a source.
    pub ghosts: f64,
}

impl Gospa {
    /// The square of the distance.
    pub fn total(&self) -> f64 {
        self.localisation + self.missed + self.ghosts
    }
}

impl Sum for Gospa {
    fn sum<I: Iterator<Item = Self>>(all: I) -> Self {
        all.fold(Self::default(), |sum, one| Self {
            localisation: sum.localisation + one.localisation,
            missed: sum.missed + one.missed,
            ghosts: sum.ghosts + one.ghosts,
        })
    }
}

/// Estimates with the sources that they are nearest to.
#[derive(Debug, Clone, PartialEq)]
pub struct Assignment {
    /// The estimate of each source, if it has one.
    pub estimates: Vec<Option<usize>>,
    /// The distance that comes of it.
    pub gospa: Gospa,
}

impl Assignment {
    /// The best of all: no estimate is farther than `cutoff` from its source.
    pub fn new(sources: &[[f64; 2]], estimates: &[[f64; 2]], cutoff: f64) -> Self {
        let square = |source: usize, estimate: usize| {
            let [x, y] = [0, 1].map(|d| sources[source][d] - estimates[estimate][d]);
            x * x + y * y
        };
        let limit = cutoff * cutoff;
        let pairs = pairs(sources.len(), estimates.len(), &|source, estimate| {
            square(source, estimate) / limit
        });
        let mut chosen = vec![None; sources.len()];
        let mut localisation = 0.0;
        for (source, estimate) in pairs {
            if square(source, estimate) < limit {
                localisation += square(source, estimate);
                chosen[source] = Some(estimate);
            }
        }
        let found = chosen.iter().flatten().count();
        let gospa = Gospa {
            localisation,
            missed: 0.5 * limit * (sources.len() - found) as f64,
            ghosts: 0.5 * limit * (estimates.len() - found) as f64,
        };
        Self {
            estimates: chosen,
            gospa,
        }
    }
}

/// Pairs of the least sum of costs, each at most one, that leave over nothing of the smaller side.
fn pairs(rows: usize, columns: usize, cost: &dyn Fn(usize, usize) -> f64) -> Vec<(usize, usize)> {
    /// Of a cost of one: whole numbers have an order.
    const STEPS: f64 = 1e12;
    if rows > columns {
        let pairs = pairs(columns, rows, &|column, row| cost(row, column));
        return pairs
            .into_iter()
            .map(|(column, row)| (row, column))
            .collect();
    }
    if rows == 0 {
        return Vec::new();
    }
    let weight = |(row, column)| (STEPS * f64::min(cost(row, column), 1.0)) as i64;
    let (_, chosen) = kuhn_munkres_min(&Matrix::from_fn(rows, columns, weight));
    chosen.into_iter().enumerate().collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    const SOURCES: [[f64; 2]; 3] = [[0.0, 0.0], [10.0, 0.0], [20.0, 0.0]];

    #[test]
    fn nothing_is_no_distance_from_nothing() {
        let assignment = Assignment::new(&[], &[], 5.0);
        assert_eq!(assignment.gospa, Gospa::default());
    }

    #[test]
    fn each_part_counts_what_it_says() {
        let estimates = [[10.0, 3.0], [0.0, 4.0], [100.0, 0.0]];
        let Assignment { estimates, gospa } = Assignment::new(&SOURCES, &estimates, 5.0);
        assert_eq!(estimates, [Some(1), Some(0), None]);
        let parts = Gospa {
            localisation: 9.0 + 16.0,
            missed: 12.5,
            ghosts: 12.5,
        };
        assert_eq!(gospa, parts);
        assert_eq!(gospa.total(), 50.0);
    }

    /// The nearest pair first would leave the other one out.
    #[test]
    fn the_sum_of_all_is_least() {
        let estimates = [[4.0, 0.0], [-4.5, 0.0]];
        let assignment = Assignment::new(&[[0.0, 0.0], [8.0, 0.0]], &estimates, 5.0);
        assert_eq!(assignment.estimates, [Some(1), Some(0)]);
        assert_eq!(assignment.gospa.localisation, 16.0 + 20.25);
    }

    #[test]
    fn sets_of_any_size_are_as_far_apart_either_way() {
        let estimates = [
            [1.0, 1.0],
            [9.0, 1.0],
            [19.0, -1.0],
            [0.0, -2.0],
            [50.0, 0.0],
        ];
        for count in 0..=estimates.len() {
            let there = Assignment::new(&SOURCES, &estimates[..count], 5.0).gospa;
            let back = Assignment::new(&estimates[..count], &SOURCES, 5.0).gospa;
            assert_eq!(there.localisation, back.localisation);
            assert_eq!((there.missed, there.ghosts), (back.ghosts, back.missed));
        }
    }

    #[test]
    fn farther_than_the_cutoff_is_missed_and_false() {
        let assignment = Assignment::new(&[[0.0, 0.0]], &[[5.0, 0.1]], 5.0);
        assert_eq!(assignment.estimates, [None]);
        assert_eq!(assignment.gospa.total(), 25.0);
    }
}
