//! The one way from a survey to a map.

use anyhow::Result;
use foxhunt::fingerprint::Lattice;

use super::{
    cells::{Cells, nearest_neighbour, packet_variance},
    content::Content,
    encode,
    errors::Errors,
    expected::Expected,
    kriging::Kriging,
    recipe::{Choices, Recipe},
    site::SiteSurvey,
};

/// A map, and what is known of it.
#[derive(Debug, Clone)]
pub struct Made {
    /// The bytes that go to flash, see [`foxhunt::fingerprint::RadioMap`].
    pub bytes: Vec<u8>,
    /// The lattice of its points.
    pub lattice: Lattice,
    /// How it was made.
    pub choices: Choices,
    /// How well places are expected to be found on it.
    pub expected: Expected,
}

/// Most cells: the work grows with the cube of their number.
const MOST_CELLS: usize = 300;
/// Most points that a lattice gets by default.
const MOST_POINTS: usize = 4096;
/// The interpolation between points may add so much to the variance of the map's error.
const INTERPOLATION: f64 = 0.05;

impl SiteSurvey {
    /// Makes a map. `progress` is told the fraction of the work that is done.
    ///
    /// # Errors
    /// When an option is out of range, there are no beacons or too many, or no lattice holds the places.
    pub fn map(&self, recipe: &Recipe, progress: &mut dyn FnMut(f64)) -> Result<Made> {
        recipe.check()?;
        self.check()?;
        let sources: Vec<_> = (self.beacons().iter())
            .map(|beacon| recipe.sources.get(beacon).copied())
            .collect();
        let candidates = self.cell_sizes(recipe);
        let steps = candidates.len() as f64 + 0.5;
        let mut best: Option<(Option<f64>, Cells, Kriging, Errors)> = None;
        for (number, side) in candidates.into_iter().enumerate() {
            let cells = Cells::new(self.survey(), side);
            let blocks = cells.blocks();
            let mut tried = 0;
            let fit = match recipe.shape {
                Some(shape) => Kriging::with(&cells, &sources, shape, &blocks),
                None => Kriging::fit(&cells, &sources, &blocks, || {
                    tried += 1;
                    let part = f64::from(tried) / Kriging::SHAPES as f64;
                    progress((number as f64 + part) / steps);
                }),
            };
            let Some(fit) = fit else { continue };
            let errors = Errors::new(self.survey(), &cells, &blocks, &fit);
            // As they predict the readings, not the means of their own cells.
            if best
                .as_ref()
                .is_none_or(|(.., best)| errors.squares < best.squares)
            {
                best = Some((side, cells, fit, errors));
            }
        }
        let Some((cell_m, cells, kriging, errors)) = best else {
            anyhow::bail!("the survey is empty, or its places are impossible");
        };
        let choices = choices(recipe, self, (cell_m, &cells), &kriging, &errors);
        let lattice = match recipe.lattice {
            Some(lattice) => lattice,
            None => match recipe.spacing_m {
                Some(spacing) => self.lattice(spacing)?,
                None => self.best_lattice(&cells, &kriging, choices.sigma_db)?,
            },
        };
        let content = Content::new(self, &lattice, (&cells, &kriging), &choices, recipe);
        let expected = Expected::new(&content, &choices, self, &cells, &kriging);
        let bytes = encode::bytes(self, &content, &choices, expected.rest_m, recipe);
        progress(1.0);
        Ok(Made {
            bytes,
            lattice,
            choices,
            expected,
        })
    }

    /// Sides of cells to choose from.
    fn cell_sizes(&self, recipe: &Recipe) -> Vec<Option<f64>> {
        if let Some(side) = recipe.cell_m {
            return vec![(side > 0.0).then_some(side)];
        }
        let places = &self.survey().places;
        if places.len() <= MOST_CELLS && self.readings_at_a_place() > 3.0 {
            return vec![None];
        }
        let sides = [0.25, 0.5, 1.0, 2.0, 4.0, 8.0, 16.0, 32.0, 64.0, 128.0];
        let few = |side: &f64| {
            let keys = places
                .iter()
                .map(|place| place.map(|c| (c / side).floor() as i64));
            keys.collect::<std::collections::BTreeSet<_>>().len() <= MOST_CELLS
        };
        let fits = sides.into_iter().filter(few).take(3);
        fits.map(Some).collect()
    }

