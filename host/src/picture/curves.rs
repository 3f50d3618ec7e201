//! Curves over time, to compare methods.

use anyhow::Result;
use plotters::{
    coord::{Shift, combinators::IntoLogRange},
    prelude::*,
};

use super::{GRID, font, width};

/// Colours that stay apart for the colour-blind too (Okabe and Ito).
const COLOURS: [RGBColor; 6] = [
    RGBColor(0, 0, 0),
    RGBColor(213, 94, 0),
    RGBColor(0, 114, 178),
    RGBColor(0, 158, 115),
    RGBColor(204, 121, 167),
    RGBColor(230, 159, 0),
];

const WIDTH: u32 = 960;
const HEIGHT: u32 = 620;

/// One method.
#[derive(Debug, Clone)]
pub struct Curve {
    /// Its name in the legend.
    pub name: String,
    /// Its points, by rising x.
    pub points: Vec<(f64, f64)>,
}

/// Several curves over the same axis, the vertical one logarithmic.
#[derive(Debug, Clone)]
pub struct Curves {
    /// What the picture shows.
    pub title: String,
    /// Name and unit of the horizontal axis.
    pub horizontal: String,
    /// Name and unit of the vertical axis.
    pub vertical: String,
    /// The curves, in the order of the legend.
    pub curves: Vec<Curve>,
}

impl Curves {
    /// The picture.
    ///
    /// # Errors
    /// If it cannot be drawn.
    pub fn svg(&self) -> Result<String> {
        super::use_font()?;
        let points = || self.curves.iter().flat_map(|curve| &curve.points);
        let bounds = |values: &mut dyn Iterator<Item = f64>| {
            values.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), v| {
                (low.min(v), high.max(v))
            })
        };
        let (left, right) = bounds(&mut points().map(|p| p.0));
        let (low, high) = bounds(&mut points().map(|p| p.1));

        let mut svg = String::new();
        {
            let area = SVGBackend::with_string(&mut svg, (WIDTH, HEIGHT)).into_drawing_area();
            area.fill(&WHITE)?;
            let mut chart = ChartBuilder::on(&area)
                .caption(&self.title, font(20))
                .margin(18)
                .x_label_area_size(48)
                .y_label_area_size(64)
                .build_cartesian_2d(left..right, (low / 1.2..high * 1.2).log_scale())?;
            chart
                .configure_mesh()
                .bold_line_style(GRID)
                .light_line_style(GRID.mix(0.4))
                .axis_style(GRID.stroke_width(1))
                .label_style(font(14))
                .axis_desc_style(font(15))
                .x_desc(&self.horizontal)
                .y_desc(&self.vertical)
                .x_label_formatter(&|v| format!("{v}"))
                .y_label_formatter(&|v| format!("{v}"))
                .draw()?;
            for (curve, colour) in self.coloured() {
                let points = curve.points.iter().copied();
                chart.draw_series(LineSeries::new(points, colour.stroke_width(2)))?;
            }
            self.legend(&area)?;
            area.present()?;
        }
        Ok(svg)
    }

    fn coloured(&self) -> impl Iterator<Item = (&Curve, &RGBColor)> {
        self.curves.iter().zip(COLOURS.iter().cycle())
    }

    /// In the upper right corner: errors fall.
    fn legend(&self, area: &DrawingArea<SVGBackend, Shift>) -> Result<()> {
        const MARK: i32 = 24;
        const LINE: i32 = 24;
        let style = font(15);
        let names = self
            .curves
            .iter()
            .map(|curve| width(area, &curve.name, &style));
        let longest = names
            .collect::<Result<Vec<_>>>()?
            .into_iter()
            .max()
            .unwrap_or(0);
        let (left, top) = (WIDTH as i32 - longest - MARK - 58, 60);
        let bottom = top + LINE * self.curves.len() as i32 + 8;
        let corners = [(left - 12, top - 8), (WIDTH as i32 - 30, bottom - 8)];
        area.draw(&Rectangle::new(corners, WHITE.mix(0.85).filled()))?;
        area.draw(&Rectangle::new(corners, GRID))?;
        for ((curve, colour), row) in self.coloured().zip(0..) {
            let y = top + LINE * row + 10;
            area.draw(&PathElement::new(
                [(left, y), (left + MARK, y)],
                colour.stroke_width(3),
            ))?;
            area.draw(&Text::new(
                curve.name.as_str(),
                (left + MARK + 10, y - 7),
                style.clone(),
            ))?;
        }
        Ok(())
    }
}
