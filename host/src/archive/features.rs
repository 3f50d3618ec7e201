//! The map for other programs: GeoJSON (RFC 7946).
//!
//! Every feature has a `layer`, what is known of it, and its colours as the simplestyle specification names them, which
//! many viewers show.

use anyhow::Result;
use foxhunt::{aoa::geodesy::LocalPlane, estimate::Ellipse};
use geojson::{Feature, FeatureCollection, GeoJson, Geometry, GeometryValue, JsonObject};
use serde::Serialize;
use serde_json::{Value, json};

use super::coordinates::{coordinates, degrees, rounded};
use super::tables::{BearingRow, FixRow};
use super::{Archive, Kind, Taken, thinned};
use crate::picture::outline;

/// The most of each: of a longer log every second, third, ... is shown. The tables have all.
const MOST_BEARINGS: usize = 800;
const MOST_FIXES: usize = 400;
const MOST_PLACES: usize = 4_000;

/// A ray goes this much farther than what it points at.
const BEYOND: f64 = 1.15;
/// Metres that it goes at the least.
const SHORTEST: f64 = 50.0;

impl Archive {
    /// The features: of each source the regions of its density, its 95 % ellipse and where it is; hypotheses; bearings; the
    /// way of the vehicle and of sources that may move; the fixes on the way to the last one.
    ///
    /// # Errors
    /// If a row of the tables cannot be turned into properties.
    pub fn geojson(&self) -> Result<GeoJson> {
        let mut features = Vec::new();
        self.densities(&mut features);
        self.hypotheses(&mut features);
        self.rays(&mut features)?;
        self.way(&mut features);
        self.ways_of_sources(&mut features);
        self.fixes(&mut features)?;
        Ok(GeoJson::FeatureCollection(FeatureCollection::new(features)))
    }

    fn densities(&self, features: &mut Vec<Feature>) {
        let last = self.last();
        for (source, regions) in last.sources.iter().zip(&self.densities) {
            for region in regions {
                let polygons: Vec<Vec<Vec<[f64; 2]>>> = (region.polygons.iter())
                    .map(|rings| rings.iter().map(|ring| line(&last.plane, ring)).collect())
                    .collect();
                features.push(feature(
                    GeometryValue::new_multi_polygon(polygons),
                    json!({
                        "layer": "density", "source": source.identity, "probability": region.probability,
                        "stroke": "#008996", "stroke-width": 0.5, "stroke-opacity": 0.5, "fill": "#008996",
                        "fill-opacity": 0.16,
                    }),
                ));
            }
        }
    }

    fn hypotheses(&self, features: &mut Vec<Feature>) {
        for hypothesis in &self.hypotheses {
            let polygon = ellipse(&self.last().plane, &hypothesis.ellipse(0.95));
            features.push(feature(
                GeometryValue::new_polygon([polygon]),
                json!({
                    "layer": "hypothesis", "probability": rounded(hypothesis.probability, 4), "stroke": "#5e35b1",
                    "stroke-width": 1.5, "fill-opacity": 0.0,
                }),
            ));
        }
    }

    fn rays(&self, features: &mut Vec<Feature>) -> Result<()> {
        let bearings: Vec<&Taken> = self.last_bearings().collect();
        let range = self.range();
        for taken in thinned(&bearings, MOST_BEARINGS) {
            let [from, to] = ray(taken, range);
            let ends = [from, to].map(|place| coordinates(&taken.plane, place));
            let [Some(from), Some(to)] = ends else {
                continue;
            };
            let colour = match taken.kind() {
                Some(Kind::Outlier) => "#788288",
                Some(Kind::Mirrored) => "#1e88e5",
                Some(Kind::Past) => "#bc9e8a",
                Some(Kind::Direct) | None => "#f08c28",
            };
            let mut properties = object(&BearingRow::of(taken))?;
            properties.extend(object(&json!({
                "layer": "bearing", "stroke": colour, "stroke-width": 1, "stroke-opacity": 0.6,
            }))?);
            features.push(feature(
                GeometryValue::new_line_string([from, to]),
                Value::Object(properties),
            ));
        }
        Ok(())
    }

    fn way(&self, features: &mut Vec<Feature>) {
        let track = thinned(&self.track, MOST_PLACES).map(|passed| degrees(passed.place));
        let track: Vec<[f64; 2]> = track.collect();
        // A line has two places at the least.
        if let [first, .., _] = track.as_slice() {
            let track = track.iter().map(|place| near(*place, *first));
            features.push(feature(
                GeometryValue::new_line_string(track),
                json!({"layer": "track", "stroke": "#263238", "stroke-width": 2}),
            ));
        }
    }

    fn ways_of_sources(&self, features: &mut Vec<Feature>) {
        let plane = self.last().plane;
        for (source, places) in self.moves() {
            let places: Vec<[f64; 2]> = thinned(&places, MOST_FIXES).copied().collect();
            if places.len() >= 2 {
                features.push(feature(
                    GeometryValue::new_line_string(line(&plane, &places)),
                    json!({
                        "layer": "source track", "source": source, "stroke": "#d98ca1", "stroke-width": 1.5,
                    }),
                ));
            }
        }
    }

