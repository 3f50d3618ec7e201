//! Sentences out.

use heapless::String;

use super::clock::TimeOfDay;
use super::{Counters, Rejected, nmea};
use crate::aoa::geodesy::{Geodetic, LocalPlane};
use crate::aoa::locator::{Fix, NotObservable};

/// The probability of the ellipse whose semi-axes are one standard deviation: 1 - exp(-1/2).
const ONE_SIGMA: f32 = 0.393_469_34;
const DEGREES: f32 = 180.0 / core::f32::consts::PI;

#[derive(Clone, Copy)]
enum Unit {
    Tenth,
    Thousandth,
}

/// The text of the sentences that one line leads to. Writing never fails: it has room for the longest.
#[derive(Debug)]
pub(super) struct Report {
    text: String<320>,
    /// Where the sentence that is being written begins.
    start: usize,
}

impl Report {
    pub const fn new() -> Self {
        Self {
            text: String::new(),
            start: 0,
        }
    }

    pub fn clear(&mut self) {
        self.text.clear();
    }

    pub fn as_str(&self) -> &str {
        &self.text
    }

    /// `$PFOXF`, or `$PFOXN` with the reason `RANGE` where the fix is too far away for coordinates.
    pub fn fix(&mut self, time: Option<TimeOfDay>, fix: &Fix, plane: Option<&LocalPlane>) {
        let place = plane.and_then(|plane| plane.to_geodetic(fix.position).ok());
        let Some(place) = place else {
            self.begin("PFOXN");
            self.time(time);
            self.put(",RANGE");
            self.field(fix.bearings);
            self.put(",,");
            return self.end();
        };
        let ellipse = fix.ellipse(ONE_SIGMA);
        self.begin("PFOXF");
        self.time(time);
        self.place(place);
        self.decimal(ellipse.semi_major, Unit::Thousandth);
        self.decimal(ellipse.semi_minor, Unit::Thousandth);
        // From radians counter-clockwise from east to degrees clockwise from north, within half a turn.
        let orientation = 90.0 - ellipse.orientation * DEGREES;
        let orientation = if orientation < 179.95 {
            orientation
        } else {
            0.0
        };
        self.decimal(orientation, Unit::Tenth);
        self.field(fix.bearings);
        self.decimal(fix.effective_sample_size, Unit::Tenth);
        self.end();
    }

    /// `$PFOXN`
    pub fn not_observable(
        &mut self,
        time: Option<TimeOfDay>,
        reason: NotObservable,
        bearings: u32,
    ) {
        let (reason, angles) = match reason {
            NotObservable::TooFewBearings { .. } => (",FEW", None),
            NotObservable::CrossingAngle { radians, needed } => (",ANGLE", Some((radians, needed))),
            NotObservable::NoIntersection => (",APART", None),
        };
        self.begin("PFOXN");
        self.time(time);
        self.put(reason);
        self.field(bearings);
        match angles {
            Some((radians, needed)) => {
                self.decimal(radians * DEGREES, Unit::Tenth);
                self.decimal(needed * DEGREES, Unit::Tenth);
            }
            None => self.put(",,"),
        }
        self.end();
    }

    /// `$PFOXS`
    pub fn status(&mut self, counters: &Counters) {
        self.begin("PFOXS");
        for count in [
            counters.lines,
            counters.sentences,
            counters.bearings,
            counters.ignored,
        ] {
            self.field(count);
        }
        for reason in Rejected::ALL {
            self.field(counters.rejected(reason));
        }
        self.end();
    }

    fn begin(&mut self, name: &str) {
        self.start = self.text.len();
        self.put("$");
        self.put(name);
    }

    fn end(&mut self) {
        let sentence = self
            .text
            .as_bytes()
            .get(self.start + 1..)
            .unwrap_or_default();
        let sum = nmea::checksum(sentence);
        self.put("*");
        for digit in [sum >> 4, sum & 15] {
            let letter = if digit < 10 {
                b'0' + digit
            } else {
                b'A' + (digit - 10)
            };
            self.letter(letter);
        }
        self.put("\r\n");
    }

    fn time(&mut self, time: Option<TimeOfDay>) {
        self.put(",");
        if let Some(time) = time {
            let (hours, minutes, milliseconds) = time.parts();
            self.digits(hours, 2);
            self.digits(minutes, 2);
            self.digits(milliseconds / 1_000, 2);
            self.put(".");
            self.digits(milliseconds % 1_000, 3);
        }
    }

    fn place(&mut self, place: Geodetic) {
        self.coordinate(place.latitude_e7(), 2, ["N", "S"]);
        self.coordinate(place.longitude_e7(), 3, ["E", "W"]);
    }

