//! The latest bearings.

use heapless::Deque;

use crate::aoa::Observation;

/// How many of them are kept.
pub(super) const RECENT: usize = 32;

#[derive(Debug, Clone)]
pub(super) struct Recent {
    /// The oldest first.
    pub(super) bearings: Deque<Old, RECENT>,
}

#[derive(Debug, Clone, Copy)]
pub(super) struct Old {
    pub(super) observation: Observation,
    /// Seconds since it was taken.
    pub(super) age_s: f32,
    /// Seconds from the one before to it.
    pub(super) seconds: f32,
}

impl Recent {
    pub(super) const fn new() -> Self {
        Self {
            bearings: Deque::new(),
        }
    }

    pub(super) fn clear(&mut self) {
        self.bearings.clear();
    }

    pub(super) fn wait(&mut self, seconds: f32) {
        for old in &mut self.bearings {
            old.age_s += seconds;
        }
    }

    pub(super) fn add(&mut self, observation: Observation, seconds: f32) {
        if self.bearings.is_full() {
            self.bearings.pop_front();
        }
        let _ = self.bearings.push_back(Old {
            observation,
            age_s: 0.0,
            seconds,
        });
    }

    pub(super) fn latest(&self) -> Option<&Observation> {
        self.bearings.back().map(|latest| &latest.observation)
    }

    /// Where the latest was taken.
    pub(super) fn place(&self) -> [f32; 2] {
        self.latest().map_or([0.0; 2], Observation::position)
    }

    /// The oldest first.
    pub(super) fn iter(&self) -> impl Iterator<Item = &Old> {
        self.bearings.iter()
    }
}