    fn fixes(&self, features: &mut Vec<Feature>) -> Result<()> {
        let rows = self.fix_rows();
        let placed: Vec<&FixRow> = rows.iter().filter(|row| row.latitude.is_some()).collect();
        let style = json!({"layer": "fix", "marker-color": "#d98ca1", "marker-size": "small"});
        for row in thinned(&placed, MOST_FIXES) {
            features.extend(point(row, &style)?);
        }
        let last = self.last();
        for source in &last.sources {
            features.push(feature(
                GeometryValue::new_polygon([ellipse(&last.plane, &source.fix.ellipse(0.95))]),
                json!({
                    "layer": "ellipse", "source": source.identity, "probability": 0.95, "stroke": "#c81e46",
                    "stroke-width": 2.5, "fill-opacity": 0.0,
                }),
            ));
        }
        let style =
            json!({"layer": "last fix", "marker-color": "#c81e46", "marker-size": "medium"});
        for row in FixRow::of(last) {
            features.extend(point(&row, &style)?);
        }
        Ok(())
    }

    /// How far a ray goes that points at nothing known, in metres: as far as the best hypothesis is, or as the vehicle
    /// drove.
    pub(super) fn range(&self) -> f64 {
        let places = self
            .last_bearings()
            .map(|taken| taken.observation.position());
        let best = (self.hypotheses.iter()).max_by(|a, b| a.probability.total_cmp(&b.probability));
        let targets = places.clone().chain(best.map(|best| best.position));
        let first = places.clone().next().unwrap_or_default();
        let farthest = targets
            .map(|place| distance(first, place))
            .fold(0.0, f64::max);
        farthest.clamp(SHORTEST, 20_000.0)
    }
}

/// Where a bearing was taken, and where its ray ends.
pub(super) fn ray(taken: &Taken, range: f64) -> [[f32; 2]; 2] {
    let from = taken.observation.position();
    let fits = taken
        .fits
        .map(|(source, _)| distance(from, source.fix.position));
    let length = BEYOND * fits.unwrap_or(range).max(SHORTEST);
    let (sin, cos) = f64::from(taken.observation.bearing().radians()).sin_cos();
    let [x, y] = from.map(f64::from);
    let to = [x + length * cos, y + length * sin];
    [from, to.map(|v| v as f32)]
}

fn distance(a: [f32; 2], b: [f32; 2]) -> f64 {
    f64::from(a[0] - b[0]).hypot(f64::from(a[1] - b[1]))
}

/// The outline of an ellipse, counter-clockwise; coarser than in a picture.
pub(super) fn ellipse(plane: &LocalPlane, ellipse: &Ellipse) -> Vec<[f64; 2]> {
    let ring: Vec<[f64; 2]> = outline(ellipse).step_by(3).collect();
    line(plane, &ring)
}

/// Places of the plane; without those beyond it.
fn line(plane: &LocalPlane, places: &[[f64; 2]]) -> Vec<[f64; 2]> {
    let origin = degrees(plane.origin());
    (places.iter())
        .filter_map(|place| coordinates(plane, place.map(|v| v as f32)))
        .map(|place| near(place, origin))
        .collect()
}

/// The same place, its longitude within half a turn of that of another, so that no line goes round the earth.
fn near([longitude, latitude]: [f64; 2], [other, _]: [f64; 2]) -> [f64; 2] {
    let turns = ((longitude - other) / 360.0).round();
    [longitude - 360.0 * turns, latitude]
}

fn point(row: &FixRow, style: &Value) -> Result<Option<Feature>> {
    let (Some(longitude), Some(latitude)) = (row.longitude, row.latitude) else {
        return Ok(None);
    };
    let mut properties = object(row)?;
    properties.extend(object(style)?);
    Ok(Some(feature(
        GeometryValue::new_point([longitude, latitude]),
        Value::Object(properties),
    )))
}

fn feature(geometry: GeometryValue, properties: Value) -> Feature {
    let mut feature = Feature::from(Geometry::new(geometry));
    if let Value::Object(properties) = properties {
        feature.properties = Some(properties);
    }
    feature
}

/// The fields that have a value.
fn object(row: &impl Serialize) -> Result<JsonObject> {
    let fields: JsonObject = serde_json::from_value(serde_json::to_value(row)?)?;
    Ok(fields.into_iter().filter(|(_, v)| !v.is_null()).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_date_line_is_crossed_the_short_way() {
        assert_eq!(near([-179.0, 1.0], [179.5, 0.0]), [181.0, 1.0]);
        assert_eq!(near([179.0, 1.0], [-179.5, 0.0]), [-181.0, 1.0]);
        assert_eq!(near([20.0, 1.0], [21.0, 0.0]), [20.0, 1.0]);
    }
}
