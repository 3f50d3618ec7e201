//! The way of a tag.

/// Where a tag was, at some times; between these it went straight on.
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
    }
}
