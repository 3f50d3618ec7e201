//! What a locator knows, as messages.

use foxhunt::aoa::{self, Bearing, FARTHEST_M, Locate, Observation};

use crate::messages::{Advice, Answer, Ellipse, Hypothesis, Reason, Source, Taken};

/// The most sources, and the most hypotheses, that are asked for.
const MOST: usize = 16;
/// A hypothesis of less than this probability is not worth drawing.
const SMALLEST: f32 = 1e-3;
/// Where the driver is sent if no distance is known, in metres.
const AHEAD_M: f32 = 500.0;

/// All that a locator knows, while the vehicle is `here`.
pub fn answer<L: Locate>(locator: &L, config: &L::Config, here: [f32; 2]) -> Answer {
    let not_observable = match locator.answer() {
        aoa::Answer::Fix(_) => None,
        aoa::Answer::NotObservable(reason) => Some(reason),
    };
    let hypotheses = (0..MOST).map_while(|index| locator.hypothesis(index));
    let mut hypotheses: Vec<Hypothesis> = hypotheses
        .filter(|hypothesis| hypothesis.probability > SMALLEST)
        .map(of_hypothesis)
        .collect();
    hypotheses.sort_by(|a, b| b.mass.total_cmp(&a.mass));
    Answer {
        sources: (0..MOST)
            .map_while(|index| locator.source(index))
            .map(of_source)
            .collect(),
        hypotheses,
        reason: not_observable.map(Reason::of),
        advice: locator
            .advice(config)
            .map(|advice| of_advice(&advice, here)),
        bias_deg: locator
            .bias(config)
            .map(|bias| [-bias.mean_rad.to_degrees(), bias.sigma_rad.to_degrees()]),
        rates: locator
            .rates(config)
            .map(|rates| [rates.direct, rates.mirrored, rates.outlier]),
        particles: (0..MOST)
            .map_while(|index| locator.cloud(index))
            .flat_map(|cloud| particles(&cloud))
            .collect(),
    }
}

/// The probability that a bearing is an outlier.
pub fn outlier<L: Locate>(
    observation: &Observation,
    locator: &L,
    config: &L::Config,
) -> Option<f32> {
    let kinds = locator.classify(observation, config)?;
    Some(kinds.outlier)
}

/// A bearing as the locator takes it now. `then` is the probability that it was an outlier when it was taken.
pub fn taken<L: Locate>(
    (id, observation): (usize, &Observation),
    then: Option<f32>,
    locator: &L,
    config: &L::Config,
) -> Taken {
    let [x, y] = observation.position();
    let now = outlier(observation, locator, config);
    let is_outlier = |probability: f32| probability > 0.5;
    let mut sources = (0..MOST).map_while(|index| locator.source(index));
    let past = now.is_some_and(is_outlier)
        && then.is_some_and(|then| !is_outlier(then))
        && sources.any(|source| source.motion.is_some());
    Taken {
        id: id as u32,
        time_ms: observation.time_ms(),
        x,
        y,
        bearing_deg: observation.bearing().compass_degrees(),
        sigma_deg: observation.sigma_rad().to_degrees(),
        outlier: now,
        past,
    }
}

fn of_source(source: aoa::Source) -> Source {
    let fix = source.fix;
    Source {
        number: source.identity,
        x: fix.position[0],
        y: fix.position[1],
        covariance: [fix.covariance.xx, fix.covariance.xy, fix.covariance.yy],
        ellipse: Ellipse::of(fix.covariance),
        probability: source.probability,
        moving: source.motion.map(|motion| motion.moving),
        velocity_m_s: source.motion.map(|motion| motion.velocity_m_s),
        bearings: fix.bearings,
        effective_sample_size: fix.effective_sample_size,
    }
}

fn of_hypothesis(hypothesis: aoa::Hypothesis) -> Hypothesis {
    Hypothesis {
        x: hypothesis.position[0],
        y: hypothesis.position[1],
        mass: hypothesis.probability,
        ellipse: Ellipse::of(hypothesis.covariance),
    }
}

fn of_advice(advice: &aoa::Advice, here: [f32; 2]) -> Advice {
    let known = advice.distance_m > 0.0 && advice.distance_m <= FARTHEST_M;
    let distance = if known { advice.distance_m } else { AHEAD_M };
    let (sin, cos) = foxhunt::math::sin_cos(advice.direction.radians());
    let towards = compass_point(advice.direction);
    let text = if known {
        format!("Drive {towards} for about {}.", rounded(distance))
    } else {
        format!("Drive {towards}.")
    };
    Advice {
        x: here[0] + distance * cos,
        y: here[1] + distance * sin,
        text,
    }
}

/// The nearest of 16 directions, in words.
fn compass_point(direction: Bearing) -> &'static str {
    const POINTS: [&str; 16] = [
        "north",
        "north-north-east",
        "north-east",
        "east-north-east",
        "east",
        "east-south-east",
        "south-east",
        "south-south-east",
        "south",
        "south-south-west",
        "south-west",
        "west-south-west",
        "west",
        "west-north-west",
        "north-west",
        "north-north-west",
    ];
    let index = (direction.compass_degrees() / 22.5 + 0.5) as usize;
    POINTS[index % POINTS.len()]
}

/// A distance of two digits.
fn rounded(metres: f32) -> String {
    if metres < 100.0 {
        format!("{metres:.0} m")
    } else if metres < 1_000.0 {
        format!("{:.0}0 m", metres / 10.0)
    } else {
        format!("{:.1} km", metres / 1_000.0)
    }
}

/// East, north and weight times their number of each particle.
fn particles(cloud: &aoa::Cloud<'_>) -> Vec<f32> {
    let count = cloud.weights.len() as f32;
    let places = cloud.east.iter().zip(cloud.north).zip(cloud.weights);
    places
        .flat_map(|((east, north), weight)| [*east, *north, count * weight])
        .collect()
}
