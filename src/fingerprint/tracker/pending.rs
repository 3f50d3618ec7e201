//! The packets that wait for their update.

use super::Heard;
use super::field::Level;

/// Sums over the packets since the last update, by beacon.
#[derive(Debug, Clone)]
pub(super) struct Pending<const B: usize> {
    levels: [Level; B],
    /// When the window began that the next packets are in; none before the first packet of a walk.
    window_ms: Option<u32>,
    /// When the first of them came.
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
            window_ms: None,
            first_ms: 0,
            elapsed_ms: 0,
            packets: 0,
        }
    }

    pub fn is_empty(&self) -> bool {
        self.packets == 0
    }

    /// Whether the packets are those of a whole window, because a packet at `time_ms` is in a later one.
    ///
    /// Windows follow each other without gaps, from the first packet of a walk on. If each began with its first packet, tags
    /// that send a little faster than once in a window would be updated by every other packet.
    pub fn is_due(&mut self, time_ms: u32, length_ms: u32) -> bool {
        let began = *self.window_ms.get_or_insert(time_ms);
        // Radios whose packets overtake each other are in the same window.
        let age = u32::try_from(time_ms.wrapping_sub(began) as i32).unwrap_or(0);
        if age < length_ms {
            return false;
        }
        let into = age.checked_rem(length_ms).unwrap_or(0);
        self.window_ms = Some(time_ms.wrapping_sub(into));
        !self.is_empty()
    }

    /// Milliseconds from the first packet until a time; negative before it.
    fn age_ms(&self, time_ms: u32) -> i32 {
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

    /// Those that wait; from now on none does.
    pub fn take(&mut self) -> Self {
        let next = Self {
            window_ms: self.window_ms,
            ..Self::new()
        };
        core::mem::replace(self, next)
    }

    /// Forgets them, and when windows begin.
    pub fn clear(&mut self) {
        *self = Self::new();
    }
}
