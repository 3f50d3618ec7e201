//! Several logs as one, by the times that their lines state.

use foxhunt_decode::time_of_day;

use crate::engine::{Piece, What};

/// Milliseconds of a day.
const DAY: i64 = 86_400_000;

/// The lines of some logs in the order of their times; each log keeps its own order, and a line that states no time follows the one
/// before it. Each log is an input of its own, or all are one.
pub fn merged(logs: &[Vec<u8>], is_one: bool) -> Vec<Piece> {
    let mut lines: Vec<(i64, usize, &[u8])> = Vec::new();
    for (index, log) in logs.iter().enumerate() {
        let mut clock: Option<i64> = None;
        let from = lines.len();
        for line in log.split_inclusive(|byte| *byte == b'\n') {
            if let Some(time) = time_of_day(line) {
                // On over midnight; a step back is another device's delay.
                let after = clock.map_or(time, |clock| {
                    let step = (time - clock).rem_euclid(DAY);
                    if step < DAY / 2 { clock + step } else { clock }
                });
                if clock.is_none() {
                    // What came before the first time came then.
                    for line in &mut lines[from..] {
                        line.0 = after;
                    }
                }
                clock = Some(after);
            }
            lines.push((clock.unwrap_or(0), index, line));
        }
    }
    // A night of which one log begins before midnight and another after it.
    let first = |index: usize| lines.iter().find(|line| line.1 == index).map(|line| line.0);
    let starts: Vec<Option<i64>> = (0..logs.len()).map(first).collect();
    let latest = starts.iter().flatten().max().copied().unwrap_or(0);
    for line in &mut lines {
        if starts[line.1].is_some_and(|start| latest - start > DAY / 2) {
            line.0 += DAY;
        }
    }
    lines.sort_by_key(|(time, index, _)| (*time, *index));
    lines
        .into_iter()
        .map(|(_, index, line)| {
            let mut bytes = line.to_vec();
            // The last line of a log may lack its end.
            if !bytes.ends_with(b"\n") {
                bytes.push(b'\n');
            }
            let input = if is_one { 0 } else { index };
            let is_message = false;
            let what = What::Bytes {
                input,
                bytes,
                is_message,
            };
            Piece { time_ms: 0, what }
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn order(logs: &[&str]) -> Vec<String> {
        let logs: Vec<Vec<u8>> = logs.iter().map(|log| log.as_bytes().to_vec()).collect();
        let pieces = merged(&logs, false).into_iter();
        let text = pieces.map(|piece| match piece.what {
            What::Bytes { input, bytes, .. } => {
                format!("{input} {}", String::from_utf8(bytes).unwrap().trim())
            }
            _ => panic!("only bytes"),
        });
        text.collect()
    }

    #[test]
    fn by_time_and_each_in_its_own_order() {
        let receiver = "$GPRMC,235958,A\n%010/9\n$GPRMC,000001,A";
        let kraken = "1795823999000, 1.0\n1795824002000, 2.0\n";
        assert_eq!(
            order(&[receiver, kraken]),
            [
                "0 $GPRMC,235958,A",
                "0 %010/9",
                "1 1795823999000, 1.0",
                "0 $GPRMC,000001,A",
                "1 1795824002000, 2.0",
            ]
        );
        // Begins after midnight.
        assert_eq!(
            order(&["$GPGGA,000002.5,1\n", "\n$GPGGA,235959,1\n"]),
            ["1 ", "1 $GPGGA,235959,1", "0 $GPGGA,000002.5,1"]
        );
    }
}
