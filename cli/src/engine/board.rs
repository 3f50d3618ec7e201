//! What a board of ours reports: its answer in the place of a search of our own.

use foxhunt::aoa::NotObservable;
use foxhunt_decode::{Region, Report};

use super::{
    message::{Advice, Answer, Ellipse, Hypothesis, Reason, Source},
    site::rounded,
    words,
};

/// The report that is coming in, sentence by sentence.
#[derive(Debug)]
pub struct Board {
    answer: Answer,
    /// It was told as far as it has come.
    is_told: bool,
    /// The last sentence was of a source, of which there may be another.
    is_of_several: bool,
    /// The reports of this board end with a sentence of errors; others end with any.
    has_end: bool,
}

impl Default for Board {
    fn default() -> Self {
        Self {
            answer: words::nothing(0),
            is_told: true,
            is_of_several: false,
            has_end: false,
        }
    }
}

impl Board {
    /// Takes a sentence; gives the answers that are whole with it. `now` makes a time of the day one after 1970, `way` tells
    /// where to drive.
    pub fn take(
        &mut self,
        report: Report,
        now: impl Fn(u32) -> i64,
        way: impl Fn(f64, Option<f64>) -> Option<Advice>,
    ) -> Vec<Answer> {
        let mut whole = Vec::new();
        let was_of_several = std::mem::take(&mut self.is_of_several);
        match report {
            Report::Fix {
                time_ms,
                region,
                bearings,
            } => {
                let time_ms = now(time_ms);
                let goes_on = time_ms == self.answer.time_ms
                    && (was_of_several || (self.has_end && !self.is_told));
                if !goes_on {
                    whole.extend(self.begin(time_ms));
                    self.answer.reason = None;
                }
                self.answer.sources.push(source(&region, bearings));
            }
            Report::NoFix {
                time_ms,
                reason,
                bearings,
                figures,
            } => {
                whole.extend(self.begin(time_ms.map_or(0, now)));
                self.answer.reason = Some(why(&reason, bearings, figures));
            }
            Report::Source {
                number,
                probability,
            } => {
                self.is_of_several = true;
                if let Some(source) = self.answer.sources.last_mut() {
                    source.number = number;
                    source.probability = Some(rounded(probability / 100.0, 4));
                }
            }
            Report::Hypothesis {
                region,
                probability,
            } => self.answer.hypotheses.push(Hypothesis {
                lat: region.latitude,
                lon: region.longitude,
                mass: rounded(probability / 100.0, 4),
                ellipse: ellipse(&region),
            }),
            Report::Advice { course_deg, metres } => self.answer.advice = way(course_deg, metres),
            Report::Errors => {
                self.has_end = true;
                whole.extend(self.finish());
            }
            Report::Status => whole.extend(self.finish()),
            Report::Tag { .. } => {}
        }
        if !self.has_end {
            whole.push(self.answer.clone());
            self.is_told = true;
        }
        whole
    }

    /// Begins another report; gives the one before, if its end was lost.
    fn begin(&mut self, time_ms: i64) -> Option<Answer> {
        let before = self.finish();
        // Another firmware may report now.
        self.has_end &= before.is_none();
        self.answer = words::nothing(time_ms);
        self.is_told = false;
        before
    }

    /// The report, unless it was told.
    fn finish(&mut self) -> Option<Answer> {
        let is_told = std::mem::replace(&mut self.is_told, true);
        (!is_told).then(|| self.answer.clone())
    }
}

fn source(region: &Region, bearings: u32) -> Source {
    Source {
        number: 0,
        lat: region.latitude,
        lon: region.longitude,
        covariance: region.covariance().map(|v| rounded(v, 3)),
        ellipse: ellipse(region),
        probability: None,
        fix: true,
        bearings,
    }
}

/// What holds the source with 95 %.
fn ellipse(region: &Region) -> Ellipse {
    let radii = (-2.0 * 0.05f64.ln()).sqrt();
    let [semi_major_m, semi_minor_m] = region.sigmas_m.map(|sigma| rounded(radii * sigma, 2));
    Ellipse {
        semi_major_m,
        semi_minor_m,
        angle_deg: region.angle_deg,
    }
}

/// Why there is no fix, by the word of a report.
fn why(word: &str, bearings: u32, figures: Option<[f64; 2]>) -> Reason {
    let [has, needs] = figures.unwrap_or_default();
    let reason = match word {
        "FEW" => NotObservable::TooFewBearings { have: bearings },
        "ANGLE" => NotObservable::CrossingAngle {
            have_rad: has.to_radians() as f32,
            needed_rad: needs.to_radians() as f32,
        },
        "APART" => NotObservable::NoIntersection,
        "WIDE" => NotObservable::WideRange {
            have: (has / 100.0) as f32,
            needed: (needs / 100.0) as f32,
        },
        _ => {
            let (text, help) = match word {
                "PLACES" => (
                    "several places fit",
                    NotObservable::SeveralPlaces { have: 2 }.help(),
                ),
                "CONTRARY" => (
                    "most bearings do not fit the best place",
                    NotObservable::Contradiction { outliers: 1.0 }.help(),
                ),
                "RANGE" => (
                    "the fix is too far from the origin for coordinates",
                    "restart the board: `$PFOXR*53`",
                ),
                _ => ("the board does not say why", "take more bearings"),
            };
            return Reason {
                code: word.to_owned(),
                text: text.to_owned(),
                help: help.to_owned(),
            };
        }
    };
    words::why(reason)
}
