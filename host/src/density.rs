//! How dense particles are: the smallest regions that hold a given probability.

use contour::ContourBuilder;
use foxhunt::{
    aoa::Cloud,
    estimate::{self, Ellipse, quantile},
};

/// The smallest region that holds a given probability.
#[derive(Debug, Clone, PartialEq)]
pub struct Region {
    /// What it holds, 0 to 1.
    pub probability: f64,
    /// Its parts, the larger first: each an outline, counter-clockwise, and its holes, clockwise. Rings of places in the
    /// unit of the particles; the last place of a ring is its first.
    pub polygons: Vec<Vec<Ring>>,
}

/// A closed line.
pub type Ring = Vec<[f64; 2]>;

/// Fewest and most cells along an axis of the grid.
const CELLS: [f64; 2] = [32.0, 128.0];
/// Cells for a sigma of the kernel.
const FINENESS: f64 = 3.0;
/// Where the kernel ends, in its sigmas.
const KERNEL: f64 = 3.5;

/// The regions of a cloud that hold these probabilities, by a kernel density.
///
/// The kernel is normal, along the principal axes of the cloud, and as wide as Scott's rule says (*Multivariate Density
/// Estimation*, 1992): the sigma along each axis, or what the quartiles say it is where that is less, by the number
/// of particles to the power of -1/6.
pub fn regions(cloud: &Cloud<'_>, probabilities: &[f64]) -> Vec<Region> {
    let Some(grid) = Grid::new(cloud) else {
        return Vec::new();
    };
    probabilities
        .iter()
        .filter_map(|&probability| grid.region(probability))
        .collect()
}

/// The density at the nodes of a grid along the principal axes.
struct Grid {
    centre: [f64; 2],
    orientation: f64,
    axes: [Axis; 2],
    density: Vec<f64>,
}

/// One side of the grid.
struct Axis {
    low: f64,
    step: f64,
    cells: usize,
    /// The sigma of the kernel.
    width: f64,
}

impl Grid {
    fn new(cloud: &Cloud<'_>) -> Option<Self> {
        let columns = [cloud.east, cloud.north];
        let centre = estimate::mean(&columns, cloud.weights);
        let covariance = estimate::covariance(&columns, cloud.weights);
        let ellipse = Ellipse::of_sigmas(centre, covariance.into(), 1.0);
        let (centre, orientation) = (centre.map(f64::from), f64::from(ellipse.orientation));
        let (sin, cos) = orientation.sin_cos();
        let turned: [Vec<f32>; 2] = [[cos, sin], [-sin, cos]].map(|[x, y]| {
            (cloud.east.iter().zip(cloud.north))
                .map(|(east, north)| {
                    (x * (f64::from(*east) - centre[0]) + y * (f64::from(*north) - centre[1]))
                        as f32
                })
                .collect()
        });
        let squares: f64 = cloud.weights.iter().map(|w| f64::from(w * w)).sum();
        let [major, minor] = [ellipse.semi_major, ellipse.semi_minor];
        let axes = [
            Axis::new(&turned[0], cloud.weights, major, 1.0 / squares)?,
            Axis::new(&turned[1], cloud.weights, minor, 1.0 / squares)?,
        ];
        let mut density = vec![0.0; axes[0].cells * axes[1].cells];
        for ((u, v), weight) in turned[0].iter().zip(&turned[1]).zip(cloud.weights) {
            if *weight > 0.0 {
                let (along, across) = (axes[0].kernel(*u), axes[1].kernel(*v));
                for (row, across) in density.chunks_exact_mut(axes[0].cells).zip(&across) {
                    let factor = f64::from(*weight) * across;
                    for (cell, along) in row.iter_mut().zip(&along) {
                        *cell += factor * along;
                    }
                }
            }
        }
        Some(Self {
            centre,
            orientation,
            axes,
            density,
        })
    }

