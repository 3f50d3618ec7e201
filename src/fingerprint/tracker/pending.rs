//! The packets that wait for their update.

use crate::fingerprint::Reading;
use crate::persist;

/// The packets of one beacon.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(super) struct Level {
    pub mean_dbm: f32,
    pub packets: u16,
    /// Variance in dB^2 that its beacon has beyond what the map says.
    pub doubt_db2: f32,
}

/// Sums over the packets since the last update, by beacon.
#[derive(Debug, Clone)]
pub(super) struct Pending<const B: usize> {
    /// By beacon, apart from their numbers: so they take less.
    means_dbm: [f32; B],
    numbers: [u16; B],
    /// When the window of the next packets began; none before the first packet of a walk.
    window_ms: Option<u32>,
    /// When the first of them came.
    first_ms: u32,
    /// Sum of the times since then.
    elapsed_ms: u32,
    packets: u16,
}

impl<const B: usize> Pending<B> {
    pub const EMPTY: Self = Self {
        means_dbm: [0.0; B],
        numbers: [0; B],
        window_ms: None,
        first_ms: 0,
        elapsed_ms: 0,
        packets: 0,
    };

    pub fn is_empty(&self) -> bool {
        self.packets == 0
    }

    /// Whether the packets are those of a whole window, because a packet at `time_ms` belongs to a later one.
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

    /// Adds a packet. Those beyond 65,535 are left out, and so are beacons that there is no room for.
    pub fn add(&mut self, time_ms: u32, packet: Reading) {
        let beacon = usize::from(packet.beacon);
        let (Some(mean_dbm), Some(number), Some(packets)) = (
            self.means_dbm.get_mut(beacon),
            self.numbers.get_mut(beacon),
            self.packets.checked_add(1),
        ) else {
            return;
        };
        if self.packets == 0 {
            self.first_ms = time_ms;
        }
        // Radios whose packets overtake each other count as the first.
        let age = time_ms.wrapping_sub(self.first_ms) as i32;
        self.elapsed_ms = self.elapsed_ms.saturating_add_signed(age.max(0));
        self.packets = packets;
        *number += 1;
        let fraction = 1.0 / f32::from(*number);
        *mean_dbm += fraction * (packet.rssi_dbm - *mean_dbm);
    }

    /// The levels, of beacons that are doubted by so much: by number, and not at all beyond the last.
    pub fn levels(&self, doubts_db2: &[f32]) -> [Level; B] {
        let mut levels = [Level::default(); B];
        for (level, doubt_db2) in levels.iter_mut().zip(doubts_db2) {
            level.doubt_db2 = *doubt_db2;
        }
        let each = self.means_dbm.iter().zip(&self.numbers);
        for (level, (mean_dbm, packets)) in levels.iter_mut().zip(each) {
            (level.mean_dbm, level.packets) = (*mean_dbm, *packets);
        }
        levels
    }

    /// Their mean time.
    pub fn time_ms(&self) -> u32 {
        let mean = self
            .elapsed_ms
            .checked_div(self.packets.into())
            .unwrap_or(0);
        self.first_ms.wrapping_add(mean)
    }

    /// Removes and returns the packets.
    pub fn take(&mut self) -> Self {
        let next = Self {
            window_ms: self.window_ms,
            ..Self::EMPTY
        };
        core::mem::replace(self, next)
    }

    /// Forgets the packets and the beginning of the windows.
    pub fn clear(&mut self) {
        *self = Self::EMPTY;
    }
}

persist!(impl[const B: usize] Pending<B> as "Pending"(B) { means_dbm, numbers, window_ms, first_ms, elapsed_ms, packets });
