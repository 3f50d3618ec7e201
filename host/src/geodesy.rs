//! Places on the ellipsoid, in f64.

use geographiclib_rs::{DirectGeodesic, Geodesic, InverseGeodesic};

/// A place on the WGS84 ellipsoid.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Place {
    /// Degrees north of the equator.
    pub latitude: f64,
    /// Degrees east of Greenwich.
    pub longitude: f64,
}

impl Place {
    /// The place that lies `offset` metres east and north of this one.
    pub fn offset(self, offset: [f64; 2]) -> Self {
        let azimuth = offset[0].atan2(offset[1]).to_degrees();
        let distance = offset[0].hypot(offset[1]);
        let (latitude, longitude) =
            Geodesic::wgs84().direct(self.latitude, self.longitude, azimuth, distance);
        Self {
            latitude,
            longitude,
        }
    }

    /// Metres east and north from this place to `other`.
    pub fn local(self, other: Self) -> [f64; 2] {
        let (distance, azimuth) = self.geodesic(other);
        let (sin, cos) = azimuth.to_radians().sin_cos();
        [distance * sin, distance * cos]
    }

    /// Direction of `other` from this place, in degrees clockwise from true north, in [0, 360).
    pub fn compass_degrees(self, other: Self) -> f64 {
        self.geodesic(other).1.rem_euclid(360.0)
    }

    fn geodesic(self, other: Self) -> (f64, f64) {
        let (distance, azimuth, _, _) = Geodesic::wgs84().inverse(
            self.latitude,
            self.longitude,
            other.latitude,
            other.longitude,
        );
        (distance, azimuth)
    }

    /// The four fields of an NMEA sentence, to 1e-7 minutes: `5213.7780000,N,02100.7330000,E`.
    pub fn nmea(self) -> String {
        format!(
            "{},{},{},{}",
            minutes(self.latitude, 2),
            if self.latitude < 0.0 { 'S' } else { 'N' },
            minutes(self.longitude, 3),
            if self.longitude < 0.0 { 'W' } else { 'E' },
        )
    }

    /// From the fields of [`Self::nmea`]; `None` if they are not of that form.
    pub fn from_nmea(fields: &str) -> Option<Self> {
        let fields: Vec<&str> = fields.split(',').collect();
        let &[latitude, latitude_side, longitude, longitude_side] = fields.as_slice() else {
            return None;
        };
        Some(Self {
            latitude: degrees(latitude, 2)? * side(latitude_side, "N", "S")?,
            longitude: degrees(longitude, 3)? * side(longitude_side, "E", "W")?,
        })
    }
}

fn minutes(degrees: f64, digits: usize) -> String {
    let units = (degrees.abs() * 60e7).round() as u64;
    let (whole, minutes) = (units / 600_000_000, units % 600_000_000);
    format!(
        "{whole:0digits$}{:02}.{:07}",
        minutes / 10_000_000,
        minutes % 10_000_000
    )
}

fn degrees(text: &str, digits: usize) -> Option<f64> {
    let (whole, minutes) = text.split_at_checked(digits)?;
    Some(whole.parse::<f64>().ok()? + minutes.parse::<f64>().ok()? / 60.0)
}

fn side(text: &str, positive: &str, negative: &str) -> Option<f64> {
    if text == positive {
        Some(1.0)
    } else if text == negative {
        Some(-1.0)
    } else {
        None
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn there_and_back() {
        let origin = Place {
            latitude: -33.868_72,
            longitude: 151.212_76,
        };
        let place = origin.offset([1200.0, -800.0]);
        let [east, north] = origin.local(place);
        assert!((east - 1200.0).abs() < 1e-3 && (north + 800.0).abs() < 1e-3);
        let read = Place::from_nmea(&place.nmea()).unwrap();
        assert!((read.latitude - place.latitude).abs() < 1e-9);
        assert!((read.longitude - place.longitude).abs() < 1e-9);
    }
}
