//! How often each of several things has happened.

use crate::snapshot::{Error, Reader, Value, Writer};

/// Counts that stay at their maximum when they reach it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub(super) struct Tally<const K: usize>([u32; K]);

impl<const K: usize> Tally<K> {
    pub const fn new() -> Self {
        Self([0; K])
    }

    /// Of thing number `which`.
    pub fn get(&self, which: usize) -> u32 {
        self.0.get(which).copied().unwrap_or(0)
    }

    pub fn add(&mut self, which: usize) {
        if let Some(count) = self.0.get_mut(which) {
            *count = count.saturating_add(1);
        }
    }
}

impl<const K: usize> Value for Tally<K> {
    const SIZE: usize = <[u32; K]>::SIZE;

    fn write(&self, to: &mut Writer<'_>) {
        self.0.write(to);
    }

    fn read(from: &mut Reader<'_>) -> Result<Self, Error> {
        Value::read(from).map(Self)
    }
}

impl<const K: usize> Default for Tally<K> {
    fn default() -> Self {
        Self::new()
    }
}