    /// The density above which this much of the probability lies.
    fn level(&self, probability: f64) -> f64 {
        let mut sorted = self.density.clone();
        sorted.sort_by(|a, b| b.total_cmp(a));
        let enough = probability * sorted.iter().sum::<f64>();
        let mut sum = 0.0;
        let level = sorted.iter().find(|density| {
            sum += **density;
            sum >= enough
        });
        level.copied().unwrap_or(0.0)
    }

    fn region(&self, probability: f64) -> Option<Region> {
        let [u, v] = &self.axes;
        let contours = ContourBuilder::new(u.cells, v.cells, true)
            .x_origin(u.low)
            .y_origin(v.low)
            .x_step(u.step)
            .y_step(v.step)
            .contours(&self.density, &[self.level(probability)])
            .ok()?;
        let mut polygons: Vec<Vec<Ring>> = (contours.iter())
            .flat_map(|contour| &contour.geometry().0)
            .map(|polygon| {
                let rings = std::iter::once(polygon.exterior()).chain(polygon.interiors());
                rings
                    .enumerate()
                    .map(|(index, ring)| {
                        let places = ring.0.iter().map(|place| self.place([place.x, place.y]));
                        wound(places.collect(), index == 0)
                    })
                    .collect()
            })
            .collect();
        polygons.sort_by(|a, b| area(&b[0]).total_cmp(&area(&a[0])));
        Some(Region {
            probability,
            polygons,
        })
    }

    /// Back from the principal axes.
    fn place(&self, [u, v]: [f64; 2]) -> [f64; 2] {
        let (sin, cos) = self.orientation.sin_cos();
        [
            self.centre[0] + u * cos - v * sin,
            self.centre[1] + u * sin + v * cos,
        ]
    }
}

impl Axis {
    /// Of particles worth so many of the same weight.
    fn new(column: &[f32], weights: &[f32], sigma: f32, worth: f64) -> Option<Self> {
        /// From the quartiles of a normal distribution to its sigma.
        const QUARTILES: f64 = 1.349;
        let sigma = f64::from(sigma);
        let quartile = |fraction| f64::from(quantile(column, weights, fraction));
        let by_quartiles = (quartile(0.75) - quartile(0.25)) / QUARTILES;
        let scale = if by_quartiles > 0.0 {
            by_quartiles.min(sigma)
        } else {
            sigma
        };
        let mut inside = (column.iter().zip(weights))
            .filter(|(_, weight)| **weight > 0.0)
            .map(|(x, _)| f64::from(*x));
        let first = inside.next()?;
        let (low, high) = inside.fold((first, first), |(low, high), x| (low.min(x), high.max(x)));
        // A millimetre at the least: particles may coincide.
        let width = (scale * worth.powf(-1.0 / 6.0)).max(1e-3);
        let (low, high) = (low - KERNEL * width, high + KERNEL * width);
        let cells = (FINENESS * (high - low) / width).clamp(CELLS[0], CELLS[1]);
        let step = (high - low) / cells.floor();
        let valid = step.is_finite() && step > 0.0;
        valid.then_some(Self {
            low,
            step,
            cells: cells as usize,
            // No narrower than what the grid resolves.
            width: width.max(step),
        })
    }

    /// A kernel about `x`, at every node.
    fn kernel(&self, x: f32) -> Vec<f64> {
        (0..self.cells)
            .map(|cell| {
                let node = self.low + (cell as f64 + 0.5) * self.step;
                let distance = (node - f64::from(x)) / self.width;
                (-0.5 * distance * distance).exp()
            })
            .collect()
    }
}

/// Twice the area within a ring; negative if it is clockwise.
fn area(ring: &Ring) -> f64 {
    let pairs = ring.windows(2);
    let Some([x, y]) = ring.first() else {
        return 0.0;
    };
    pairs
        .map(|pair| {
            let [a, b] = [0, 1].map(|k| [pair[k][0] - x, pair[k][1] - y]);
            a[0] * b[1] - a[1] * b[0]
        })
        .sum()
}

/// The ring in the sense that is asked for.
fn wound(mut ring: Ring, counter_clockwise: bool) -> Ring {
    if (area(&ring) > 0.0) != counter_clockwise {
        ring.reverse();
    }
    ring
}

