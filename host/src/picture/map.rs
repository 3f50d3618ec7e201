//! Where everything was: the whole drive, and what is left of the uncertainty.

use anyhow::Result;
use plotters::{
    coord::{Shift, types::RangedCoordf64},
    prelude::*,
};

use foxhunt::estimate::Ellipse;

use super::{GRID, INK, font, width};
use crate::Sight;

const WIDTH: u32 = 1480;
const HEIGHT: u32 = 860;
const HEADER: u32 = 84;
const FOOTER: u32 = 56;
const MARGIN: u32 = 16;
/// Room for the numbers left of and below a panel.
const LABELS: u32 = 58;

const BEARING: RGBColor = RGBColor(240, 140, 40);
const PARTICLE: RGBColor = RGBColor(0, 137, 150);
const FIX: RGBColor = RGBColor(200, 30, 70);
const HYPOTHESIS: RGBColor = RGBColor(94, 53, 177);
const REJECTED: RGBColor = RGBColor(144, 153, 158);

type Chart<'a, 'b> = ChartContext<'a, SVGBackend<'b>, Cartesian2d<RangedCoordf64, RangedCoordf64>>;

/// A drive and what came of it. Places are in metres east and north of the origin.
#[derive(Debug, Clone, Default)]
pub struct Map {
    /// What the picture shows, in large letters.
    pub title: String,
    /// What it says, in small letters.
    pub caption: String,
    /// The bearings, in order of time.
    pub sights: Vec<Sight>,
    /// Bearings that the estimate does not rest on.
    pub rejected: Vec<Sight>,
    /// Whether the places of the bearings are those of one drive: a line then joins them.
    pub joined: bool,
    /// The cloud.
    pub particles: Vec<[f64; 2]>,
    /// Where the source may be, each a region and its share of the probability.
    pub hypotheses: Vec<(Ellipse, f64)>,
    /// The region that holds the source with 95 % probability.
    pub ellipse: Option<Ellipse>,
    /// The estimate.
    pub fix: Option<[f64; 2]>,
    /// Where the source was.
    pub truth: Option<[f64; 2]>,
}

