//! Where people walked, and where they were tracked.

use std::ops::Range;

use anyhow::Result;
use plotters::{
    coord::{Shift, types::RangedCoordf64},
    prelude::*,
};

use super::{GRID, INK, curves::COLOURS, font, width};

const WIDTH: u32 = 1480;
const HEIGHT: u32 = 900;
const HEADER: u32 = 84;
const FOOTER: u32 = 56;
const MARGIN: u32 = 16;
/// Room for the numbers left of and below a panel.
const LABELS: u32 = 58;

type Area<'b> = DrawingArea<SVGBackend<'b>, Shift>;
type Chart<'a, 'b> = ChartContext<'a, SVGBackend<'b>, Cartesian2d<RangedCoordf64, RangedCoordf64>>;

/// One tag.
#[derive(Debug, Clone, Default)]
pub struct Walk {
    /// Who it is.
    pub name: String,
    /// Where it was: seconds, metres.
    pub truth: Vec<(f64, [f64; 2])>,
    /// Where it was said to be.
    pub fixes: Vec<(f64, [f64; 2])>,
    /// The cloud at the end.
    pub particles: Vec<[f64; 2]>,
}

/// All walks of a place.
#[derive(Debug, Clone, Default)]
pub struct Walks {
    /// What the picture shows, in large letters.
    pub title: String,
    /// What it says, in small letters.
    pub caption: String,
    /// The lowest and the highest coordinates of the radio map.
    pub map: [[f64; 2]; 2],
    /// Whether the map is one row: only x is tracked.
    pub is_line: bool,
    /// Where the radios are.
    pub radios: Vec<[f64; 2]>,
    /// Who was tracked.
    pub walks: Vec<Walk>,
}

impl Walks {
    /// The picture. For a line: above where everybody is at the end, below everybody's way over time. For a plane: on the left
    /// the ways, on the right both coordinates over time.
    ///
    /// # Errors
    /// If it cannot be drawn.
    pub fn svg(&self) -> Result<String> {
        super::use_font()?;
        let mut svg = String::new();
        {
            let area = SVGBackend::with_string(&mut svg, (WIDTH, HEIGHT)).into_drawing_area();
            area.fill(&WHITE)?;
            let (header, rest) = area.split_vertically(HEADER);
            let (panels, footer) = rest.split_vertically(HEIGHT - HEADER - FOOTER);
            let left = (LABELS + MARGIN) as i32;
            header.draw(&Text::new(self.title.as_str(), (left, 18), font(27)))?;
            header.draw(&Text::new(self.caption.as_str(), (left, 54), font(16)))?;
            if self.is_line {
                let lanes = 24 * self.walks.len() as u32 + LABELS + 2 * MARGIN + 40;
                let (above, below) = panels.split_vertically(lanes);
                self.lanes(&above)?;
                self.over_time(&below)?;
            } else {
                let (plan, right) = panels.split_horizontally(860);
                self.plan(&plan)?;
                let (above, below) = right.split_vertically((HEIGHT - HEADER - FOOTER) / 2);
                self.coordinate(&above, 0, "metres along x")?;
                self.coordinate(&below, 1, "metres along y")?;
            }
            self.legend(&footer)?;
            area.present()?;
        }
        Ok(svg)
    }

    fn coloured(&self) -> impl Iterator<Item = (&Walk, &'static RGBColor)> {
        // Black is the truth's.
        self.walks.iter().zip(COLOURS[1..].iter().cycle())
    }

    /// From the first to the last time.
    fn times(&self) -> Range<f64> {
        let times = self.walks.iter().flat_map(|walk| &walk.truth);
        let times = times.map(|(time, _)| *time);
        let first = times.clone().fold(f64::INFINITY, f64::min);
        first..times.fold(first + 1.0, f64::max)
    }

    /// A metre more than the map and the truth.
    fn range(&self, d: usize) -> Range<f64> {
        let truth = self.walks.iter().flat_map(|walk| &walk.truth);
        let places = truth.map(|(_, place)| place[d]);
        let ends = [self.map[0][d], self.map[1][d]];
        let places = places.chain(ends);
        let low = places.clone().fold(f64::INFINITY, f64::min);
        low - 1.0..places.fold(low, f64::max) + 1.0
    }

