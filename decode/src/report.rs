//! The sentences by which a board of ours reports.

use super::times::clock;

/// A sentence of a report.
#[derive(Debug, Clone, PartialEq)]
pub enum Report {
    /// `$PFOXF`: where a source is.
    Fix {
        /// Milliseconds after midnight.
        time_ms: u32,
        /// Where, and how sure.
        region: Region,
        /// It rests on so many.
        bearings: u32,
    },
    /// `$PFOXN`: why there is no fix.
    NoFix {
        /// Milliseconds after midnight, once there is a bearing.
        time_ms: Option<u32>,
        /// Its word.
        reason: String,
        /// So many have come.
        bearings: u32,
        /// What there is, and what is needed.
        figures: Option<[f64; 2]>,
    },
    /// `$PFOXM`: of the source whose fix came before.
    Source {
        /// By which it is told from others.
        number: u16,
        /// That there is such a source, in percent.
        probability: f64,
    },
    /// `$PFOXH` and `$PFOXC`: a place where a source may be.
    Hypothesis {
        /// Where, and how sure.
        region: Region,
        /// In percent.
        probability: f64,
    },
    /// `$PFOXA`: where to drive.
    Advice {
        /// Clockwise from north.
        course_deg: f64,
        /// Until there can be a fix, if that is not too far.
        metres: Option<f64>,
    },
    /// `$PFOXE`: with it, a report of all that is known ends.
    Errors,
    /// `$PFOXS`: the status, after a report.
    Status,
    /// `$PFOXT`: where a tag is.
    Tag {
        /// Its identifier.
        tag: u32,
        /// A word.
        state: String,
        /// Metres.
        place: [f64; 2],
        /// Of x, x and y, y; in square metres.
        covariance: [f64; 3],
        /// The likeliest floor and its probability, of a building.
        floor: Option<(u8, f64)>,
    },
}

/// A place, and how sure it is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Region {
    /// Degrees.
    pub latitude: f64,
    /// Degrees.
    pub longitude: f64,
    /// Standard deviations along the longer and the shorter axis, in metres.
    pub sigmas_m: [f64; 2],
    /// Of the longer axis, clockwise from north.
    pub angle_deg: f64,
}

impl Region {
    /// Of east, east and north, north; in square metres.
    pub fn covariance(&self) -> [f64; 3] {
        covariance(self.sigmas_m, 90.0 - self.angle_deg)
    }
}

/// Of standard deviations along two axes, of which the first is turned counter-clockwise by an angle.
fn covariance([major, minor]: [f64; 2], angle_deg: f64) -> [f64; 3] {
    let (sin, cos) = angle_deg.to_radians().sin_cos();
    let [along, across] = [major * major, minor * minor];
    [
        along * cos * cos + across * sin * sin,
        (along - across) * sin * cos,
        along * sin * sin + across * cos * cos,
    ]
}

/// Reads a sentence whose checksum is known to be right; `None` if it is none of a report.
pub fn report(line: &[u8]) -> Option<Report> {
    let line = std::str::from_utf8(line.strip_prefix(b"$PFOX")?).ok()?;
    let (payload, _) = line.split_once('*')?;
    let fields: Vec<&str> = payload.split(',').collect();
    match fields[..] {
        ["F", time, .., bearings, _size] => Some(Report::Fix {
            time_ms: time_of(time)?,
            region: region(fields.get(2..9)?)?,
            bearings: bearings.parse().ok()?,
        }),
        ["N", time, reason, bearings, has, needs] => Some(Report::NoFix {
            time_ms: time_of(time),
            reason: reason.to_owned(),
            bearings: bearings.parse().ok()?,
            figures: number(has)
                .zip(number(needs))
                .map(|(has, needs)| [has, needs]),
        }),
        ["M", source, _, _, _, _, probability] => Some(Report::Source {
            number: source.parse().ok()?,
            probability: number(probability)?,
        }),
        ["H" | "C", .., probability] => Some(Report::Hypothesis {
            region: region(fields.get(1..8)?)?,
            probability: number(probability)?,
        }),
        ["A", course, metres, _] => Some(Report::Advice {
            course_deg: number(course)?,
            metres: number(metres),
        }),
        ["E", ..] => Some(Report::Errors),
        ["S", ..] => Some(Report::Status),
        [
            "T",
            _time,
            tag,
            state,
            x,
            y,
            _,
            _,
            major,
            minor,
            angle,
            _offset,
            _size,
            ref floor @ ..,
        ] => Some(Report::Tag {
            tag: tag.parse().ok()?,
            state: state.to_owned(),
            place: [number(x)?, number(y)?],
            covariance: covariance([number(major)?, number(minor)?], number(angle)?),
            floor: match floor {
                [] => None,
                [floor, probability] => Some((floor.parse().ok()?, number(probability)?)),
                _ => return None,
            },
        }),
        _ => None,
    }
}

