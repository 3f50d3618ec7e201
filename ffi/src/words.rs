//! Observations and answers, and the generator.

use foxhunt::aoa::{Answer, Bearing, Fix, Hypothesis, NotObservable, Observation, Source};
use foxhunt::estimate::{Ellipse, Symmetric2};
use foxhunt::random::{SeedableRng, Xoshiro128PlusPlus};

use crate::door::{self, Out, opaque, plain};
use crate::result::{FoxhuntResult, FoxhuntText, code};

opaque!(
    /// A generator of random numbers: one seed replays one run.
    FoxhuntGenerator = b"fxGe": u64, Option<Xoshiro128PlusPlus> = None, NoGenerator
);

/// Seeds a generator. `size` is `sizeof *generator`.
#[unsafe(no_mangle)]
pub extern "C" fn foxhunt_generator_init(
    generator: *mut FoxhuntGenerator,
    size: usize,
    seed: u64,
) -> FoxhuntResult {
    code(door::init(generator, size, seed))
}

/// Calls `work` with a generator.
pub fn draw<R>(
    generator: *mut FoxhuntGenerator,
    work: impl FnOnce(&mut Xoshiro128PlusPlus) -> R,
) -> Result<R, FoxhuntResult> {
    door::change(generator, |seed, state| {
        work(state.get_or_insert_with(|| Xoshiro128PlusPlus::seed_from_u64(*seed)))
    })
}

/// A bearing on the source: where and when it was taken, by which station, and how far to trust it.
#[derive(Debug, Clone, Copy)]
#[repr(C)]
pub struct FoxhuntObservation {
    /// When, in milliseconds from any origin. It may wrap.
    pub time_ms: u32,
    /// Where, in metres east of the origin, up to 1e6.
    pub east_m: f32,
    /// And in metres north of it.
    pub north_m: f32,
    /// Direction of the source in radians counter-clockwise from east: see `foxhunt_from_compass`.
    pub bearing_rad: f32,
    /// Standard deviation of the bearing in radians, 0.001 to 3.2.
    pub sigma_rad: f32,
    /// Where the array pointed, as the bearing; zero if that is of no interest.
    pub heading_rad: f32,
    /// Number of the antenna array.
    pub station: u8,
    /// Number of the frequency or tag that it was heard on.
    pub channel: u8,
}

/// A symmetric matrix of two rows, such as a covariance in square metres.
#[derive(Debug, Clone, Copy, Default)]
#[repr(C)]
pub struct FoxhuntSymmetric2 {
    /// The entry of the first row and column.
    pub xx: f32,
    /// Either entry off the diagonal.
    pub xy: f32,
    /// The entry of the second row and column.
    pub yy: f32,
}

/// A located source.
#[derive(Debug, Clone, Copy, Default)]
#[repr(C)]
pub struct FoxhuntFix {
    /// Posterior mean in metres east of the origin.
    pub east_m: f32,
    /// And in metres north of it.
    pub north_m: f32,
    /// Posterior covariance in square metres.
    pub covariance: FoxhuntSymmetric2,
    /// How many equally weighted particles the cloud is worth.
    pub effective_sample_size: f32,
    /// How many bearings the fix rests on.
    pub bearings: u32,
}

/// What a locator knows, or why it does not: `foxhunt_answer_text` says it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[repr(u32)]
pub enum FoxhuntAnswerKind {
    /// There are fewer than two bearings: `have` of them.
    TooFewBearings = 0,
    /// Where the source is.
    Fix = 1,
    /// The bearings cross at too small an angle: `have` and `needed` in radians.
    CrossingAngle = 2,
    /// The bearings do not meet in front of their receivers.
    NoIntersection = 3,
    /// Several places fit: `have` of them.
    SeveralPlaces = 4,
    /// The range is not known well enough: `have` and `needed` are fractions of the range.
    WideRange = 5,
    /// Most bearings do not fit the best place: `have` is the fraction of outliers.
    Contradiction = 6,
    /// Another reason.
    Other = 7,
}

/// What a locator knows of the source.
#[derive(Debug, Clone, Copy)]
#[repr(C)]
pub struct FoxhuntAnswer {
    /// Whether there is a fix, or why not.
    pub kind: FoxhuntAnswerKind,
    /// What there is, where there is no fix.
    pub have: f32,
    /// What is needed, where that is known.
    pub needed: f32,
    /// The fix, if there is one.
    pub fix: FoxhuntFix,
}

