//! The part of the plane that a picture shows.

use foxhunt::estimate::Ellipse;

use foxhunt_simulation::Sight;

/// The outline of an ellipse, counter-clockwise: 181 places, of which the last is the first.
pub fn outline(ellipse: &Ellipse) -> impl Iterator<Item = [f64; 2]> + Clone + use<> {
    let [x, y] = ellipse.centre.map(f64::from);
    let (major, minor) = (f64::from(ellipse.semi_major), f64::from(ellipse.semi_minor));
    let (sin, cos) = f64::from(ellipse.orientation).sin_cos();
    (0..=180).map(move |k| {
        // Exactly closed.
        let (s, c) = f64::from(2 * (k % 180)).to_radians().sin_cos();
        [
            x + major * c * cos - minor * s * sin,
            y + major * c * sin + minor * s * cos,
        ]
    })
}

/// A box in the plane.
#[derive(Debug, Clone, Copy)]
pub(super) struct Frame {
    pub low: [f64; 2],
    pub high: [f64; 2],
}

impl Frame {
    pub fn round(places: impl Iterator<Item = [f64; 2]>) -> Self {
        places
            .map(|place| Self {
                low: place,
                high: place,
            })
            .reduce(|a, b| Self {
                low: [0, 1].map(|d| a.low[d].min(b.low[d])),
                high: [0, 1].map(|d| a.high[d].max(b.high[d])),
            })
            .unwrap_or(Self {
                low: [-1.0; 2],
                high: [1.0; 2],
            })
    }

    fn resized(self, width: f64, height: f64) -> Self {
        let half = [width / 2.0, height / 2.0];
        let centre = [0, 1].map(|d| (self.low[d] + self.high[d]) / 2.0);
        Self {
            low: [0, 1].map(|d| centre[d] - half[d]),
            high: [0, 1].map(|d| centre[d] + half[d]),
        }
    }

    pub fn widened(self, factor: f64) -> Self {
        let [width, height] = self.size();
        let margin = (factor - 1.0) * width.max(height).max(1e-3);
        self.resized(width + margin, height + margin)
    }

    /// The same, made wider or higher until its sides are as `width` to `height`.
    pub fn with_shape(self, width: f64, height: f64) -> Self {
        let [w, h] = self.size();
        let scale = (w / width).max(h / height);
        self.resized(scale * width, scale * height)
    }

    fn size(&self) -> [f64; 2] {
        [0, 1].map(|d| self.high[d] - self.low[d])
    }

    /// Digits that tell the numbers of an axis apart.
    pub fn decimals(&self) -> usize {
        let [width, height] = self.size();
        (-(width.min(height) / 16.0).log10().floor()).clamp(0.0, 4.0) as usize
    }

    pub fn contains(&self, place: [f64; 2]) -> bool {
        [0, 1]
            .into_iter()
            .all(|d| (self.low[d]..=self.high[d]).contains(&place[d]))
    }

    /// The part of a bearing's ray that lies inside.
    pub fn ray(&self, sight: &Sight) -> Option<[(f64, f64); 2]> {
        let (sin, cos) = sight.bearing.sin_cos();
        self.part(sight.position, [cos, sin], f64::INFINITY)
    }

    /// The parts of a line that lie inside.
    pub fn line(&self, places: impl IntoIterator<Item = [f64; 2]>) -> Vec<Vec<(f64, f64)>> {
        let mut parts: Vec<Vec<(f64, f64)>> = Vec::new();
        let mut last: Option<[f64; 2]> = None;
        let mut is_open = false;
        for place in places {
            let Some(from) = last.replace(place) else {
                continue;
            };
            let step = [place[0] - from[0], place[1] - from[1]];
            if let Some([near, far]) = self.part(from, step, 1.0) {
                match parts.last_mut().filter(|_| is_open) {
                    Some(part) => part.push(far),
                    None => parts.push(vec![near, far]),
                }
            }
            is_open = self.contains(place);
        }
        parts
    }

    /// The part inside of what goes from a place in a direction, up to so many times its length.
    fn part(&self, from: [f64; 2], step: [f64; 2], length: f64) -> Option<[(f64, f64); 2]> {
        let (mut near, mut far) = (0.0_f64, length);
        for d in [0, 1] {
            let at = |side: f64| (side - from[d]) / step[d];
            let (a, b) = (at(self.low[d]), at(self.high[d]));
            if a.is_nan() || b.is_nan() {
                return None;
            }
            near = near.max(a.min(b));
            far = far.min(a.max(b));
        }
        let point = |t: f64| (from[0] + t * step[0], from[1] + t * step[1]);
        (near < far).then(|| [point(near), point(far)])
    }

    /// What of a polygon lies inside (Sutherland and Hodgman, 1974); parts of a hollow one may stay joined by the border.
    pub fn polygon(&self, ring: &[[f64; 2]]) -> Vec<(f64, f64)> {
        let mut ring = ring.to_vec();
        for (d, side, inner) in [
            (0, self.low[0], 1.0),
            (0, self.high[0], -1.0),
            (1, self.low[1], 1.0),
            (1, self.high[1], -1.0),
        ] {
            let depth = |place: &[f64; 2]| inner * (place[d] - side);
            let mut clipped = Vec::new();
            for (k, place) in ring.iter().enumerate() {
                let before = &ring[(k + ring.len() - 1) % ring.len()];
                let (from, to) = (depth(before), depth(place));
                if (from < 0.0) != (to < 0.0) {
                    let fraction = from / (from - to);
                    clipped.push([0, 1].map(|e| before[e] + fraction * (place[e] - before[e])));
                }
                if to >= 0.0 {
                    clipped.push(*place);
                }
            }
            ring = clipped;
        }
        ring.into_iter().map(|[x, y]| (x, y)).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const FRAME: Frame = Frame {
        low: [0.0, 0.0],
        high: [10.0, 4.0],
    };

    #[test]
    fn what_lies_outside_is_cut_off() {
        let ring = [[-5.0, 1.0], [5.0, 1.0], [5.0, 9.0], [-5.0, 9.0]];
        let mut corners = FRAME.polygon(&ring);
        corners.sort_by(|a, b| a.partial_cmp(b).unwrap());
        assert_eq!(corners, [(0.0, 1.0), (0.0, 4.0), (5.0, 1.0), (5.0, 4.0)]);
        assert!(
            FRAME
                .polygon(&[[-3.0, 0.0], [-1.0, 0.0], [-1.0, 2.0]])
                .is_empty()
        );

        let parts = FRAME.line([
            [-5.0, 2.0],
            [5.0, 2.0],
            [5.0, 3.0],
            [5.0, 9.0],
            [9.0, 9.0],
            [9.0, -1.0],
        ]);
        assert_eq!(
            parts,
            [
                vec![(0.0, 2.0), (5.0, 2.0), (5.0, 3.0), (5.0, 4.0)],
                vec![(9.0, 4.0), (9.0, 0.0)],
            ]
        );
    }

    #[test]
    fn an_outline_is_closed() {
        let ellipse = Ellipse {
            centre: [1.0, 2.0],
            semi_major: 3.0,
            semi_minor: 1.0,
            orientation: 0.3,
        };
        assert_eq!(outline(&ellipse).next(), outline(&ellipse).last());
    }
}
