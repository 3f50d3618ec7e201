//! The picture.

use foxhunt::aoa::geodesy::LocalPlane;

use super::coordinates::{clock, coordinates};
use super::{Archive, Kind, Taken, thinned};
use crate::{geodesy::Place, picture::Map};
use foxhunt_simulation::Sight;

/// The most of each kind that can be told apart: of a longer log every second, third, ... is drawn.
const MOST_BEARINGS: usize = 500;
const MOST_PLACES: usize = 4_000;

impl Archive {
    /// The last search, to be drawn.
    pub fn map(&self, title: &str) -> Map {
        let last = self.last();
        let of_kind = |wanted: &[Option<Kind>]| {
            let is = |taken: &&Taken| wanted.contains(&taken.kind());
            let all: Vec<Sight> = self.last_bearings().filter(is).map(sight).collect();
            thinned(&all, MOST_BEARINGS).copied().collect()
        };
        Map {
            title: title.into(),
            caption: self.caption(),
            sights: of_kind(&[None, Some(Kind::Direct)]),
            mirrored: of_kind(&[Some(Kind::Mirrored)]),
            rejected: of_kind(&[Some(Kind::Outlier)]),
            past: of_kind(&[Some(Kind::Past)]),
            track: self.way_on(&last.plane),
            moves: self.moves().into_values().collect(),
            densities: self.densities.clone(),
            particles: self.particles.clone(),
            hypotheses: (self.hypotheses.iter())
                .map(|hypothesis| (hypothesis.ellipse(0.95), hypothesis.probability.into()))
                .collect(),
            ellipses: (last.sources.iter())
                .map(|source| source.fix.ellipse(0.95))
                .collect(),
            truths: (self.truths.iter())
                .map(|truth| origin(&last.plane).local(*truth))
                .collect(),
        }
    }

    fn caption(&self) -> String {
        let last = self.last();
        let count = |kind| {
            self.last_bearings()
                .filter(|taken| taken.kind() == Some(kind))
                .count()
        };
        let mut bearings = format!(
            "{} bearings up to {} UTC",
            last.bearings,
            clock(last.time_ms)
        );
        for (kind, name) in [
            (Kind::Outlier, "rejected"),
            (Kind::Mirrored, "mirrored"),
            (Kind::Past, "of the past"),
        ] {
            if count(kind) > 0 {
                bearings += &format!(", {} {name}", count(kind));
            }
        }
        let sources = last.sources.iter().map(|source| {
            let ellipse = source.fix.ellipse(0.95);
            let place = match coordinates(&last.plane, source.fix.position) {
                Some([longitude, latitude]) => format!("{latitude:.6}, {longitude:.6}"),
                None => "out of range".into(),
            };
            let (major, minor) = (ellipse.semi_major, ellipse.semi_minor);
            format!("{place} (95 %: {major:.1} m by {minor:.1} m)")
        });
        let sources: Vec<String> = sources.collect();
        if sources.is_empty() {
            format!("{bearings}; no fix")
        } else {
            format!("{bearings}; {}", sources.join("; "))
        }
    }

    /// The way of the vehicle, as far as it is on the plane.
    fn way_on(&self, plane: &LocalPlane) -> Vec<[f64; 2]> {
        thinned(&self.track, MOST_PLACES)
            .filter_map(|passed| plane.to_local(passed.place).ok())
            .map(|place| place.map(f64::from))
            .collect()
    }
}

fn sight(taken: &Taken) -> Sight {
    Sight::from(&taken.observation)
}

fn origin(plane: &LocalPlane) -> Place {
    let [longitude, latitude] = super::coordinates::degrees(plane.origin());
    Place {
        latitude,
        longitude,
    }
}
