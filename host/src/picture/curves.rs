//! Curves, to compare methods.

use std::ops::Range;

use anyhow::Result;
use plotters::{
    coord::{
        Shift,
        combinators::{BindKeyPoints, IntoLogRange},
        ranged1d::{AsRangedCoord, ValueFormatter},
    },
    prelude::*,
};

use super::{GRID, font, width};

/// Colours that stay apart for the colour-blind too (Okabe and Ito), and three more.
pub(super) const COLOURS: [RGBColor; 10] = [
    RGBColor(0, 0, 0),
    RGBColor(213, 94, 0),
    RGBColor(0, 114, 178),
    RGBColor(0, 158, 115),
    RGBColor(204, 121, 167),
    RGBColor(230, 159, 0),
    RGBColor(86, 180, 233),
    RGBColor(130, 130, 130),
    RGBColor(110, 40, 160),
    RGBColor(130, 80, 30),
];

const WIDTH: u32 = 960;
const HEIGHT: u32 = 620;
const MARGIN: i32 = 18;
/// Length of a curve's mark in the legend, and height of a line of it.
const MARK: i32 = 24;
const LINE: i32 = 24;

/// What is drawn through the points of a curve.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Style {
    /// A line.
    #[default]
    Line,
    /// A dot at each.
    Dots,
    /// A dot at each and a thin line.
    DotsAndLine,
}

/// One method.
#[derive(Debug, Clone, Default)]
pub struct Curve {
    /// Its name in the legend; without one it takes a colour and no more.
    pub name: String,
    /// Its points, by rising x.
    pub points: Vec<(f64, f64)>,
    /// Standard deviation of each point, drawn as a bar either way; none if empty.
    pub errors: Vec<f64>,
    /// How it is drawn.
    pub style: Style,
}

/// An axis.
#[derive(Debug, Clone, Default)]
pub struct Axis {
    /// Name and unit.
    pub name: String,
    /// Whether equal ratios are equally long.
    pub logarithmic: bool,
}

impl Axis {
    /// Equal differences are equally long.
    pub fn linear(name: impl Into<String>) -> Self {
        Self {
            name: name.into(),
            logarithmic: false,
        }
    }

    /// Equal ratios are equally long.
    pub fn logarithmic(name: impl Into<String>) -> Self {
        Self {
            name: name.into(),
            logarithmic: true,
        }
    }

    /// The range of `values`, a little wider.
    fn range(&self, values: impl Iterator<Item = f64>, margin: f64) -> Range<f64> {
        let finite = values.filter(|v| v.is_finite() && (!self.logarithmic || *v > 0.0));
        let (low, high) = finite.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), v| {
            (low.min(v), high.max(v))
        });
        if low > high {
            return 1.0..2.0;
        }
        if self.logarithmic {
            let factor = (high / low).powf(margin).max(1.05);
            return low / factor..high * factor;
        }
        let extra = (margin * (high - low)).max(1e-9 * high.abs().max(1.0));
        low - extra..high + extra
    }
}

/// Several curves over the same axes.
#[derive(Debug, Clone, Default)]
pub struct Curves {
    /// What the picture shows.
    pub title: String,
    /// The horizontal axis.
    pub horizontal: Axis,
    /// The vertical axis.
    pub vertical: Axis,
    /// The curves, in the order of the legend.
    pub curves: Vec<Curve>,
}

impl Curves {
    /// The picture.
    ///
    /// # Errors
    /// If it cannot be drawn.
    pub fn svg(&self) -> Result<String> {
        Self::grid(std::slice::from_ref(self), 1)
    }

    /// Several pictures in one, `columns` of them in a row.
    ///
    /// # Errors
    /// If they cannot be drawn.
    pub fn grid(pictures: &[Self], columns: usize) -> Result<String> {
        super::use_font()?;
        let mut svg = String::new();
        {
            let columns = columns.max(1);
            let rows = pictures.len().div_ceil(columns);
            let across = if columns == 1 { WIDTH } else { 5 * WIDTH / 6 };
            let size = (across * columns as u32, HEIGHT * rows as u32);
            let area = SVGBackend::with_string(&mut svg, size).into_drawing_area();
            area.fill(&WHITE)?;
            for (picture, area) in pictures.iter().zip(area.split_evenly((rows, columns))) {
                picture.draw(&area)?;
            }
            area.present()?;
        }
        Ok(svg)
    }

