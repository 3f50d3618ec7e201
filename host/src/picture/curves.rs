//! Curves over time, to compare methods.

use anyhow::Result;
use plotters::{coord::combinators::IntoLogRange, prelude::*};

use super::{GRID, INK};

/// Colours that stay apart for the colour-blind too (Okabe and Ito).
const COLOURS: [RGBColor; 6] = [
    RGBColor(0, 0, 0),
    RGBColor(213, 94, 0),
    RGBColor(0, 114, 178),
    RGBColor(0, 158, 115),
    RGBColor(204, 121, 167),
    RGBColor(230, 159, 0),
];

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

        let font = |size: u32| ("sans-serif", size).into_font().color(&INK);
        let mut svg = String::new();
        {
            let area = SVGBackend::with_string(&mut svg, (960, 620)).into_drawing_area();
            area.fill(&WHITE)?;
            let mut chart = ChartBuilder::on(&area)
                .caption(&self.title, font(22))
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
                .y_label_formatter(&|v| format!("{v}"))
                .draw()?;
            for (curve, colour) in self.curves.iter().zip(COLOURS.iter().cycle()) {
                chart
                    .draw_series(LineSeries::new(
                        curve.points.iter().copied(),
                        colour.stroke_width(2),
                    ))?
                    .label(curve.name.as_str())
                    .legend(|(x, y)| {
                        PathElement::new([(x, y), (x + 22, y)], colour.stroke_width(3))
                    });
            }
            chart
                .configure_series_labels()
                .position(SeriesLabelPosition::UpperRight)
                .background_style(WHITE.mix(0.85))
                .border_style(GRID)
                .legend_area_size(30)
                .margin(10)
                .label_font(font(15))
                .draw()?;
            area.present()?;
        }
        Ok(svg)
    }
}
