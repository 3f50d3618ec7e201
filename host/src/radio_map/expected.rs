//! What a map promises before anybody has walked.

use super::{
    cells::Cells,
    content::{Content, posterior},
    kriging::Kriging,
    recipe::Choices,
    site::SiteSurvey,
};

/// How well places are expected to be found on a map.
#[derive(Debug, Clone, PartialEq)]
pub struct Expected {
    /// By point of the lattice: the expected error of a look of [`Expected::PACKETS`] packets without memory there, in
    /// metres: the root mean square.
    pub by_point_m: Vec<f64>,
    /// The error of a look without noise, in metres, over all points: the root mean square. A tag at rest is known no better.
    pub rest_m: f64,
    /// The errors of such looks, taken from the survey at places that were left out with their neighbours, in rising order.
    pub left_out_m: Vec<f64>,
}

impl Expected {
    /// Packets of each beacon.
    pub const PACKETS: usize = 4;
    /// Places that are left out, at the most.
    const PLACES: usize = 400;

    pub(super) fn new(
        content: &Content,
        choices: &Choices,
        survey: &SiteSurvey,
        cells: &Cells,
        kriging: &Kriging,
    ) -> Self {
        let packets = choices.packet_sigma_db.powi(2);
        Self {
            by_point_m: content.look(packets / Self::PACKETS as f64),
            rest_m: content.at_rest(),
            left_out_m: left_out(content, choices, survey, cells, kriging),
        }
    }

    /// The error that this fraction of the looks at places that were left out does not exceed, in metres.
    pub fn quantile_m(&self, fraction: f64) -> Option<f64> {
        let count = (fraction * self.left_out_m.len() as f64).ceil() as usize;
        self.left_out_m.get(count.max(1) - 1).copied()
    }

    /// The fraction of those looks that are within so many metres.
    pub fn within(&self, metres: f64) -> f64 {
        let near = self.left_out_m.partition_point(|error| *error < metres);
        near as f64 / self.left_out_m.len().max(1) as f64
    }
}

/// Looks at places, on maps without their blocks.
fn left_out(
    content: &Content,
    choices: &Choices,
    survey: &SiteSurvey,
    cells: &Cells,
    kriging: &Kriging,
) -> Vec<f64> {
    let lattice = &content.lattice;
    let blocks = cells.blocks();
    let noise = choices.packet_sigma_db.powi(2) / Expected::PACKETS as f64;
    let every = survey.survey().places.len().div_ceil(Expected::PLACES);
    let mut errors = Vec::new();
    for (number, block) in blocks.iter().enumerate() {
        let members = (0..survey.survey().places.len())
            .filter(|place| place % every == 0 && block.contains(&cells.of_place[*place]));
        let looks: Vec<_> = members
            .filter_map(|place| Some((survey.survey().places[place], look(survey, cells, place)?)))
            .collect();
        if looks.is_empty() {
            continue;
        }
        let points: Vec<_> = (0..lattice.points())
            .map(|point| {
                let (means, variance) = kriging.without(number, content.place(point));
                (means, variance + choices.sigma_db.powi(2) + noise)
            })
            .collect();
        for ([x, y], levels) in looks {
            let weights = posterior(lattice, &levels, |point| points[point].clone());
            let (mut found_x, mut found_y) = (0.0, 0.0);
            for (point, weight) in weights.into_iter().enumerate() {
                let [px, py] = content.place(point);
                found_x += weight * px;
                found_y += weight * py;
            }
            errors.push((found_x - x).hypot(found_y - y));
        }
    }
    errors.sort_by(f64::total_cmp);
    errors
}

/// The mean levels of a place and those that follow it in its cell, up to so many readings.
fn look(survey: &SiteSurvey, cells: &Cells, place: usize) -> Option<Vec<Option<f64>>> {
    let samples = &survey.survey().samples;
    let cell = cells.of_place[place];
    let together = (place..samples.len()).take_while(|next| cells.of_place[*next] == cell);
    let together: Vec<usize> = together.take(Expected::PACKETS).collect();
    let level = |beacon: usize| {
        let readings = together.iter().flat_map(|place| &samples[*place][beacon]);
        let readings: Vec<f64> = readings.take(Expected::PACKETS).copied().collect();
        (!readings.is_empty()).then(|| readings.iter().sum::<f64>() / readings.len() as f64)
    };
    let levels: Vec<Option<f64>> = (0..survey.beacons().len()).map(level).collect();
    levels.iter().any(Option::is_some).then_some(levels)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn of_a_few_looks_a_quantile_is_one_that_so_many_do_not_exceed() {
        let of = |left_out_m: &[f64]| Expected {
            by_point_m: Vec::new(),
            rest_m: 0.0,
            left_out_m: left_out_m.to_vec(),
        };
        assert_eq!(of(&[]).quantile_m(0.5), None);
        for (fraction, expected) in [(0.0, 1.0), (0.5, 1.0), (0.9, 3.0), (1.0, 3.0)] {
            assert_eq!(of(&[1.0, 3.0]).quantile_m(fraction), Some(expected));
        }
    }
}
