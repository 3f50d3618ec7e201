//! The packets that wait for their update.

use super::Heard;
use super::field::Level;

/// Sums over the packets since the last update, by beacon.
#[derive(Debug, Clone)]
pub(super) struct Pending<const B: usize> {
    levels: [Level; B],
    /// When the first came.
    first_ms: u32,
    /// Sum of the times since then.
    elapsed_ms: u32,
    packets: u16,
}

impl<const B: usize> Pending<B> {
    const NONE: Level = Level {
        mean_dbm: 0.0,
        packets: 0,
    };

    pub const fn new() -> Self {
        Self {
            levels: [Self::NONE; B],
            first_ms: 0,
            elapsed_ms: 0,
            packets: 0,
        }
    }

    pub fn is_empty(&self) -> bool {
        self.packets == 0
    }

    /// Milliseconds from the first packet until a time; negative before it.
    pub fn age_ms(&self, time_ms: u32) -> i32 {
        time_ms.wrapping_sub(self.first_ms) as i32
    }

    /// Takes packets of a beacon in. Those beyond 65,535, and beacons that there is no room for, are left out.
    pub fn add(&mut self, time_ms: u32, heard: &Heard) {
        let beacon = usize::from(heard.beacon);
        let (true, Some(packets)) = (beacon < B, self.packets.checked_add(heard.packets)) else {
            return;
        };
        if self.is_empty() {
            self.first_ms = time_ms;
        }
        // Radios whose packets overtake each other count as the first.
        let age = u32::try_from(self.age_ms(time_ms)).unwrap_or(0);
        let ages = age.saturating_mul(heard.packets.into());
        self.elapsed_ms = self.elapsed_ms.saturating_add(ages);
        self.packets = packets;
        if let (Some(level), 1..) = (self.levels.get_mut(beacon), heard.packets) {
            level.packets += heard.packets;
            let share = f32::from(heard.packets) / f32::from(level.packets);
            level.mean_dbm += share * (heard.mean_dbm - level.mean_dbm);
        }
    }

    pub fn levels(&self) -> &[Level; B] {
        &self.levels
    }

    /// Their mean time.
    pub fn time_ms(&self) -> u32 {
        let mean = self
            .elapsed_ms
            .checked_div(self.packets.into())
            .unwrap_or(0);
        self.first_ms.wrapping_add(mean)
    }

    pub fn clear(&mut self) {
        *self = Self::new();
    }
}