    /// The mean number of readings of a beacon at a place where it was heard.
    fn readings_at_a_place(&self) -> f64 {
        let counts = self.survey().samples.iter().flatten();
        let (count, sum) = counts
            .filter(|readings| !readings.is_empty())
            .fold((0.0, 0.0), |(n, sum), of| (n + 1.0, sum + of.len() as f64));
        sum / f64::max(count, 1.0)
    }

    /// The widest lattice whose interpolation adds little to the error.
    fn best_lattice(&self, cells: &Cells, kriging: &Kriging, sigma_db: f64) -> Result<Lattice> {
        const SPACINGS: [f64; 8] = [8.0, 5.0, 3.0, 2.0, 1.0, 0.5, 0.25, 0.125];
        let mut chosen = None;
        for spacing in SPACINGS {
            let Ok(lattice) = self.lattice(spacing) else {
                continue;
            };
            if lattice.points() > MOST_POINTS {
                break;
            }
            chosen = Some(lattice);
            if lattice.points() > 1
                && interpolation(&lattice, cells, kriging) < INTERPOLATION * sigma_db * sigma_db
            {
                break;
            }
        }
        match chosen {
            Some(lattice) => Ok(lattice),
            // So large a site has wide cells.
            None => self.lattice(nearest_neighbour(&cells.places).unwrap_or(1.0)),
        }
    }
}

/// Mean square of what interpolation between the points of a lattice adds, at the places of the survey, in dB^2.
fn interpolation(lattice: &Lattice, cells: &Cells, kriging: &Kriging) -> f64 {
    let [x0, y0] = lattice.origin().map(f64::from);
    let spacing = f64::from(lattice.spacing());
    let (mut count, mut squares) = (0.0, 0.0);
    for place in &cells.places {
        let steps = [(place[0] - x0) / spacing, (place[1] - y0) / spacing];
        let [s, t] = steps.map(|steps| steps - steps.floor());
        let corner = |i: f64, j: f64| {
            let at = [steps[0].floor() + i, steps[1].floor() + j];
            kriging.at([x0 + spacing * at[0], y0 + spacing * at[1]]).0
        };
        let corners = [(0.0, 0.0), (1.0, 0.0), (0.0, 1.0), (1.0, 1.0)];
        let mut error = kriging.at(*place).0;
        for (i, j) in corners {
            let weight = (if i > 0.0 { s } else { 1.0 - s }) * (if j > 0.0 { t } else { 1.0 - t });
            if weight > 0.0 {
                for (error, mean) in error.iter_mut().zip(corner(i, j)) {
                    *error -= weight * mean;
                }
            }
        }
        count += error.len() as f64;
        squares += error.iter().map(|e| e * e).sum::<f64>();
    }
    squares / f64::max(count, 1.0)
}

fn choices(
    recipe: &Recipe,
    survey: &SiteSurvey,
    (cell_m, cells): (Option<f64>, &Cells),
    kriging: &Kriging,
    errors: &Errors,
) -> Choices {
    let packets = match recipe.packet_sigma_db {
        Some(sigma) => sigma * sigma,
        None => packet_variance(survey.survey(), &cells.of_place),
    };
    let shape = kriging.shape();
    Choices {
        cell_m,
        cells: cells.places.len(),
        shape,
        field_sigma_db: kriging.variance().sqrt(),
        sigma_db: recipe.sigma_db.unwrap_or_else(|| errors.sigma_db(packets)),
        length_m: recipe
            .length_m
            .unwrap_or_else(|| errors.length_m(packets, cells.neighbour_m())),
        packet_sigma_db: packets.sqrt(),
        // There nine tenths of the variance are left.
        reach_m: 1.15 * shape.length_m,
        left_out_db: errors.left_out_db(),
    }
}
