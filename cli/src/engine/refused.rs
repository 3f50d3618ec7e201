//! Lines and messages that were not used, as messages: the first for each reason, then one now and then.

use std::collections::BTreeMap;

use foxhunt::gateway::Rejected;

use super::message::Refused;

/// Milliseconds from one to the next for the same input and reason.
const PAUSE_MS: i64 = 10_000;

/// What was refused, by input and reason: how often, and when it was told last.
#[derive(Debug, Default)]
pub struct Refusals(BTreeMap<(String, String), (u64, i64)>);

impl Refusals {
    /// Counts one; gives what is to be told of it.
    pub fn take(
        &mut self,
        input: &str,
        reason: String,
        text: &[u8],
        time_ms: i64,
    ) -> Option<Refused> {
        let key = (input.to_owned(), reason.clone());
        let (count, told_ms) = self.0.entry(key).or_insert((0, time_ms));
        *count += 1;
        if *count > 1 && time_ms - *told_ms < PAUSE_MS {
            return None;
        }
        *told_ms = time_ms;
        Some(Refused {
            input: input.to_owned(),
            time_ms,
            reason,
            text: legible(text),
            count: *count,
        })
    }
}

/// Why a line was not used. The library has one word for a receiver without a position and for headings and speeds that came
/// before any time was stated.
pub fn why(reason: Rejected, line: &[u8]) -> String {
    let states_time = |line: &[u8]| {
        let kind = line.get(3..6);
        !line.starts_with(b"$") || kind.is_some_and(|kind| matches!(kind, b"RMC" | b"GGA"))
    };
    if reason == Rejected::NoFix && !states_time(line) {
        return "it is void, or no position with a time was used before it".into();
    }
    reason.to_string()
}

/// Text that can be printed, not too long.
pub fn legible(line: &[u8]) -> String {
    const LONGEST: usize = 90;
    let text = String::from_utf8_lossy(line);
    let plain = |c: char| if c.is_control() { '\u{b7}' } else { c };
    let mut shown: String = text.trim_end().chars().take(LONGEST).map(plain).collect();
    if text.chars().nth(LONGEST).is_some() {
        shown.push_str("...");
    }
    shown
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_heading_has_no_fix_to_have() {
        let of = |line: &str| why(Rejected::NoFix, line.as_bytes());
        let receiver = Rejected::NoFix.to_string();
        assert_eq!(of("$GPRMC,,V,,,,,,,,,,N*53"), receiver);
        assert_eq!(of("$GPGGA,,,,,,0,,,,,,,,*66"), receiver);
        assert!(of("$GPHDT,12.0,T*33").contains("no position with a time"));
        let other = why(Rejected::Checksum, b"$GPHDT,12.0,T*34");
        assert_eq!(other, Rejected::Checksum.to_string());
    }

    #[test]
    fn the_first_is_told_and_then_one_now_and_then() {
        let mut refusals = Refusals::default();
        let mut take = |reason: &str, time_ms: i64| {
            let told = refusals.take("kraken", reason.into(), b"%270\x01/8\r\n", time_ms);
            told.map(|told| (told.text, told.count))
        };
        let line = "%270\u{b7}/8".to_owned();
        assert_eq!(take("no heading", 1_000), Some((line.clone(), 1)));
        assert_eq!(take("no heading", 2_000), None);
        assert_eq!(take("no position", 2_000), Some((line.clone(), 1)));
        assert_eq!(take("no heading", 11_000), Some((line, 3)));
    }
}