/// A place where the source may be.
#[derive(Debug, Clone, Copy)]
#[repr(C)]
pub struct FoxhuntHypothesis {
    /// Metres east of the origin.
    pub east_m: f32,
    /// Metres north of it.
    pub north_m: f32,
    /// Covariance in square metres, if this is the place.
    pub covariance: FoxhuntSymmetric2,
    /// Probability of this place among all.
    pub probability: f32,
}

/// One of several sources.
#[derive(Debug, Clone, Copy)]
#[repr(C)]
pub struct FoxhuntSource {
    /// A number that it keeps for as long as it is tracked.
    pub identity: u32,
    /// Probability that there is such a source and that it is still heard.
    pub probability: f32,
    /// Where it is.
    pub fix: FoxhuntFix,
    /// Probability that it moves now.
    pub moving: f32,
    /// If it moves: metres a second east.
    pub east_m_s: f32,
    /// And north.
    pub north_m_s: f32,
    /// Standard deviation of either.
    pub sigma_m_s: f32,
}

/// An ellipse in the plane.
#[derive(Debug, Clone, Copy)]
#[repr(C)]
pub struct FoxhuntEllipse {
    /// Half of its longest diameter, in metres.
    pub semi_major_m: f32,
    /// Half of its shortest diameter, in metres.
    pub semi_minor_m: f32,
    /// Direction of the longest diameter in radians counter-clockwise from east.
    pub orientation_rad: f32,
}

plain!(FoxhuntObservation, FoxhuntSymmetric2);

impl FoxhuntObservation {
    /// In the library's words.
    pub fn to_rust(self) -> Result<Observation, FoxhuntResult> {
        let heading = Bearing::from_radians(self.heading_rad);
        if !heading.radians().is_finite() {
            return Err(FoxhuntResult::Heading);
        }
        let bearing = Bearing::from_radians(self.bearing_rad);
        let position = [self.east_m, self.north_m];
        let observation = Observation::new(self.time_ms, position, bearing, self.sigma_rad)?;
        Ok(observation
            .from_station(self.station)
            .on_channel(self.channel)
            .with_heading(heading))
    }
}

impl From<Symmetric2> for FoxhuntSymmetric2 {
    fn from(Symmetric2 { xx, xy, yy }: Symmetric2) -> Self {
        Self { xx, xy, yy }
    }
}

impl From<Fix> for FoxhuntFix {
    fn from(fix: Fix) -> Self {
        let [east_m, north_m] = fix.position;
        Self {
            east_m,
            north_m,
            covariance: fix.covariance.into(),
            effective_sample_size: fix.effective_sample_size,
            bearings: fix.bearings,
        }
    }
}

impl From<Answer> for FoxhuntAnswer {
    fn from(answer: Answer) -> Self {
        match answer {
            Answer::Fix(fix) => fix.into(),
            Answer::NotObservable(reason) => reason.into(),
        }
    }
}

impl From<Fix> for FoxhuntAnswer {
    fn from(fix: Fix) -> Self {
        Self {
            fix: fix.into(),
            ..Self::without_fix(FoxhuntAnswerKind::Fix, 0.0, 0.0)
        }
    }
}

impl From<NotObservable> for FoxhuntAnswer {
    fn from(reason: NotObservable) -> Self {
        use FoxhuntAnswerKind as Kind;
        let (kind, have, needed) = match reason {
            NotObservable::TooFewBearings { have } => (Kind::TooFewBearings, have as f32, 2.0),
            NotObservable::CrossingAngle {
                have_rad,
                needed_rad,
            } => (Kind::CrossingAngle, have_rad, needed_rad),
            NotObservable::NoIntersection => (Kind::NoIntersection, 0.0, 0.0),
            NotObservable::SeveralPlaces { have } => (Kind::SeveralPlaces, have as f32, 1.0),
            NotObservable::WideRange { have, needed } => (Kind::WideRange, have, needed),
            NotObservable::Contradiction { outliers } => (Kind::Contradiction, outliers, 0.0),
            _ => (Kind::Other, 0.0, 0.0),
        };
        Self::without_fix(kind, have, needed)
    }
}