    fn draw(&self, area: &DrawingArea<SVGBackend, Shift>) -> Result<()> {
        let (_, height) = area.dim_in_pixel();
        let legend = self.legend(area)?;
        let below = LINE * legend.last().map_or(0, |(_, row, _)| row + 1) + 12;
        let (chart, footer) = area.split_vertically(height - below as u32);
        for ((curve, colour), (x, row, _)) in self.coloured().zip(legend) {
            if curve.name.is_empty() {
                continue;
            }
            let y = LINE * row + 12;
            let mark = |style| PathElement::new([(x, y), (x + MARK, y)], style);
            if curve.style != Style::Dots {
                footer.draw(&mark(colour.stroke_width(3)))?;
            }
            if curve.style != Style::Line {
                footer.draw(&Circle::new((x + MARK / 2, y), 4, colour.filled()))?;
            }
            footer.draw(&Text::new(
                curve.name.as_str(),
                (x + MARK + 8, y - 8),
                font(15),
            ))?;
        }

        let points = || self.curves.iter().flat_map(|curve| &curve.points);
        let x = points().map(|p| p.0);
        let x = self
            .horizontal
            .range(x, if self.has_dots() { 0.04 } else { 0.0 });
        let ends = self.curves.iter().flat_map(|curve| {
            let bars = curve.points.iter().zip(&curve.errors);
            bars.flat_map(|((_, y), error)| [y - error, y + error])
        });
        let y = points().map(|p| p.1).chain(ends);
        let y = self.vertical.range(y, 0.05);
        let log = |range: Range<f64>| {
            let ticks = ticks(&range);
            range.log_scale().with_key_points(ticks)
        };
        match (self.horizontal.logarithmic, self.vertical.logarithmic) {
            (false, false) => self.plot(&chart, x, y),
            (false, true) => self.plot(&chart, x, log(y)),
            (true, false) => self.plot(&chart, log(x), y),
            (true, true) => self.plot(&chart, log(x), log(y)),
        }
    }

    fn plot<X, Y>(&self, area: &DrawingArea<SVGBackend, Shift>, x: X, y: Y) -> Result<()>
    where
        X: AsRangedCoord<Value = f64>,
        Y: AsRangedCoord<Value = f64>,
        X::CoordDescType: ValueFormatter<f64>,
        Y::CoordDescType: ValueFormatter<f64>,
    {
        let mut chart = ChartBuilder::on(area)
            .caption(&self.title, font(20))
            .margin(MARGIN)
            .x_label_area_size(48)
            .y_label_area_size(64)
            .build_cartesian_2d(x, y)?;
        chart
            .configure_mesh()
            .bold_line_style(GRID)
            .light_line_style(GRID.mix(0.4))
            .axis_style(GRID.stroke_width(1))
            .label_style(font(14))
            .axis_desc_style(font(15))
            .x_desc(&self.horizontal.name)
            .y_desc(&self.vertical.name)
            .x_label_formatter(&|v| number(*v))
            .y_label_formatter(&|v| number(*v))
            .draw()?;
        for (curve, colour) in self.coloured() {
            let points = curve.points.iter().copied();
            if curve.style != Style::Dots {
                let thickness = if curve.style == Style::Line { 2 } else { 1 };
                chart.draw_series(LineSeries::new(
                    points.clone(),
                    colour.stroke_width(thickness),
                ))?;
            }
            if curve.style != Style::Line {
                chart.draw_series(points.clone().map(|p| Circle::new(p, 4, colour.filled())))?;
            }
            let bars = points.zip(&curve.errors).map(|((x, y), error)| {
                // A bar to below zero has no place on a logarithmic axis.
                let low = if self.vertical.logarithmic {
                    (y - error).max(1e-3 * y)
                } else {
                    y - error
                };
                PathElement::new([(x, low), (x, y + error)], colour.stroke_width(1))
            });
            chart.draw_series(bars)?;
        }
        Ok(())
    }

    fn has_dots(&self) -> bool {
        self.curves.iter().any(|curve| curve.style != Style::Line)
    }

    fn coloured(&self) -> impl Iterator<Item = (&Curve, &RGBColor)> {
        self.curves.iter().zip(COLOURS.iter().cycle())
    }

    /// Where each curve's entry begins, its row, and where it ends: below the plot, in as many rows as it takes.
    fn legend(&self, area: &DrawingArea<SVGBackend, Shift>) -> Result<Vec<(i32, i32, i32)>> {
        let (whole, _) = area.dim_in_pixel();
        let style = font(15);
        let mut entries: Vec<(i32, i32, i32)> = Vec::new();
        for curve in &self.curves {
            let (mut x, mut row) = entries
                .last()
                .map_or((64 + MARGIN, 0), |(_, row, end)| (*end, *row));
            if curve.name.is_empty() {
                entries.push((x, row, x));
                continue;
            }
            let long = MARK + 8 + width(area, &curve.name, &style)?;
            if x + long > whole as i32 - MARGIN {
                (x, row) = (64 + MARGIN, row + 1);
            }
            entries.push((x, row, x + long + 26));
        }
        Ok(entries)
    }
}

/// Places of the numbers along a logarithmic axis: fewer in a decade, the more decades there are.
fn ticks(range: &Range<f64>) -> Vec<f64> {
    let decades = (range.end / range.start).log10();
    let steps: &[f64] = if decades > 3.0 {
        &[1.0]
    } else if decades > 1.0 {
        &[1.0, 2.0, 5.0]
    } else {
        &[1.0, 1.5, 2.0, 3.0, 4.0, 5.0, 6.0, 8.0]
    };
    let first = range.start.log10().floor() as i32;
    (first..=first + decades as i32 + 1)
        .flat_map(|decade| steps.iter().map(move |step| step * 10f64.powi(decade)))
        .filter(|tick| range.contains(tick))
        .collect()
}

/// Short, without the digits that a rounding error has.
fn number(value: f64) -> String {
    let size = value.abs();
    if size != 0.0 && !(1e-3..1e5).contains(&size) {
        return format!("{value:e}");
    }
    let rounded = format!("{value:.6}");
    rounded
        .trim_end_matches('0')
        .trim_end_matches('.')
        .to_owned()
}
