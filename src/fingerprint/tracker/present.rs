//! What time it is, by the packets of many radios.

use crate::snapshot::value;

/// The present in milliseconds, by the times that packets state, of which some are wrong.
///
/// A packet that states a time up to a second ahead moves the present; an older one does not, and neither does one that
/// is further ahead, or a second or more behind, until [`Present::CONFIRMATIONS`] packets in a row agree that the present
/// is another. So a late or an early packet, or a radio whose clock is wrong among others, leaves it as it is, and a clock
/// that was set is followed.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Present {
    now_ms: u32,
    /// The latest of the packets that say otherwise, and how many they are.
    other_ms: u32,
    others: u8,
    has_begun: bool,
}

impl Present {
    /// Fewer let a burst of late packets turn the present back; more would follow a clock that was set for longer.
    const CONFIRMATIONS: u8 = 5;
    /// How far the packets of radios in step are apart. Tags whose packets are further apart are still tracked: the
    /// present then lags by a few packets.
    const STEP_MS: i32 = 1_000;
    /// How far the packets may be apart that confirm each other.
    const AGREEMENT_MS: i32 = 60_000;

    pub const EMPTY: Self = Self {
        now_ms: 0,
        other_ms: 0,
        others: 0,
        has_begun: false,
    };

    /// The time that the packets agree on.
    pub const fn now_ms(&self) -> u32 {
        self.now_ms
    }

    /// Takes the time that a packet states, and returns the present.
    pub fn hear(&mut self, time_ms: u32) -> u32 {
        let ahead = time_ms.wrapping_sub(self.now_ms) as i32;
        if !self.has_begun || (0..=Self::STEP_MS).contains(&ahead) {
            (self.now_ms, self.others, self.has_begun) = (time_ms, 0, true);
        } else if (-Self::STEP_MS..0).contains(&ahead) {
            self.others = 0;
        } else {
            let since = time_ms.wrapping_sub(self.other_ms) as i32;
            let agrees = (-Self::STEP_MS..=Self::AGREEMENT_MS).contains(&since);
            if self.others == 0 || !agrees {
                (self.other_ms, self.others) = (time_ms, 1);
            } else {
                self.others = self.others.saturating_add(1);
                if since > 0 {
                    self.other_ms = time_ms;
                }
            }
            if self.others >= Self::CONFIRMATIONS {
                (self.now_ms, self.others) = (self.other_ms, 0);
            }
        }
        self.now_ms
    }
}

value!(Present {
    now_ms,
    other_ms,
    others,
    has_begun
});

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn packets_out_of_time_leave_it() {
        let mut present = Present::EMPTY;
        let start = u32::MAX - 5_000;
        for i in 0..100 {
            let time_ms = start.wrapping_add(100 * i);
            assert_eq!(present.hear(time_ms), time_ms);
            for wrong in [3_600_000, 1_001, 0x7fff_ffff, 3_600_000u32.wrapping_neg()] {
                assert_eq!(present.hear(time_ms.wrapping_add(wrong)), time_ms);
            }
            assert_eq!(present.hear(time_ms.wrapping_sub(900)), time_ms);
        }
    }

    #[test]
    fn a_clock_that_was_set_is_followed() {
        for shift in [3_600_000, 20_000, 3_600_000u32.wrapping_neg(), 1 << 31] {
            let mut present = Present::EMPTY;
            assert_eq!(present.hear(500), 500);
            let times = [0, 40, 10, 60, 900].map(|after| after + 500u32.wrapping_add(shift));
            let last = times.map(|time_ms| present.hear(time_ms));
            assert_eq!(last, [500, 500, 500, 500, times[4]], "{shift}");
        }
    }

    #[test]
    fn packets_that_are_late_or_contradict_each_other_turn_nothing_back() {
        let mut present = Present::EMPTY;
        assert_eq!(present.hear(10_000_000), 10_000_000);
        for _ in 0..10 {
            assert_eq!(present.hear(10_000_000 - 900), 10_000_000);
        }
        for apart in 1..10 {
            assert_eq!(present.hear(10_000_000 + 100_000 * apart), 10_000_000);
        }
    }

    #[test]
    fn packets_far_apart_are_followed_later() {
        let mut present = Present::EMPTY;
        let last = (0..11).map(|i| present.hear(10_000 * i)).last();
        assert_eq!(last, Some(100_000));
    }
}
