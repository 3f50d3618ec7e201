//! Ways in the plane.

use alloc::vec::Vec;

/// Where something was, at some times; between these it went straight on.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Path {
    corners: Vec<(f64, [f64; 2])>,
}

impl Path {
    /// From the places at rising times: seconds, metres.
    pub fn new(corners: &[(f64, [f64; 2])]) -> Self {
        Self {
            corners: corners.to_vec(),
        }
    }

    /// Along a line through `corners` at a constant speed, from a time in seconds on.
    pub fn along(corners: &[[f64; 2]], speed_m_s: f64, start_s: f64) -> Self {
        let mut path = Self::default();
        let mut time = start_s;
        let mut last: Option<[f64; 2]> = None;
        for &corner in corners {
            time += last.map_or(0.0, |last| distance(last, corner) / speed_m_s);
            path.push(time, corner);
            last = Some(corner);
        }
        path
    }

    /// Adds a place at a later time.
    pub fn push(&mut self, seconds: f64, place: [f64; 2]) {
        self.corners.push((seconds, place));
    }

    /// The times and the places.
    pub fn corners(&self) -> &[(f64, [f64; 2])] {
        &self.corners
    }

    /// The first and the last time.
    pub fn times(&self) -> Option<[f64; 2]> {
        Some([self.corners.first()?.0, self.corners.last()?.0])
    }

    /// Where it was; `None` before it began and after it ended.
    pub fn at(&self, seconds: f64) -> Option<[f64; 2]> {
        let next = self.corners.partition_point(|(time, _)| *time < seconds);
        let (end, to) = *self.corners.get(next)?;
        let Some((start, from)) = next.checked_sub(1).map(|last| self.corners[last]) else {
            return (end == seconds).then_some(to);
        };
        let fraction = (seconds - start) / (end - start);
        Some([0, 1].map(|d| from[d] + fraction * (to[d] - from[d])))
    }

    /// The same; before it began and after it ended, it is at its ends. `None` of an empty path.
    pub fn held(&self, seconds: f64) -> Option<[f64; 2]> {
        let (&(start, first), &(_, last)) = (self.corners.first()?, self.corners.last()?);
        let ends = if seconds < start { first } else { last };
        Some(self.at(seconds).unwrap_or(ends))
    }
}

/// `count` places at equal distances along the line through `corners`, both ends included.
pub fn along(corners: &[[f64; 2]], count: usize) -> Vec<[f64; 2]> {
    let lengths: Vec<f64> = (corners.windows(2))
        .map(|leg| distance(leg[0], leg[1]))
        .collect();
    let step = lengths.iter().sum::<f64>() / (count.max(2) - 1) as f64;
    (0..count)
        .map(|k| {
            let mut rest = step * k as f64;
            let mut leg = 0;
            while leg + 1 < lengths.len() && rest > lengths[leg] {
                rest -= lengths[leg];
                leg += 1;
            }
            let part = rest / lengths[leg];
            let (from, to) = (corners[leg], corners[leg + 1]);
            [
                from[0] + part * (to[0] - from[0]),
                from[1] + part * (to[1] - from[1]),
            ]
        })
        .collect()
}

/// Metres from one place to another.
pub fn distance(from: [f64; 2], to: [f64; 2]) -> f64 {
    libm::hypot(to[0] - from[0], to[1] - from[1])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_goes_straight_between_its_corners() {
        let path = Path::new(&[(1.0, [0.0, 0.0]), (3.0, [4.0, -2.0]), (4.0, [4.0, 0.0])]);
        assert_eq!(path.at(0.9), None);
        assert_eq!(path.at(1.0), Some([0.0, 0.0]));
        assert_eq!(path.at(2.0), Some([2.0, -1.0]));
        assert_eq!(path.at(4.0), Some([4.0, 0.0]));
        assert_eq!(path.at(4.1), None);
        assert_eq!(path.times(), Some([1.0, 4.0]));
        assert_eq!(path.held(0.0), Some([0.0, 0.0]));
        assert_eq!(path.held(2.0), Some([2.0, -1.0]));
        assert_eq!(path.held(9.0), Some([4.0, 0.0]));
        assert_eq!(Path::default().held(0.0), None);
    }

    #[test]
    fn a_constant_speed_takes_time_by_distance() {
        let path = Path::along(&[[0.0, 0.0], [3.0, 4.0], [3.0, 0.0]], 2.0, 1.0);
        let times: Vec<f64> = path.corners().iter().map(|(time, _)| *time).collect();
        assert_eq!(times, [1.0, 3.5, 5.5]);
    }

    #[test]
    fn places_are_equally_spaced_round_the_corner() {
        let places = along(&[[0.0, 0.0], [2.0, 0.0], [2.0, 2.0]], 5);
        assert_eq!(
            places,
            [[0.0, 0.0], [1.0, 0.0], [2.0, 0.0], [2.0, 1.0], [2.0, 2.0]]
        );
    }
}
