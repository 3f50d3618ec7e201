//! All that a locator says.

use foxhunt::{
    aoa::{Answer, Bias, Fix, Hypothesis, Locate, Locator, NotObservable, Observation, SigmaScale},
    estimate::Symmetric2,
};

use super::{Digest, assert_normal};

/// Adds what a locator says, and what it says of a bearing.
pub fn add_answers<L: Locate>(
    digest: &mut Digest,
    locator: &Locator<L>,
    observation: &Observation,
) {
    match locator.answer() {
        Answer::Fix(fix) => add_fix(digest, &fix),
        Answer::NotObservable(reason) => add_reason(digest, reason),
    }
    for index in 0..4 {
        if let Some(source) = locator.source(index) {
            digest.add_bytes(&source.identity.to_le_bytes());
            digest.add(&[source.probability]);
            add_fix(digest, &source.fix);
            if let Some(motion) = source.motion {
                digest.add(&[motion.moving, motion.sigma_m_s]);
                digest.add(&motion.velocity_m_s);
            }
        }
        if let Some(cloud) = locator.cloud(index) {
            let columns = [cloud.east, cloud.north, cloud.weights];
            assert_normal(&columns);
            columns.iter().for_each(|column| digest.add(column));
        }
    }
    locator.hypotheses().for_each(|one| add_place(digest, &one));
    locator.candidates().for_each(|one| add_place(digest, &one));
    if let Some(Bias {
        mean_rad,
        sigma_rad,
    }) = locator.bias()
    {
        digest.add(&[mean_rad, sigma_rad]);
    }
    if let Some(SigmaScale { mean, sigma }) = locator.sigma_scale() {
        digest.add(&[mean, sigma]);
    }
    let mixtures = [locator.rates(), locator.classify(observation)];
    for mixture in mixtures.iter().flatten() {
        digest.add(&[mixture.direct, mixture.mirrored, mixture.outlier]);
    }
    if let Some(advice) = locator.advice() {
        let direction = advice.direction.radians();
        digest.add(&[direction, advice.information, advice.distance_m]);
    }
}

fn add_covariance(digest: &mut Digest, covariance: &Symmetric2) {
    digest.add(covariance.rows().as_flattened());
}

fn add_fix(digest: &mut Digest, fix: &Fix) {
    digest.add(&fix.position);
    add_covariance(digest, &fix.covariance);
    digest.add(&[fix.effective_sample_size]);
    digest.add_bytes(&fix.bearings.to_le_bytes());
}

fn add_place(digest: &mut Digest, one: &Hypothesis) {
    digest.add(&one.position);
    add_covariance(digest, &one.covariance);
    digest.add(&[one.probability]);
}

fn add_reason(digest: &mut Digest, reason: NotObservable) {
    digest.add_bytes(reason.help().as_bytes());
    match reason {
        NotObservable::TooFewBearings { have } => digest.add_bytes(&have.to_le_bytes()),
        NotObservable::CrossingAngle {
            have_rad,
            needed_rad,
        } => digest.add(&[have_rad, needed_rad]),
        NotObservable::SeveralPlaces { have } => digest.add_bytes(&have.to_le_bytes()),
        NotObservable::WideRange { have, needed } => digest.add(&[have, needed]),
        NotObservable::Contradiction { outliers } => digest.add(&[outliers]),
        _ => {}
    }
}
