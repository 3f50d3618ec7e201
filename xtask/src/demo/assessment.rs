//! How good a fix is.

mod coverage;

use std::{fmt, path::Path};

use anyhow::{Context, Result, ensure};
use foxhunt::{
    aoa::{Observation, triangulation::gauss_newton},
    estimate::Ellipse,
};
use foxhunt_host::{
    geodesy::Place,
    picture::{self, Map},
    reference::{Posterior, cramer_rao, mahalanobis},
    replay::Replay,
};

use self::coverage::Coverage;
use super::scene::Scene;
use crate::reports::vehicle::ReportedFix;

/// A fix beside the truth and the best that the same bearings allow. Places in metres from the origin.
pub struct Assessment {
    bearings: u32,
    fix: [f64; 2],
    sigmas: [f64; 2],
    truth: [f64; 2],
    posterior: Posterior,
    gauss_newton: [f64; 2],
    /// Root of the trace of the Cramer-Rao bound.
    bound: f64,
    ellipse: Ellipse,
    coverage: Coverage,
}

/// A fix may be this many posterior standard deviations from the exact posterior mean.
const FARTHEST: f64 = 0.3;

impl Assessment {
    /// Of the `fix` that the bearings of `replay` led to.
    pub fn new(fix: &ReportedFix, truth: Place, replay: &Replay) -> Result<Self> {
        let origin = replay
            .gateway()
            .plane()
            .context("the gateway has no origin")?
            .origin();
        let origin = Place {
            latitude: f64::from(origin.latitude_e7()) * 1e-7,
            longitude: f64::from(origin.longitude_e7()) * 1e-7,
        };
        let truth = origin.local(truth);
        let estimate = replay.fix().context("the gateway has no fix")?;
        let sights = replay.sights();
        let posterior = Posterior::new(sights).context("the bearings do not determine a place")?;
        let observations: Vec<Observation> = sights
            .iter()
            .map(|sight| (*sight).try_into())
            .collect::<Result<_, _>>()?;
        let start = posterior.mean.map(|v| v as f32);
        let (maximum, _) =
            gauss_newton(&observations, start).context("the bearings do not meet")?;
        Ok(Self {
            bearings: fix.bearings,
            fix: origin.local(fix.place),
            sigmas: fix.sigmas,
            truth,
            posterior,
            gauss_newton: maximum.map(f64::from),
            bound: cramer_rao(sights, truth)
                .context("the bearings do not determine a place")?
                .trace()
                .sqrt(),
            ellipse: estimate.ellipse(0.95),
            coverage: Coverage::new(&estimate, truth),
        })
    }

    /// Draws the drive and the fix.
    pub fn draw(&self, scene: &Scene, replay: &Replay, stem: &Path) -> Result<()> {
        let [major, minor] = self.sigmas;
        let places = replay.sights().iter().map(|sight| sight.position).collect();
        let map = Map {
            title: scene.title.clone(),
            caption: format!(
                "{} bearings through the firmware; the fix is {} from the true place, with sigmas of {} and {}",
                self.bearings,
                metres(self.error(self.fix)),
                metres(major),
                metres(minor),
            ),
            track: if scene.joined { places } else { Vec::new() },
            sights: replay.sights().to_vec(),
            particles: replay.particles(),
            ellipses: vec![self.ellipse],
            truths: vec![self.truth],
            ..Map::default()
        };
        picture::save(&map.svg()?, stem)
    }

    /// Fails if the fix is not where the bearings say.
    pub fn check(&self) -> Result<()> {
        ensure!(
            self.off_posterior() <= FARTHEST,
            "the fix is more than {FARTHEST} standard deviations from the mean of the exact posterior"
        );
        Ok(())
    }

    fn error(&self, place: [f64; 2]) -> f64 {
        distance(place, self.truth)
    }

    /// Distance of the fix from the mean of the exact posterior, in its standard deviations.
    fn off_posterior(&self) -> f64 {
        let offset = [0, 1].map(|d| self.fix[d] - self.posterior.mean[d]);
        mahalanobis(offset, &self.posterior.covariance)
    }
}

impl fmt::Display for Assessment {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [major, minor] = self.sigmas;
        writeln!(
            f,
            "distance from the true place, by {} bearings",
            self.bearings
        )?;
        writeln!(
            f,
            "  fix of the firmware   {:8.3} m   1 sigma {major:.3} x {minor:.3} m",
            self.error(self.fix)
        )?;
        writeln!(
            f,
            "  exact posterior mean  {:8.3} m",
            self.error(self.posterior.mean)
        )?;
        writeln!(
            f,
            "  Gauss-Newton          {:8.3} m",
            self.error(self.gauss_newton)
        )?;
        writeln!(f, "  Cramer-Rao bound      {:8.3} m", self.bound)?;
        writeln!(f, "{}", self.coverage)?;
        write!(
            f,
            "the fix is {:.3} m from the exact posterior mean: {:.2} posterior standard deviations (at most {FARTHEST})",
            distance(self.fix, self.posterior.mean),
            self.off_posterior(),
        )
    }
}

fn distance(a: [f64; 2], b: [f64; 2]) -> f64 {
    (a[0] - b[0]).hypot(a[1] - b[1])
}

/// Three digits are enough for a picture.
fn metres(value: f64) -> String {
    let decimals = (2.0 - value.log10().floor()).clamp(0.0, 3.0) as usize;
    format!("{value:.decimals$} m")
}