fn number(text: &str) -> Option<f64> {
    text.parse().ok().filter(|number: &f64| number.is_finite())
}

/// Milliseconds after midnight.
fn time_of(text: &str) -> Option<u32> {
    u32::try_from(clock(text)?).ok()
}

/// Latitude, north or south, longitude, east or west, two standard deviations, an angle.
fn region(fields: &[&str]) -> Option<Region> {
    let [latitude, north, longitude, east, major, minor, angle] = fields else {
        return None;
    };
    let degrees = |text: &str, digits: usize, sides: [&str; 2], side: &str| {
        let (whole, minutes) = text.split_at_checked(digits)?;
        let degrees = whole.parse::<u16>().ok()?;
        let degrees = f64::from(degrees) + number(minutes)? / 60.0;
        // A sentence holds 1e-7 degree exactly.
        let degrees = (1e7 * degrees).round() / 1e7;
        let sign = [1.0, -1.0][sides.iter().position(|one| *one == side)?];
        (degrees <= 180.0).then_some(sign * degrees)
    };
    Some(Region {
        latitude: degrees(latitude, 2, ["N", "S"], north)?,
        longitude: degrees(longitude, 3, ["E", "W"], east)?,
        sigmas_m: [number(major)?, number(minor)?],
        angle_deg: number(angle)?,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sentences_are_read() {
        let fix = b"$PFOXF,093318.250,5214.407050,N,02100.710064,W,24.500,3.250,90.0,55,181.5*2C";
        let Some(Report::Fix {
            time_ms,
            region,
            bearings,
        }) = report(fix)
        else {
            panic!("it is a fix");
        };
        assert_eq!((time_ms, bearings), (34_398_250, 55));
        assert_eq!(
            [region.latitude, region.longitude],
            [52.240_117_5, -21.011_834_4]
        );
        let [east, both, north] = region.covariance();
        assert!((east - 600.25).abs() < 1e-9 && (north - 10.5625).abs() < 1e-9);
        assert!(both.abs() < 1e-9);
        assert_eq!(
            report(b"$PFOXN,,FEW,0,,*5E"),
            Some(Report::NoFix {
                time_ms: None,
                reason: "FEW".into(),
                bearings: 0,
                figures: None,
            })
        );
        assert_eq!(
            report(b"$PFOXM,3,,,,,97.5*00"),
            Some(Report::Source {
                number: 3,
                probability: 97.5
            })
        );
        assert_eq!(
            report(b"$PFOXA,90.0,,0.3*00"),
            Some(Report::Advice {
                course_deg: 90.0,
                metres: None
            })
        );
        let tag =
            report(b"$PFOXT,12500,7,LOST,31.250,-0.500,1.000,0.000,2.000,1.000,0.0,-3.3,211.0*45");
        let Some(Report::Tag {
            place, covariance, ..
        }) = tag
        else {
            panic!("it is a tag");
        };
        assert_eq!((place, covariance), ([31.25, -0.5], [4.0, 0.0, 1.0]));
        let on_floor = report(
            b"$PFOXT,12500,7,LOST,31.250,-0.500,1.000,0.000,2.000,1.000,0.0,-3.3,211.0,2,0.970*00",
        );
        assert!(matches!(
            on_floor,
            Some(Report::Tag {
                floor: Some((2, 0.97)),
                ..
            })
        ));
        for none in [
            "",
            "$PFOXF*00",
            "$PFOXF,1,2*00",
            "$PFOXF,093318.250,5214.4,X,02100.7,E,24.500,3.250,90.0,55,181.5*00",
            "$PFOXF,093318.250,9914.4,N,99900.7,E,24.500,3.250,90.0,55,181.5*00",
            "$PFOXF,093318.250,\u{e9}\u{e9}14.4,N,02100.7,E,nan,3.250,90.0,55,181.5*00",
            "$PFOXB,1,2,3,-40*00",
            "$GPRMC*00",
        ] {
            assert_eq!(report(none.as_bytes()), None, "{none}");
        }
    }
}