    /// Degrees in `width` digits and minutes with six decimals, which hold 1e-7 degree exactly.
    fn coordinate(&mut self, degrees_e7: i32, width: u32, sides: [&str; 2]) {
        let magnitude = degrees_e7.unsigned_abs();
        let micro_minutes = magnitude % 10_000_000 * 6;
        self.put(",");
        self.digits(magnitude / 10_000_000, width);
        self.digits(micro_minutes / 1_000_000, 2);
        self.put(".");
        self.digits(micro_minutes % 1_000_000, 6);
        self.put(",");
        let [positive, negative] = sides;
        self.put(if degrees_e7 < 0 { negative } else { positive });
    }

    fn field(&mut self, value: u32) {
        self.put(",");
        self.digits(value, 1);
    }

    /// A value that is not negative, in tenths or thousandths; nothing if it is not finite.
    fn decimal(&mut self, value: f32, unit: Unit) {
        self.put(",");
        if value.is_finite() {
            let (per_one, width) = match unit {
                Unit::Tenth => (10, 1),
                Unit::Thousandth => (1_000, 3),
            };
            let scaled = (value * per_one as f32 + 0.5) as u32;
            self.digits(scaled / per_one, 1);
            self.put(".");
            self.digits(scaled % per_one, width);
        }
    }

    /// At least `width` digits.
    #[inline(never)]
    fn digits(&mut self, value: u32, width: u32) {
        let mut rest = value;
        let mut reversed = 0u64;
        let mut count = 0;
        // Four bits a digit, the first in the lowest.
        while count < width || rest > 0 {
            reversed = reversed << 4 | u64::from(rest % 10);
            rest /= 10;
            count += 1;
        }
        for _ in 0..count {
            self.letter(b'0' + (reversed & 15) as u8);
            reversed >>= 4;
        }
    }

    #[inline(never)]
    fn letter(&mut self, letter: u8) {
        // The capacity is checked by a test; a report that were too long would be cut.
        let _ = self.text.push(char::from(letter));
    }

    #[inline(never)]
    fn put(&mut self, text: &str) {
        let _ = self.text.push_str(text);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn time() -> Option<TimeOfDay> {
        TimeOfDay::from_nmea(b"235959.999")
    }

    fn plane() -> LocalPlane {
        LocalPlane::new(Geodetic::new(-481_173_001, -1_799_999_999).unwrap()).unwrap()
    }

    fn fix(position: [f32; 2], covariance: [[f32; 2]; 2]) -> Fix {
        Fix {
            position,
            covariance,
            effective_sample_size: 87.66,
            bearings: 60,
        }
    }

    #[test]
    fn fix_sentence() {
        let mut report = Report::new();
        report.fix(
            time(),
            &fix([0.0, 0.0], [[1.0, 0.0], [0.0, 4.0]]),
            Some(&plane()),
        );
        assert_eq!(
            report.as_str(),
            "$PFOXF,235959.999,4807.038006,S,17959.999994,W,2.000,1.000,0.0,60,87.7*50\r\n"
        );
        report.clear();
        report.fix(
            None,
            &fix([0.0, 0.0], [[4.0, 0.0], [0.0, 1.0]]),
            Some(&plane()),
        );
        assert!(report.as_str().contains(",W,2.000,1.000,90.0,60,"));
        report.clear();
        report.fix(
            None,
            &fix([f32::NAN, 0.0], [[4.0, 0.0], [0.0, 1.0]]),
            Some(&plane()),
        );
        assert_eq!(report.as_str(), "$PFOXN,,RANGE,60,,*3A\r\n");
    }

    #[test]
    fn not_observable_sentence() {
        let mut report = Report::new();
        report.not_observable(time(), NotObservable::TooFewBearings { have: 1 }, 1);
        assert_eq!(report.as_str(), "$PFOXN,235959.999,FEW,1,,*10\r\n");
        report.clear();
        let reason = NotObservable::CrossingAngle {
            radians: 0.05,
            needed: 0.1,
        };
        report.not_observable(time(), reason, 12);
        assert_eq!(report.as_str(), "$PFOXN,235959.999,ANGLE,12,2.9,5.7*3E\r\n");
    }

    #[test]
    fn the_longest_reports_fit() {
        let mut report = Report::new();
        let mut longest = fix([9e4, 4e4], [[3e38, 0.0], [0.0, 3e38]]);
        longest.effective_sample_size = 3e38;
        longest.bearings = u32::MAX;
        report.fix(time(), &longest, Some(&plane()));
        let mut counters = Counters::new();
        counters.lines = u32::MAX;
        report.status(&counters);
        // Every other count, now one digit, may have ten.
        let counts = 4 + Rejected::ALL.len();
        assert!(report.as_str().ends_with("\r\n"));
        assert!(report.as_str().len() + (counts - 1) * 9 <= 320);
    }

    #[test]
    fn digits() {
        for (value, width, text) in [
            (0, 1, "0"),
            (0, 3, "000"),
            (7, 2, "07"),
            (4_294_967_295, 2, "4294967295"),
            (100, 1, "100"),
        ] {
            let mut report = Report::new();
            report.digits(value, width);
            assert_eq!(report.as_str(), text);
        }
    }
}
