//! Bearings that turn out to be outliers, or none, when more is known.

use super::message::Message;
use super::search::{Engine, Happened, Say};
use super::site::rounded;

/// Bearings that are looked at again, the newest ones: each costs a look at every particle.
const NEWEST: usize = 50;
/// The smallest change of a probability that is told.
const CHANGE: f64 = 0.1;

impl Engine {
    /// Looks at the newest bearings of the search again, and tells whose probability has changed.
    pub(super) fn classify_again(&mut self, say: Say) {
        let (hunt, search) = (&self.hunt, self.search);
        let mut changed = Vec::new();
        let from = self.bearings.len().saturating_sub(NEWEST);
        for (index, taken) in self.bearings.iter_mut().enumerate().skip(from) {
            let Some((observation, outlier)) = &mut taken.told else {
                continue;
            };
            if taken.search != search || taken.is_retracted {
                continue;
            }
            let chances = hunt.classify(observation);
            let Some(now) = chances.map(|chances| rounded(chances.outlier.into(), 3)) else {
                continue;
            };
            if outlier.is_none_or(|before| (now - before).abs() >= CHANGE) {
                *outlier = Some(now);
                changed.push((index as u64 + 1, now));
            }
        }
        if !changed.is_empty() {
            say(Happened::Message(Message::Outliers { changed }));
        }
    }
}