impl Map {
    /// The picture: on the left the whole drive, on the right the surroundings of the fix, both with
    /// the same scale in both directions.
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
            header.draw(&Text::new(
                self.title.as_str(),
                (LABELS as i32 + 16, 18),
                font(27),
            ))?;
            header.draw(&Text::new(
                self.caption.as_str(),
                (LABELS as i32 + 16, 54),
                font(16),
            ))?;
            let (left, right) = panels.split_horizontally(WIDTH / 2);
            self.panel(&left, self.whole(), "the drive", true)?;
            self.panel(&right, self.surroundings(), "round the fix", false)?;
            self.legend(&footer)?;
            area.present()?;
        }
        Ok(svg)
    }

    fn all_sights(&self) -> impl Iterator<Item = &Sight> + Clone {
        self.sights.iter().chain(&self.rejected)
    }

    /// The box of everything.
    fn whole(&self) -> Frame {
        let places = self.all_sights().map(|sight| sight.position);
        let ellipse = self.ellipse.iter().flat_map(outline).map(|(x, y)| [x, y]);
        Frame::round(places.chain(ellipse).chain(self.truth).chain(self.fix)).widened(1.12)
    }

    /// The box of the ellipse and the truth.
    fn surroundings(&self) -> Frame {
        let Some(ellipse) = &self.ellipse else {
            return self.whole();
        };
        let places = outline(ellipse).into_iter().map(|(x, y)| [x, y]);
        Frame::round(places.chain(self.truth).chain(self.fix)).widened(1.3)
    }

    fn panel(
        &self,
        area: &DrawingArea<SVGBackend, Shift>,
        frame: Frame,
        name: &str,
        whole: bool,
    ) -> Result<()> {
        let (width, height) = area.dim_in_pixel();
        let frame = frame.with_shape(
            f64::from(width - 2 * MARGIN - LABELS),
            f64::from(height - 2 * MARGIN - LABELS),
        );
        let mut chart = ChartBuilder::on(area)
            .margin(MARGIN)
            .x_label_area_size(LABELS)
            .y_label_area_size(LABELS)
            .build_cartesian_2d(frame.low[0]..frame.high[0], frame.low[1]..frame.high[1])?;
        let decimals = frame.decimals();
        let number = |v: &f64| format!("{v:.decimals$}");
        chart
            .configure_mesh()
            .bold_line_style(GRID)
            .light_line_style(TRANSPARENT)
            .axis_style(GRID.stroke_width(1))
            .label_style(font(14))
            .axis_desc_style(font(15))
            .x_labels(8)
            .y_labels(10)
            .x_label_formatter(&number)
            .y_label_formatter(&number)
            .x_desc(format!("metres east ({name})"))
            .y_desc("metres north")
            .draw()?;

        self.draw_bearings(&mut chart, &frame, whole)?;
        self.draw_cloud(&mut chart, whole)?;
        if whole {
            let track = self
                .all_sights()
                .map(|sight| (sight.position[0], sight.position[1]));
            if self.joined && self.rejected.is_empty() {
                chart.draw_series(LineSeries::new(track.clone(), INK.stroke_width(2)))?;
            }
            chart.draw_series(track.map(|place| Circle::new(place, 3, INK.filled())))?;
        }
        self.draw_answer(&mut chart, whole)?;
        chart.plotting_area().draw(&Rectangle::new(
            [(frame.low[0], frame.low[1]), (frame.high[0], frame.high[1])],
            RGBColor(170, 178, 184),
        ))?;
        Ok(())
    }

    fn draw_bearings(&self, chart: &mut Chart, frame: &Frame, whole: bool) -> Result<()> {
        let opacity = if whole { 0.35 } else { 0.5 };
        for (sights, colour) in [
            (&self.rejected, REJECTED.mix(0.8)),
            (&self.sights, BEARING.mix(opacity)),
        ] {
            let rays = sights.iter().filter_map(|sight| frame.ray(sight));
            let style = colour.stroke_width(1);
            chart.draw_series(rays.map(|[from, to]| PathElement::new([from, to], style)))?;
        }
        Ok(())
    }

    fn draw_cloud(&self, chart: &mut Chart, whole: bool) -> Result<()> {
        let (size, opacity) = if whole { (2, 0.25) } else { (4, 0.45) };
        let (x, y) = (chart.x_range(), chart.y_range());
        let inside = self
            .particles
            .iter()
            .filter(|p| x.contains(&p[0]) && y.contains(&p[1]));
        let style = PARTICLE.mix(opacity).filled();
        chart.draw_series(inside.map(|p| Circle::new((p[0], p[1]), size, style)))?;
        Ok(())
    }

    fn draw_answer(&self, chart: &mut Chart, whole: bool) -> Result<()> {
        for (ellipse, share) in &self.hypotheses {
            let style = HYPOTHESIS.mix(0.4 + 0.6 * share).stroke_width(2);
            chart.draw_series([PathElement::new(outline(ellipse), style)])?;
        }
        if let Some(ellipse) = &self.ellipse {
            chart.draw_series([PathElement::new(
                outline(ellipse),
                FIX.stroke_width(if whole { 1 } else { 3 }),
            )])?;
        }
        if let Some(fix) = self.fix {
            let size = if whole { 5 } else { 7 };
            chart.draw_series([Circle::new((fix[0], fix[1]), size, FIX.filled())])?;
        }
        if let Some(truth) = self.truth {
            let size = if whole { 9 } else { 12 };
            chart.draw_series([Cross::new((truth[0], truth[1]), size, INK.stroke_width(3))])?;
        }
        Ok(())
    }

    fn legend(&self, area: &DrawingArea<SVGBackend, Shift>) -> Result<()> {
        let mut x = LABELS as i32 + 16;
        let mut entry = |name: &str, draw: &dyn Fn(i32) -> Result<()>| -> Result<()> {
            draw(x)?;
            let style = font(16);
            let end = x + 34 + width(area, name, &style)?;
            area.draw(&Text::new(name, (x + 34, 12), style))?;
            x = end + 32;
            Ok(())
        };
        let line = |x, style| area.draw(&PathElement::new([(x, 21), (x + 26, 21)], style));
        entry("where bearings were taken", &|x| {
            if self.joined {
                line(x, INK.stroke_width(2))?;
            }
            Ok(area.draw(&Circle::new((x + 13, 21), 3, INK.filled()))?)
        })?;
        entry("bearings", &|x| {
            Ok(line(x, BEARING.mix(0.7).stroke_width(2))?)
        })?;
        if !self.rejected.is_empty() {
            entry("bearings that do not fit", &|x| {
                Ok(line(x, REJECTED.stroke_width(2))?)
            })?;
        }
        if !self.particles.is_empty() {
            entry("particles", &|x| {
                for (dx, dy) in [(4, 24), (12, 17), (20, 23)] {
                    area.draw(&Circle::new((x + dx, dy), 4, PARTICLE.mix(0.6).filled()))?;
                }
                Ok(())
            })?;
        }
        if !self.hypotheses.is_empty() {
            entry("hypotheses", &|x| Ok(line(x, HYPOTHESIS.stroke_width(2))?))?;
        }
        if self.ellipse.is_some() {
            entry("95 % ellipse", &|x| Ok(line(x, FIX.stroke_width(3))?))?;
        }
        if self.fix.is_some() {
            entry("fix", &|x| {
                Ok(area.draw(&Circle::new((x + 13, 21), 6, FIX.filled()))?)
            })?;
        }
        if self.truth.is_some() {
            entry("true place", &|x| {
                Ok(area.draw(&Cross::new((x + 13, 21), 8, INK.stroke_width(3)))?)
            })?;
        }
        Ok(())
    }
}