    /// Where everybody is at the end of a line, each in a lane.
    fn lanes(&self, area: &Area<'_>) -> Result<()> {
        let count = self.walks.len() as f64;
        let mut chart = ChartBuilder::on(area)
            .margin(MARGIN)
            .x_label_area_size(LABELS)
            .y_label_area_size(LABELS)
            .build_cartesian_2d(self.range(0), -1.4..count)?;
        mesh(&mut chart, "metres along the way, at the end", "", false)?;
        for (number, (walk, colour)) in self.coloured().enumerate() {
            let lane = count - 0.5 - number as f64;
            // Spread over the lane, in their order, so that all are seen.
            let particles = walk.particles.iter().enumerate();
            let dots = particles.map(|(i, place)| {
                let aside = 0.7 * ((i as f64 * 0.618_034).fract() - 0.5);
                Circle::new((place[0], lane + aside), 2, colour.mix(0.3).filled())
            });
            chart.draw_series(dots)?;
            if let Some((_, place)) = walk.fixes.last() {
                chart.draw_series([Circle::new((place[0], lane), 5, colour.filled())])?;
            }
            if let Some((_, place)) = walk.truth.last() {
                let cross = Cross::new((place[0], lane), 6, INK.stroke_width(2));
                chart.draw_series([cross])?;
            }
            let (x, y) = chart.backend_coord(&(self.range(0).start, lane));
            let style = font(14).color(colour);
            let root = chart.plotting_area().strip_coord_spec();
            let (left, top) = root.get_base_pixel();
            let short = walk.name.trim_start_matches("tag ");
            root.draw(&Text::new(short, (x - left + 6, y - top - 8), style))?;
        }
        let radios = self.radios.iter().map(|place| (place[0], -0.8));
        chart.draw_series(radios.map(radio))?;
        Ok(())
    }

    /// Everybody's way along a line.
    fn over_time(&self, area: &Area<'_>) -> Result<()> {
        let times = self.times();
        let mut chart = ChartBuilder::on(area)
            .margin(MARGIN)
            .x_label_area_size(LABELS)
            .y_label_area_size(LABELS)
            // Downwards, as on a timetable.
            .build_cartesian_2d(self.range(0), -times.end..-times.start)?;
        mesh(&mut chart, "metres along the way", "seconds", true)?;
        for (walk, colour) in self.coloured() {
            let truth = walk.truth.iter();
            let truth = truth.map(|(time, place)| (place[0], -time));
            chart.draw_series(LineSeries::new(truth, INK.stroke_width(2)))?;
            let fixes = walk.fixes.iter();
            let fixes = fixes.map(|(time, place)| (place[0], -time));
            let line = colour.mix(0.6).stroke_width(1);
            chart.draw_series(LineSeries::new(fixes.clone(), line))?;
            chart.draw_series(fixes.map(|fix| Circle::new(fix, 3, colour.filled())))?;
        }
        Ok(())
    }

    /// Everybody's way over a plane.
    fn plan(&self, area: &Area<'_>) -> Result<()> {
        let (x, y) = (self.range(0), self.range(1));
        let (wide, high) = area.dim_in_pixel();
        let room = [wide, high].map(|pixels| f64::from(pixels - 2 * MARGIN - LABELS));
        let size = [x.end - x.start, y.end - y.start];
        let scale = (size[0] / room[0]).max(size[1] / room[1]);
        let stretched = |range: Range<f64>, d: usize| {
            let margin = 0.5 * (scale * room[d] - (range.end - range.start));
            range.start - margin..range.end + margin
        };
        let mut chart = ChartBuilder::on(area)
            .margin(MARGIN)
            .x_label_area_size(LABELS)
            .y_label_area_size(LABELS)
            .build_cartesian_2d(stretched(x, 0), stretched(y, 1))?;
        mesh(&mut chart, "metres along x", "metres along y", false)?;
        let [low, high] = self.map;
        chart.plotting_area().draw(&Rectangle::new(
            [(low[0], low[1]), (high[0], high[1])],
            RGBColor(170, 178, 184),
        ))?;
        for (walk, colour) in self.coloured() {
            let dots = walk.particles.iter();
            let style = colour.mix(0.25).filled();
            chart.draw_series(dots.map(|p| Circle::new((p[0], p[1]), 3, style)))?;
            let truth = walk.truth.iter().map(|(_, [x, y])| (*x, *y));
            chart.draw_series(LineSeries::new(truth, INK.stroke_width(2)))?;
            let fixes = walk.fixes.iter().map(|(_, [x, y])| (*x, *y));
            chart.draw_series(LineSeries::new(fixes.clone(), colour.stroke_width(2)))?;
            chart.draw_series(fixes.map(|place| Circle::new(place, 3, colour.filled())))?;
            if let Some((_, [x, y])) = walk.truth.last() {
                chart.draw_series([Cross::new((*x, *y), 9, INK.stroke_width(3))])?;
            }
        }
        let radios = self.radios.iter().map(|place| (place[0], place[1]));
        chart.draw_series(radios.map(radio))?;
        Ok(())
    }

