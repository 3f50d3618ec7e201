//! What a search knows of an input.

use std::collections::BTreeMap;

use foxhunt_decode::Stream;

/// An input.
#[derive(Default)]
pub struct Input {
    /// Parts its bytes.
    pub stream: Stream,
    /// The site whose radios it tells of, by its number.
    pub site: Option<usize>,
    /// Line ends that have come.
    pub lines: u64,
    /// The beginning of the line that is coming in: of a line of no kind, the gateway keeps nothing.
    pub begun: Vec<u8>,
    /// Lines and messages that were not used, by the reason as it is told.
    pub refused: BTreeMap<String, u64>,
    /// Those of them that are no lines of the gateway.
    pub refused_messages: u64,
    /// Sentences of a board's reports that were used.
    pub reports: u64,
}

impl Input {
    /// Counts what was not used.
    pub fn refuse(&mut self, reason: String) {
        *self.refused.entry(reason).or_default() += 1;
    }

    /// Notes a byte of a line.
    pub fn begin(&mut self, byte: u8) {
        /// More of it is not told.
        const MOST: usize = 100;
        match byte {
            b'\n' => {
                self.lines += 1;
                self.begun.clear();
            }
            b'\r' => {}
            _ if self.begun.len() < MOST => self.begun.push(byte),
            _ => {}
        }
    }
}