fn outline(ellipse: &Ellipse) -> Vec<(f64, f64)> {
    let [x, y] = ellipse.centre.map(f64::from);
    let (major, minor) = (f64::from(ellipse.semi_major), f64::from(ellipse.semi_minor));
    let (sin, cos) = f64::from(ellipse.orientation).sin_cos();
    (0..=180)
        .map(|k| {
            let (s, c) = f64::from(2 * k).to_radians().sin_cos();
            (
                x + major * c * cos - minor * s * sin,
                y + major * c * sin + minor * s * cos,
            )
        })
        .collect()
}

/// A box in the plane.
#[derive(Debug, Clone, Copy)]
struct Frame {
    low: [f64; 2],
    high: [f64; 2],
}

impl Frame {
    fn round(places: impl Iterator<Item = [f64; 2]>) -> Self {
        places
            .map(|place| Self {
                low: place,
                high: place,
            })
            .reduce(|a, b| Self {
                low: [0, 1].map(|d| a.low[d].min(b.low[d])),
                high: [0, 1].map(|d| a.high[d].max(b.high[d])),
            })
            .unwrap_or(Self {
                low: [-1.0; 2],
                high: [1.0; 2],
            })
    }

    fn resized(self, width: f64, height: f64) -> Self {
        let half = [width / 2.0, height / 2.0];
        let centre = [0, 1].map(|d| (self.low[d] + self.high[d]) / 2.0);
        Self {
            low: [0, 1].map(|d| centre[d] - half[d]),
            high: [0, 1].map(|d| centre[d] + half[d]),
        }
    }

    fn widened(self, factor: f64) -> Self {
        let [width, height] = self.size();
        let margin = (factor - 1.0) * width.max(height).max(1e-3);
        self.resized(width + margin, height + margin)
    }

    /// The same, made wider or higher until its sides are as `width` to `height`.
    fn with_shape(self, width: f64, height: f64) -> Self {
        let [w, h] = self.size();
        let scale = (w / width).max(h / height);
        self.resized(scale * width, scale * height)
    }

    fn size(&self) -> [f64; 2] {
        [0, 1].map(|d| self.high[d] - self.low[d])
    }

    /// Digits that tell the numbers of an axis apart.
    fn decimals(&self) -> usize {
        let [width, height] = self.size();
        (-(width.min(height) / 16.0).log10().floor()).clamp(0.0, 4.0) as usize
    }

    /// The part of a bearing's ray that lies inside.
    fn ray(&self, sight: &Sight) -> Option<[(f64, f64); 2]> {
        let (sin, cos) = sight.bearing.sin_cos();
        let (mut near, mut far) = (0.0_f64, f64::INFINITY);
        for (d, slope) in [cos, sin].into_iter().enumerate() {
            let at = |side: f64| (side - sight.position[d]) / slope;
            let (a, b) = (at(self.low[d]), at(self.high[d]));
            near = near.max(a.min(b));
            far = far.min(a.max(b));
        }
        let point = |t: f64| (sight.position[0] + t * cos, sight.position[1] + t * sin);
        (near < far).then(|| [point(near), point(far)])
    }
}