    /// A coordinate over time.
    fn coordinate(&self, area: &Area<'_>, d: usize, name: &str) -> Result<()> {
        let mut chart = ChartBuilder::on(area)
            .margin(MARGIN)
            .x_label_area_size(LABELS)
            .y_label_area_size(LABELS)
            .build_cartesian_2d(self.times(), self.range(d))?;
        mesh(&mut chart, "seconds", name, false)?;
        for (walk, colour) in self.coloured() {
            let truth = walk.truth.iter().map(|(time, place)| (*time, place[d]));
            chart.draw_series(LineSeries::new(truth, INK.stroke_width(2)))?;
            let fixes = walk.fixes.iter().map(|(time, place)| (*time, place[d]));
            chart.draw_series(LineSeries::new(fixes, colour.stroke_width(2)))?;
        }
        Ok(())
    }

    fn legend(&self, area: &Area<'_>) -> Result<()> {
        let mut x = (LABELS + MARGIN) as i32;
        let colour = COLOURS[1];
        let mut entry = |name: &str, draw: &dyn Fn(i32) -> Result<()>| -> Result<()> {
            draw(x)?;
            let style = font(16);
            let end = x + 34 + width(area, name, &style)?;
            area.draw(&Text::new(name, (x + 34, 12), style))?;
            x = end + 32;
            Ok(())
        };
        let line = |x, style| area.draw(&PathElement::new([(x, 21), (x + 26, 21)], style));
        entry("true way", &|x| Ok(line(x, INK.stroke_width(2))?))?;
        entry("true place at the end", &|x| {
            Ok(area.draw(&Cross::new((x + 13, 21), 7, INK.stroke_width(2)))?)
        })?;
        entry("fixes", &|x| {
            line(x, colour.stroke_width(2))?;
            Ok(area.draw(&Circle::new((x + 13, 21), 4, colour.filled()))?)
        })?;
        entry("particles at the end", &|x| {
            for (dx, dy) in [(4, 24), (12, 17), (20, 23)] {
                area.draw(&Circle::new((x + dx, dy), 4, colour.mix(0.5).filled()))?;
            }
            Ok(())
        })?;
        entry("radios", &|x| {
            Ok(area.draw(&TriangleMarker::new((x + 13, 22), 8, INK.filled()))?)
        })
    }
}

fn radio(place: (f64, f64)) -> TriangleMarker<(f64, f64), i32> {
    TriangleMarker::new(place, 7, INK.filled())
}

fn mesh(chart: &mut Chart<'_, '_>, x: &str, y: &str, upside_down: bool) -> Result<()> {
    let down = |v: &f64| format!("{}", if upside_down { -v } else { *v } + 0.0);
    let mut mesh = chart.configure_mesh();
    mesh.bold_line_style(GRID)
        .light_line_style(TRANSPARENT)
        .axis_style(GRID.stroke_width(1))
        .label_style(font(14))
        .axis_desc_style(font(15))
        .x_labels(12)
        .y_labels(if y.is_empty() { 0 } else { 8 })
        .x_label_formatter(&|v| format!("{}", v + 0.0))
        .y_label_formatter(&down)
        .x_desc(x)
        .y_desc(y);
    mesh.draw()?;
    Ok(())
}
