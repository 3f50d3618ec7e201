//! Where everything was: the whole drive, and what is left of the uncertainty.

mod legend;

use std::{
    f64::consts::PI,
    iter::{once, repeat},
};

use anyhow::Result;
use plotters::{
    coord::{Shift, types::RangedCoordf64},
    prelude::*,
};

use foxhunt::estimate::Ellipse;

use super::frame::{Frame, outline};
use super::{GRID, INK, font, width};
use crate::density::Region;
use foxhunt_simulation::Sight;

const WIDTH: u32 = 1480;
const HEIGHT: u32 = 860;
const HEADER: u32 = 84;
const FOOTER: u32 = 56;
const MARGIN: u32 = 16;
/// Room for the numbers left of and below a panel.
const LABELS: u32 = 58;
/// The most surroundings that are shown.
const PANELS: usize = 3;

const BEARING: RGBColor = RGBColor(240, 140, 40);
const PARTICLE: RGBColor = RGBColor(0, 137, 150);
const FIX: RGBColor = RGBColor(200, 30, 70);
const HYPOTHESIS: RGBColor = RGBColor(94, 53, 177);
const MIRRORED: RGBColor = RGBColor(30, 136, 229);
const PAST: RGBColor = RGBColor(188, 158, 138);
const REJECTED: RGBColor = RGBColor(120, 130, 136);

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
    /// Bearings that point away from the source: drawn both ways.
    pub mirrored: Vec<Sight>,
    /// Bearings that the estimate does not rest on: where they were taken there is a cross.
    pub rejected: Vec<Sight>,
    /// Bearings that fitted what was known when they were taken.
    pub past: Vec<Sight>,
    /// Where sources that move went.
    pub moves: Vec<Vec<[f64; 2]>>,
    /// Where the vehicle went.
    pub track: Vec<[f64; 2]>,
    /// How dense the particles are, for each source: regions, the widest first.
    pub densities: Vec<Vec<Region>>,
    /// The cloud.
    pub particles: Vec<[f64; 2]>,
    /// Where the source may be, each a region and its probability.
    pub hypotheses: Vec<(Ellipse, f64)>,
    /// For each source the region that holds it with 95 % probability, about the estimate.
    pub ellipses: Vec<Ellipse>,
    /// Where each source was.
    pub truths: Vec<[f64; 2]>,
}

