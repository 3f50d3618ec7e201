//! Numbers over a floor, as colours.

use anyhow::Result;
use foxhunt::fingerprint::Lattice;
use plotters::prelude::*;

use super::{GRID, INK, font};

const WIDTH: u32 = 760;
const HEIGHT: u32 = 700;
const HEADER: u32 = 56;
const MARGIN: u32 = 16;
const LABELS: u32 = 50;
const LEGEND: u32 = 60;

/// Numbers at the points of a lattice.
#[derive(Debug, Clone, Default)]
pub struct Field {
    /// What it is, above the panel.
    pub name: String,
    /// Side of a cell in metres.
    side: f64,
    /// The middles of cells in metres, and their numbers.
    cells: Vec<([f64; 2], f64)>,
}

impl Field {
    /// A number for each point of a lattice.
    pub fn of_points(name: &str, lattice: &Lattice, values: &[f64]) -> Self {
        let each = values.iter().enumerate();
        let cell = |(point, value): (usize, &f64)| (lattice.position(point).map(f64::from), *value);
        Self {
            name: name.to_owned(),
            side: lattice.spacing().into(),
            cells: each.map(cell).collect(),
        }
    }

    /// Means of numbers at places, in cells of the side of those of another field.
    pub fn of_places(name: &str, like: &Self, places: &[([f64; 2], f64)]) -> Self {
        let cell = |[middle, _]: [[f64; 2]; 2]| {
            let near = places.iter().filter(|(place, _)| {
                let half = 0.5 * like.side;
                (place[0] - middle[0]).abs() <= half && (place[1] - middle[1]).abs() <= half
            });
            let (count, sum) = near.fold((0.0, 0.0), |(n, sum), (_, value)| (n + 1.0, sum + value));
            (count > 0.0).then(|| (middle, sum / count))
        };
        let cells = like
            .cells
            .iter()
            .filter_map(|(middle, _)| cell([*middle; 2]));
        Self {
            name: name.to_owned(),
            side: like.side,
            cells: cells.collect(),
        }
    }
}

/// Fields side by side, in the same colours.
#[derive(Debug, Clone, Default)]
pub struct Heat {
    /// What the picture shows.
    pub title: String,
    /// The fields.
    pub panels: Vec<Field>,
    /// Places that are marked in all of them: those of a survey.
    pub places: Vec<[f64; 2]>,
}

impl Heat {
    /// The picture.
    ///
    /// # Errors
    /// If it cannot be drawn.
    pub fn svg(&self) -> Result<String> {
        super::use_font()?;
        let count = self.panels.len().max(1) as u32;
        let most = self.most();
        let mut svg = String::new();
        {
            let size = (WIDTH * count + LEGEND, HEIGHT);
            let area = SVGBackend::with_string(&mut svg, size).into_drawing_area();
            area.fill(&WHITE)?;
            let (header, rest) = area.split_vertically(HEADER);
            header.draw(&Text::new(
                self.title.as_str(),
                (LABELS as i32, 18),
                font(22),
            ))?;
            let (panels, legend) = rest.split_horizontally(WIDTH * count);
            for (field, area) in self
                .panels
                .iter()
                .zip(panels.split_evenly((1, count as usize)))
            {
                let [x, y] = self.ranges();
                let mut chart = ChartBuilder::on(&area)
                    .margin(MARGIN)
                    .caption(field.name.as_str(), font(18))
                    .x_label_area_size(LABELS)
                    .y_label_area_size(LABELS)
                    .build_cartesian_2d(x, y)?;
                chart
                    .configure_mesh()
                    .light_line_style(WHITE)
                    .bold_line_style(GRID)
                    .axis_style(INK)
                    .label_style(font(14))
                    .draw()?;
                let half = 0.5 * field.side;
                chart.draw_series(field.cells.iter().map(|([x, y], value)| {
                    let corners = [(x - half, y - half), (x + half, y + half)];
                    Rectangle::new(corners, colour(value / most).filled())
                }))?;
                let marks = self.places.iter();
                chart.draw_series(marks.map(|[x, y]| Circle::new((*x, *y), 1, INK.filled())))?;
            }
            const STEPS: i32 = 40;
            let height = (HEIGHT - HEADER - 2 * LABELS) as i32 / STEPS;
            for step in 0..STEPS {
                let fraction = 1.0 - f64::from(step) / f64::from(STEPS);
                let top = MARGIN as i32 + step * height;
                let corners = [(0, top), (16, top + height)];
                legend.draw(&Rectangle::new(corners, colour(fraction).filled()))?;
                if step % 8 == 0 {
                    let text = format!("{:.1}", fraction * most);
                    legend.draw(&Text::new(text, (20, top), font(14)))?;
                }
            }
            area.present()?;
        }
        Ok(svg)
    }

    /// The number of the last colour: few are above it.
    fn most(&self) -> f64 {
        let cells = self.panels.iter().flat_map(|field| &field.cells);
        let mut values: Vec<f64> = cells.map(|(_, value)| *value).collect();
        values.sort_by(f64::total_cmp);
        let last = values.len().saturating_sub(1);
        values
            .get(last * 98 / 100)
            .copied()
            .unwrap_or(1.0)
            .max(1e-3)
    }

    fn ranges(&self) -> [std::ops::Range<f64>; 2] {
        let cells = self.panels.iter().flat_map(|field| {
            let half = 0.5 * field.side;
            let corners = field.cells.iter();
            corners.flat_map(move |([x, y], _)| [[x - half, y - half], [x + half, y + half]])
        });
        let corners: Vec<[f64; 2]> = cells.collect();
        [0, 1].map(|axis| {
            let along = corners.iter().map(|corner| corner[axis]);
            let low = along.clone().fold(f64::INFINITY, f64::min);
            low..along.fold(low + 1.0, f64::max)
        })
    }
}

/// From white through orange to dark red.
fn colour(fraction: f64) -> RGBColor {
    const STOPS: [[f64; 3]; 4] = [
        [255.0, 250.0, 235.0],
        [253.0, 190.0, 110.0],
        [214.0, 60.0, 40.0],
        [90.0, 0.0, 30.0],
    ];
    let at = fraction.clamp(0.0, 1.0) * (STOPS.len() - 1) as f64;
    let first = (at as usize).min(STOPS.len() - 2);
    let part = at - first as f64;
    let [red, green, blue] =
        [0, 1, 2].map(|c| ((1.0 - part) * STOPS[first][c] + part * STOPS[first + 1][c]) as u8);
    RGBColor(red, green, blue)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_field_is_drawn_beside_what_came_of_it() {
        let lattice = Lattice::new([0.0, 0.0], 1.0, 3, 2).unwrap();
        let promised = Field::of_points("promised", &lattice, &[1.0, 2.0, 1.0, 0.5, 3.0, 1.0]);
        let found = Field::of_places("found", &promised, &[([0.1, 0.2], 2.0), ([0.2, -0.1], 4.0)]);
        assert_eq!(found.cells, [([0.0, 0.0], 3.0)]);
        let heat = Heat {
            title: "both".into(),
            panels: vec![promised, found],
            places: vec![[0.5, 0.5]],
        };
        let svg = heat.svg().unwrap();
        assert!(svg.contains("promised") && svg.contains("found"));
    }
}