impl FoxhuntAnswerKind {
    /// Every kind with its text.
    const TEXTS: [(Self, &str); 8] = [
        (Self::TooFewBearings, "too few bearings"),
        (Self::Fix, "a fix"),
        (
            Self::CrossingAngle,
            "the bearings cross at too small an angle",
        ),
        (
            Self::NoIntersection,
            "the bearings do not meet in front of their receivers",
        ),
        (Self::SeveralPlaces, "several places fit"),
        (Self::WideRange, "the range is not known well enough"),
        (
            Self::Contradiction,
            "most bearings do not fit the best place",
        ),
        (Self::Other, "no fix"),
    ];
}

/// What a kind of answer says, without its numbers; an empty text of any other number.
#[unsafe(no_mangle)]
pub extern "C" fn foxhunt_answer_text(kind: u32) -> FoxhuntText {
    let mut texts = FoxhuntAnswerKind::TEXTS.iter();
    let found = texts.find(|(known, _)| *known as u32 == kind);
    found.map_or("", |(_, text)| text).into()
}

impl FoxhuntAnswer {
    /// One that says this much.
    pub fn without_fix(kind: FoxhuntAnswerKind, have: f32, needed: f32) -> Self {
        Self {
            kind,
            have,
            needed,
            fix: FoxhuntFix::default(),
        }
    }
}

impl From<Hypothesis> for FoxhuntHypothesis {
    fn from(hypothesis: Hypothesis) -> Self {
        let [east_m, north_m] = hypothesis.position;
        Self {
            east_m,
            north_m,
            covariance: hypothesis.covariance.into(),
            probability: hypothesis.probability,
        }
    }
}

impl From<Source> for FoxhuntSource {
    fn from(source: Source) -> Self {
        let motion = source.motion;
        let [east_m_s, north_m_s] = motion.map_or([0.0; 2], |motion| motion.velocity_m_s);
        Self {
            identity: source.identity.into(),
            probability: source.probability,
            fix: source.fix.into(),
            moving: motion.map_or(0.0, |motion| motion.moving),
            east_m_s,
            north_m_s,
            sigma_m_s: motion.map_or(0.0, |motion| motion.sigma_m_s),
        }
    }
}

/// Radians counter-clockwise from east, of degrees clockwise from true north.
#[unsafe(no_mangle)]
pub extern "C" fn foxhunt_from_compass(degrees: f32) -> f32 {
    Bearing::from_compass_degrees(degrees).radians()
}

/// Degrees clockwise from true north, 0 to 360, of radians counter-clockwise from east.
#[unsafe(no_mangle)]
pub extern "C" fn foxhunt_to_compass(radians: f32) -> f32 {
    Bearing::from_radians(radians).compass_degrees()
}

impl FoxhuntSymmetric2 {
    /// In the library's words.
    ///
    /// # Errors
    /// If it is no covariance.
    fn to_covariance(self) -> Result<Symmetric2, FoxhuntResult> {
        /// More than rounding adds to the square of the correlation of what lies on a line.
        const ROUNDING: f32 = 1e-3;
        let Self { xx, xy, yy } = self;
        let is_finite = [xx, xy, yy].iter().all(|entry| entry.is_finite());
        if is_finite && xx >= 0.0 && yy >= 0.0 && xy * xy <= (1.0 + ROUNDING) * (xx * yy) {
            Ok(Symmetric2 { xx, xy, yy })
        } else {
            Err(FoxhuntResult::Covariance)
        }
    }
}

/// The ellipse that holds what has this covariance with a probability from 0 to 1, such as 0.95 for 95 %.
#[unsafe(no_mangle)]
pub extern "C" fn foxhunt_ellipse(
    covariance: *const FoxhuntSymmetric2,
    probability: f32,
    ellipse: *mut FoxhuntEllipse,
) -> FoxhuntResult {
    let result = || {
        let covariance = door::get(covariance)?;
        let out = Out::new(ellipse)?;
        if !(0.0..=1.0).contains(&probability) {
            return Err(FoxhuntResult::Probability);
        }
        let Ellipse {
            semi_major,
            semi_minor,
            orientation,
            ..
        } = Ellipse::of_normal([0.0; 2], covariance.to_covariance()?, probability);
        out.write(FoxhuntEllipse {
            semi_major_m: semi_major,
            semi_minor_m: semi_minor,
            orientation_rad: orientation,
        });
        Ok(())
    };
    code(result())
}
