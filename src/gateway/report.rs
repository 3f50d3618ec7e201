//! The vehicle's sentences out.

use super::clock::TimeOfDay;
use super::sentence::{DEGREES, ONE_SIGMA, Text, Unit};
use super::{Counters, Rejected};
use crate::aoa::geodesy::{Geodetic, LocalPlane};
use crate::aoa::locator::{Fix, NotObservable};

/// Has room for a fix and a status.
pub(super) type Report = Text<320>;

impl Report {
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
}
