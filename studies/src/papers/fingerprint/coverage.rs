//! How often regions hold the truth, and how sure that is.

use std::fmt;

use foxhunt_simulation::random::generator;
use rand::RngExt;

/// Steps of a walk that are drawn together, because their errors are alike.
const BLOCK: usize = 20;
const DRAWS: usize = 1000;

/// Whether regions of 95 % held the truth: by filter seed or walk, then by step.
#[derive(Debug, Clone, Default)]
pub struct Coverage(Vec<Vec<bool>>);

impl Coverage {
    pub fn push(&mut self, walk: Vec<bool>) {
        self.0.push(walk);
    }

    /// All of them in one.
    pub fn pooled(all: &[Self]) -> Self {
        Self(all.iter().flat_map(|of| of.0.iter().cloned()).collect())
    }

    /// The fraction of all steps.
    pub fn value(&self) -> f64 {
        let all = self.0.iter().flatten();
        let (count, held) = all.fold((0.0, 0.0), |(n, sum), held| {
            (n + 1.0, sum + f64::from(u8::from(*held)))
        });
        held / f64::max(count, 1.0)
    }

    /// From where to where the fraction may be, with a probability of 95 %: by drawing blocks of steps, the same in walks of the
    /// same length, because seeds of one walk are no independent walks.
    pub fn interval(&self) -> [f64; 2] {
        let mut lengths: Vec<usize> = self.0.iter().map(Vec::len).collect();
        lengths.sort_unstable();
        lengths.dedup();
        // By length, then by block: how many steps held, and how many there are.
        let blocks: Vec<Vec<[f64; 2]>> = lengths
            .iter()
            .map(|length| {
                let walks: Vec<_> = self.0.iter().filter(|walk| walk.len() == *length).collect();
                let block = |first: usize| {
                    let last = (first + BLOCK).min(*length);
                    let held = walks.iter().flat_map(|walk| &walk[first..last]);
                    let held = held.filter(|held| **held).count() as f64;
                    [held, ((last - first) * walks.len()) as f64]
                };
                (0..*length).step_by(BLOCK).map(block).collect()
            })
            .collect();
        let mut rng = generator(95, 0);
        let mut drawn: Vec<f64> = (0..DRAWS)
            .map(|_| {
                let mut sums = [0.0; 2];
                for blocks in &blocks {
                    for _ in blocks {
                        let block = blocks[rng.random_range(0..blocks.len())];
                        sums = [sums[0] + block[0], sums[1] + block[1]];
                    }
                }
                sums[0] / sums[1]
            })
            .collect();
        drawn.sort_by(f64::total_cmp);
        [drawn[DRAWS / 40], drawn[DRAWS - 1 - DRAWS / 40]]
    }

    /// How far a fraction is from the interval; 0 within.
    pub fn off(&self, fraction: f64) -> f64 {
        let [low, high] = self.interval();
        (low - fraction).max(fraction - high).max(0.0)
    }
}

impl fmt::Display for Coverage {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [low, high] = self.interval().map(|fraction| 100.0 * fraction);
        write!(
            f,
            "regions of 95 % hold the truth in {:.1} % of the steps; by drawing blocks of steps, {low:.1} to {high:.1} %",
            100.0 * self.value()
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_interval_is_about_the_fraction() {
        let mut coverage = Coverage::default();
        for walk in 0..4 {
            coverage.push((0..200).map(|step| (step + walk) % 20 != 0).collect());
        }
        let [low, high] = coverage.interval();
        assert!((coverage.value() - 0.95).abs() < 1e-9);
        assert!(low <= 0.95 && high >= 0.95 && high - low < 0.1);
        assert_eq!(coverage.off(0.95), 0.0);
        assert!(coverage.off(0.5) > 0.4);
    }
}