#[cfg(test)]
mod tests {
    use super::*;
    use foxhunt_simulation::random::{generator, normal};

    fn cloud(count: usize, place: impl Fn(f64, f64, usize) -> [f64; 2]) -> [Vec<f32>; 2] {
        let mut rng = generator(3, 0);
        let places: Vec<[f64; 2]> = (0..count)
            .map(|k| {
                let (u, v) = (normal(&mut rng), normal(&mut rng));
                place(u, v, k)
            })
            .collect();
        [0, 1].map(|d| places.iter().map(|place| place[d] as f32).collect())
    }

    fn regions_of([east, north]: &[Vec<f32>; 2], probabilities: &[f64]) -> Vec<Region> {
        let weights = vec![1.0 / east.len() as f32; east.len()];
        let cloud = Cloud {
            east,
            north,
            weights: &weights,
        };
        regions(&cloud, probabilities)
    }

    fn holds(region: &Region, [x, y]: [f64; 2]) -> bool {
        let crossings = region.polygons.iter().flatten().flat_map(|r| r.windows(2));
        crossings
            .filter(|pair| (pair[0][1] > y) != (pair[1][1] > y))
            .filter(|pair| {
                let fraction = (y - pair[0][1]) / (pair[1][1] - pair[0][1]);
                x < pair[0][0] + fraction * (pair[1][0] - pair[0][0])
            })
            .count()
            % 2
            == 1
    }

    /// Of 2000 points a region of probability p holds p, but for what the kernel widens it.
    #[test]
    fn regions_hold_their_probabilities_and_lie_in_each_other() {
        let places = cloud(2000, |u, v, _| {
            [100.0 + 30.0 * u, -50.0 + 20.0 * u + 1.5 * v]
        });
        let regions = regions_of(&places, &[0.95, 0.8, 0.5]);
        let mut last = f64::INFINITY;
        for region in &regions {
            let inside = (0..2000)
                .filter(|&k| holds(region, [places[0][k], places[1][k]].map(f64::from)))
                .count() as f64
                / 2000.0;
            assert!(
                inside > region.probability - 0.01 && inside < region.probability + 0.08,
                "{inside} for {}",
                region.probability
            );
            let own: f64 = (region.polygons.iter().flatten())
                .map(|ring| area(ring) / 2.0)
                .sum();
            // That of the normal distribution itself, -2 pi ln(1 - p) 45, widened by the kernel.
            let exact = -std::f64::consts::TAU * (1.0 - region.probability).ln() * 45.0;
            assert!(
                own > 0.9 * exact && own < 1.3 * exact,
                "{own} beside {exact}"
            );
            assert!(own < last);
            last = own;
        }
    }

    #[test]
    fn two_modes_are_two_polygons_and_a_ring_has_a_hole() {
        let modes = cloud(600, |u, v, k| [u + if k % 3 == 0 { 60.0 } else { 0.0 }, v]);
        let regions = regions_of(&modes, &[0.9]);
        assert_eq!(regions[0].polygons.len(), 2);
        assert!(area(&regions[0].polygons[0][0]) > area(&regions[0].polygons[1][0]));

        let ring = cloud(3000, |u, v, _| {
            let length = u.hypot(v);
            [100.0 * u / length + 0.3 * u, 100.0 * v / length + 0.3 * v]
        });
        let region = &regions_of(&ring, &[0.8])[0];
        assert!(region.polygons.iter().any(|polygon| polygon.len() == 2));
        assert!(!holds(region, [0.0, 0.0]));
        for polygon in &region.polygons {
            for (index, ring) in polygon.iter().enumerate() {
                assert_eq!(ring.first(), ring.last());
                assert_eq!(area(ring) > 0.0, index == 0);
            }
        }
    }

    #[test]
    fn particles_that_coincide_have_a_region() {
        let region = &regions_of(&[vec![7.0; 20], vec![-2.0; 20]], &[0.95])[0];
        assert!(holds(region, [7.0, -2.0]) && !holds(region, [7.1, -2.0]));
    }
}
