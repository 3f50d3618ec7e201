//! The sentences of the gateway.

use super::outcome::{Counters, Rejected};
use super::{Packet, Spot};
use crate::estimate::Ellipse;
use crate::fingerprint::tracker::{Fix, State};
use crate::gateway::sentence::{DEGREES, Text, Unit};

/// The most tags of one gateway: the answer to a query has room for so many.
pub const MAX_TAGS: usize = 64;

/// Of the longest answer.
const CAPACITY: usize = MAX_TAGS * 150 + 256;

/// Has room for the fixes of [`MAX_TAGS`] tags and a status.
pub(super) type Report = Text<CAPACITY>;

impl Report {
    /// `$PFOXT`, with the floor and its probability where there are several.
    pub fn tag(&mut self, tag: u32, fix: &Fix, floor: Option<(u8, f32)>) {
        let ellipse = Ellipse::of_sigmas(fix.position, fix.covariance, 1.0);
        self.begin("PFOXT");
        self.field(fix.time_ms);
        self.field(tag);
        self.put(match fix.state {
            State::Tracking => ",TRACKING",
            State::Uncertain => ",UNCERTAIN",
            State::Lost => ",LOST",
            State::Recovered => ",RECOVERED",
        });
        for value in fix.position.into_iter().chain(fix.velocity) {
            self.signed(value, Unit::Thousandth);
        }
        self.decimal(ellipse.semi_major, Unit::Thousandth);
        self.decimal(ellipse.semi_minor, Unit::Thousandth);
        self.signed(ellipse.orientation * DEGREES, Unit::Tenth);
        self.signed(fix.offset_db, Unit::Tenth);
        self.decimal(fix.effective_sample_size, Unit::Tenth);
        if let Some((floor, probability)) = floor {
            self.field(floor.into());
            self.decimal(probability, Unit::Thousandth);
        }
        self.end();
    }

    /// `$PFOXL`
    pub fn radio(&mut self, time_ms: u32, radio: u32, word: &str) {
        self.begin("PFOXL");
        self.field(time_ms);
        self.field(radio);
        self.put(",");
        self.put(word);
        self.end();
    }

    /// `$PFOXV`
    pub fn survey(&mut self, spot: &Spot, packet: &Packet) {
        self.begin("PFOXV");
        for metres in spot.place {
            self.signed(metres, Unit::Thousandth);
        }
        self.field(spot.floor.into());
        self.field(packet.radio.into());
        let rssi = packet.rssi_dbm;
        self.put(if rssi < 0 { ",-" } else { "," });
        self.digits(rssi.unsigned_abs().into(), 1);
        self.end();
    }

    /// `$PFOXM`
    pub fn map(&mut self, received: u32, total: u32, word: &str) {
        self.begin("PFOXM");
        self.field(received);
        self.field(total);
        self.put(",");
        self.put(word);
        self.end();
    }

    /// `$PFOXS`
    pub fn status(&mut self, counters: &Counters, tags: u32, silent_radios: u32) {
        self.begin("PFOXS");
        for count in [
            counters.messages,
            counters.packets,
            counters.ignored,
            counters.queries,
            counters.restarts,
        ] {
            self.field(count);
        }
        for reason in Rejected::ALL {
            self.field(counters.rejected(reason));
        }
        for count in [tags, silent_radios, counters.evicted] {
            self.field(count);
        }
        self.end();
    }
}

#[cfg(test)]
mod tests {
    extern crate std;
    use super::*;

    fn fix() -> Fix {
        Fix {
            time_ms: 12_500,
            state: State::Tracking,
            position: [31.25, -0.5],
            covariance: [[4.0, 0.0], [0.0, 1.0]].into(),
            velocity: [1.0, 0.0],
            offset_db: -3.25,
            effective_sample_size: 211.04,
        }
    }

    #[test]
    fn sentences() {
        let mut report = Report::new();
        report.tag(7, &fix(), None);
        assert_eq!(
            report.as_str(),
            "$PFOXT,12500,7,TRACKING,31.250,-0.500,1.000,0.000,2.000,1.000,0.0,-3.3,211.0*45\r\n"
        );
        report.clear();
        report.radio(12_500, 3, "SILENT");
        assert!(report.as_str().starts_with("$PFOXL,12500,3,SILENT*"));
        // Variances of 4 and 1 m^2 to the north-east and to the north-west.
        report.clear();
        let tilted = Fix {
            covariance: [[2.5, 1.5], [1.5, 2.5]].into(),
            ..fix()
        };
        report.tag(7, &tilted, Some((2, 0.75)));
        let ends = ",2.000,1.000,45.0,-3.3,211.0,2,0.750*";
        assert!(report.as_str().contains(ends), "{}", report.as_str());
        for rssi_dbm in [-60, 0, 4] {
            report.clear();
            let spot = Spot {
                tag: 7,
                place: [1.5, -2.0],
                floor: 1,
            };
            let packet = Packet {
                time_ms: 12_500,
                radio: 3,
                tag: 7,
                rssi_dbm,
            };
            report.survey(&spot, &packet);
            let expected = std::format!("$PFOXV,1.500,-2.000,1,3,{rssi_dbm}*");
            assert!(
                report.as_str().starts_with(&expected),
                "{}",
                report.as_str()
            );
        }
    }

    #[test]
    fn the_longest_reports_fit() {
        let mut report = Report::new();
        let fix = Fix {
            time_ms: u32::MAX,
            state: State::Recovered,
            position: [-9e5; 2],
            covariance: [[1e12, 0.0], [0.0, 1e12]].into(),
            velocity: [-9e5; 2],
            offset_db: -100.0,
            effective_sample_size: 65_536.0,
        };
        for _ in 0..MAX_TAGS {
            report.tag(u32::MAX, &fix, Some((63, 1.0)));
        }
        report.status(&Counters::EMPTY, 8, 0);
        // Every count, now one digit, may have ten.
        let counts = 8 + Rejected::ALL.len();
        assert!(report.as_str().ends_with("\r\n"));
        assert!(report.as_str().len() + counts * 9 <= CAPACITY);
    }
}