impl Map {
    /// The picture: on the left the whole drive, on the right the surroundings of the fix, or of the first three one below
    /// the other; all with the same scale in both directions.
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
            let divided = !self.ellipses.is_empty();
            let (left, right) = panels.split_horizontally(if divided { WIDTH / 2 } else { WIDTH });
            self.panel(&left, self.whole(), "the drive", true)?;
            let near = &self.ellipses[..self.ellipses.len().min(PANELS)];
            if let [_, _, ..] = near {
                for (panel, ellipse) in right.split_evenly((near.len(), 1)).iter().zip(near) {
                    let frame = Frame::round(outline(ellipse)).widened(1.3);
                    self.panel(panel, frame, "round one fix", false)?;
                }
            } else if let [ellipse] = near {
                self.panel(&right, self.surroundings(ellipse), "round the fix", false)?;
            }
            self.legend(&footer)?;
            area.present()?;
        }
        Ok(svg)
    }

    fn all_sights(&self) -> impl Iterator<Item = &Sight> + Clone {
        (self.sights.iter())
            .chain(&self.mirrored)
            .chain(&self.rejected)
            .chain(&self.past)
    }

    /// The box of everything.
    fn whole(&self) -> Frame {
        /// A hypothesis of less than this probability may lie outside.
        const LIKELY: f64 = 0.05;
        let places = self.all_sights().map(|sight| sight.position);
        let ellipses = self.ellipses.iter().flat_map(outline);
        let hypotheses = (self.hypotheses.iter())
            .filter(|(_, probability)| *probability >= LIKELY)
            .map(|(ellipse, _)| ellipse.centre.map(f64::from));
        let all = (places.chain(self.track.iter().copied()))
            .chain(ellipses)
            .chain(hypotheses)
            .chain(self.truths.iter().copied());
        Frame::round(all).widened(1.12)
    }

    /// The box of the ellipse, and of true places unless they are far off.
    fn surroundings(&self, ellipse: &Ellipse) -> Frame {
        let frame = Frame::round(outline(ellipse));
        let region = frame.widened(4.0);
        let near = self.truths.iter().filter(|truth| region.contains(**truth));
        Frame::round(outline(ellipse).chain(near.copied())).widened(1.3)
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
            .y_labels((height / 70) as usize)
            .x_label_formatter(&number)
            .y_label_formatter(&number)
            .x_desc(format!("metres east ({name})"))
            .y_desc("metres north")
            .draw()?;

        self.draw_density(&mut chart, &frame)?;
        self.draw_bearings(&mut chart, &frame, whole)?;
        self.draw_cloud(&mut chart, &frame, whole)?;
        self.draw_way(&mut chart, &frame, whole)?;
        self.draw_answer(&mut chart, &frame, whole)?;
        chart.plotting_area().draw(&Rectangle::new(
            [(frame.low[0], frame.low[1]), (frame.high[0], frame.high[1])],
            RGBColor(170, 178, 184),
        ))?;
        Ok(())
    }

    fn draw_density(&self, chart: &mut Chart, frame: &Frame) -> Result<()> {
        for regions in &self.densities {
            let mut under = WHITE;
            for (index, region) in regions.iter().enumerate() {
                let shade = shade(index, regions.len());
                for rings in &region.polygons {
                    // What the next polygons of the region do not fill lies in a hole.
                    for (ring, colour) in rings.iter().zip(once(shade).chain(repeat(under))) {
                        let places = frame.polygon(ring);
                        chart.draw_series([Polygon::new(places, colour.filled())])?;
                    }
                }
                under = shade;
            }
        }
        Ok(())
    }

    fn draw_bearings(&self, chart: &mut Chart, frame: &Frame, whole: bool) -> Result<()> {
        /// More bearings are fainter, or nothing else could be seen.
        const FEW: f64 = 80.0;
        let crowd = (FEW / self.all_sights().count().max(1) as f64)
            .sqrt()
            .min(1.0);
        let opacity = crowd * if whole { 0.35 } else { 0.5 };
        let turned = self.mirrored.iter().map(|sight| Sight {
            bearing: sight.bearing + PI,
            ..*sight
        });
        let mirrored: Vec<Sight> = self.mirrored.iter().copied().chain(turned).collect();
        for (sights, colour) in [
            (&self.past, PAST.mix(opacity)),
            (&self.rejected, REJECTED.mix(1.5 * opacity)),
            (&self.sights, BEARING.mix(opacity)),
            (&mirrored, MIRRORED.mix(opacity)),
        ] {
            let rays = sights.iter().filter_map(|sight| frame.ray(sight));
            let style = colour.stroke_width(1);
            chart.draw_series(rays.map(|[from, to]| PathElement::new([from, to], style)))?;
        }
        Ok(())
    }

    fn draw_way(&self, chart: &mut Chart, frame: &Frame, whole: bool) -> Result<()> {
        let style = INK.stroke_width(2);
        let inside = |sight: &&Sight| frame.contains(sight.position);
        let place = |sight: &Sight| (sight.position[0], sight.position[1]);
        if whole {
            let way = frame.line(self.track.iter().copied());
            chart.draw_series(way.into_iter().map(|part| PathElement::new(part, style)))?;
            let places = self.all_sights().map(place);
            let size = if self.all_sights().count() > 100 {
                2
            } else {
                3
            };
            chart.draw_series(places.map(|place| Circle::new(place, size, INK.filled())))?;
        }
        let rejected = self.rejected.iter().filter(inside).map(place);
        let discs = rejected
            .clone()
            .map(|place| Circle::new(place, 7, WHITE.filled()));
        chart.draw_series(discs)?;
        let style = REJECTED.stroke_width(1);
        chart.draw_series(rejected.clone().map(|place| Circle::new(place, 7, style)))?;
        let style = REJECTED.stroke_width(2);
        chart.draw_series(rejected.map(|place| Cross::new(place, 4, style)))?;
        Ok(())
    }

    fn draw_cloud(&self, chart: &mut Chart, frame: &Frame, whole: bool) -> Result<()> {
        let (size, opacity) = if whole { (2, 0.25) } else { (4, 0.45) };
        let inside = self.particles.iter().filter(|p| frame.contains(**p));
        let style = PARTICLE.mix(opacity).filled();
        chart.draw_series(inside.map(|p| Circle::new((p[0], p[1]), size, style)))?;
        Ok(())
    }

    fn draw_answer(&self, chart: &mut Chart, frame: &Frame, whole: bool) -> Result<()> {
        for (ellipse, probability) in &self.hypotheses {
            let style = HYPOTHESIS.mix(0.4 + 0.6 * probability).stroke_width(2);
            let parts = frame.line(outline(ellipse)).into_iter();
            chart.draw_series(parts.map(|part| PathElement::new(part, style)))?;
        }
        let style = FIX.stroke_width(if whole { 1 } else { 3 });
        for places in &self.moves {
            let parts = frame.line(places.iter().copied()).into_iter();
            let thin = FIX.mix(0.5).stroke_width(1);
            chart.draw_series(parts.map(|part| PathElement::new(part, thin)))?;
        }
        for ellipse in &self.ellipses {
            let parts = frame.line(outline(ellipse)).into_iter();
            chart.draw_series(parts.map(|part| PathElement::new(part, style)))?;
            let [x, y] = ellipse.centre.map(f64::from);
            if !frame.contains([x, y]) {
                continue;
            }
            let size = if whole { 5 } else { 7 };
            chart.draw_series([Circle::new((x, y), size, FIX.filled())])?;
        }
        for truth in self.truths.iter().filter(|truth| frame.contains(**truth)) {
            let size = if whole { 9 } else { 12 };
            chart.draw_series([Cross::new((truth[0], truth[1]), size, INK.stroke_width(3))])?;
        }
        Ok(())
    }
}

/// The colour of a region of so many.
fn shade(index: usize, regions: usize) -> RGBColor {
    let strength = 0.1 + 0.45 * (index as f64 + 1.0) / regions as f64;
    let RGBColor(red, green, blue) = PARTICLE;
    let mixed = |part: u8| (255.0 - strength * (255.0 - f64::from(part))) as u8;
    RGBColor(mixed(red), mixed(green), mixed(blue))
}
