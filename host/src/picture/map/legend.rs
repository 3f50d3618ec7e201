//! What the colours of a map stand for.

use anyhow::Result;
use plotters::{coord::Shift, prelude::*};

use super::{
    BEARING, FIX, HYPOTHESIS, INK, LABELS, MARGIN, MIRRORED, Map, PARTICLE, PAST, REJECTED, WIDTH,
    font, shade, width,
};

const LEFT: i32 = LABELS as i32 + 16;

/// The entries, in as many rows as it takes.
struct Legend<'a, 'b> {
    area: &'a DrawingArea<SVGBackend<'b>, Shift>,
    /// Where the next entry begins.
    x: i32,
    y: i32,
}

impl Legend<'_, '_> {
    /// Adds an entry, with the mark that is drawn at a place.
    fn add(&mut self, name: &str, mark: impl Fn(i32, i32) -> Result<()>) -> Result<()> {
        let style = font(16);
        let length = 34 + width(self.area, name, &style)?;
        if self.x + length > WIDTH as i32 - MARGIN as i32 {
            (self.x, self.y) = (LEFT, self.y + 26);
        }
        mark(self.x, self.y)?;
        let place = (self.x + 34, self.y - 9);
        self.area.draw(&Text::new(name, place, style))?;
        self.x += length + 32;
        Ok(())
    }

    /// Adds an entry with a line for its mark.
    fn add_line(&mut self, name: &str, style: ShapeStyle) -> Result<()> {
        let area = self.area;
        self.add(name, |x, y| {
            Ok(area.draw(&PathElement::new([(x, y), (x + 26, y)], style))?)
        })
    }
}

impl Map {
    pub(super) fn legend(&self, area: &DrawingArea<SVGBackend, Shift>) -> Result<()> {
        let mut legend = Legend {
            area,
            x: LEFT,
            y: 15,
        };
        self.bearings_legend(&mut legend)?;
        self.densities_legend(&mut legend)?;
        self.answer_legend(&mut legend)
    }

    fn bearings_legend(&self, legend: &mut Legend) -> Result<()> {
        let area = legend.area;
        let line = |x, y, style| area.draw(&PathElement::new([(x, y), (x + 26, y)], style));
        legend.add("where bearings were taken", |x, y| {
            if !self.track.is_empty() {
                line(x, y, INK.stroke_width(2))?;
            }
            Ok(area.draw(&Circle::new((x + 13, y), 3, INK.filled()))?)
        })?;
        legend.add_line("bearings", BEARING.mix(0.7).stroke_width(2))?;
        if !self.rejected.is_empty() {
            legend.add("rejected", |x, y| {
                line(x, y, REJECTED.stroke_width(2))?;
                area.draw(&Circle::new((x + 6, y), 7, WHITE.filled()))?;
                area.draw(&Circle::new((x + 6, y), 7, REJECTED.stroke_width(1)))?;
                Ok(area.draw(&Cross::new((x + 6, y), 4, REJECTED.stroke_width(2)))?)
            })?;
        }
        if !self.past.is_empty() {
            legend.add_line("of the past", PAST.stroke_width(2))?;
        }
        if !self.mirrored.is_empty() {
            legend.add_line("mirrored", MIRRORED.stroke_width(2))?;
        }
        Ok(())
    }

    fn densities_legend(&self, legend: &mut Legend) -> Result<()> {
        let Some(regions) = self.densities.first() else {
            return Ok(());
        };
        let area = legend.area;
        let percents = regions
            .iter()
            .map(|r| format!("{:.0}", 100.0 * r.probability));
        let percents: Vec<String> = percents.collect();
        let name = format!("{} % of the density", percents.join(", "));
        legend.add(&name, |x, y| {
            for index in 0..regions.len() {
                let inset = 3 * index as i32;
                area.draw(&Rectangle::new(
                    [
                        (x + inset, y - 10 + inset / 2),
                        (x + 26 - inset, y + 10 - inset / 2),
                    ],
                    shade(index, regions.len()).filled(),
                ))?;
            }
            Ok(())
        })
    }

    fn answer_legend(&self, legend: &mut Legend) -> Result<()> {
        let area = legend.area;
        if !self.particles.is_empty() {
            legend.add("particles", |x, y| {
                for (dx, dy) in [(4, 3), (12, -4), (20, 2)] {
                    let style = PARTICLE.mix(0.6).filled();
                    area.draw(&Circle::new((x + dx, y + dy), 4, style))?;
                }
                Ok(())
            })?;
        }
        if !self.hypotheses.is_empty() {
            legend.add_line("hypotheses", HYPOTHESIS.stroke_width(2))?;
        }
        if !self.ellipses.is_empty() {
            legend.add("fix and its 95 % ellipse", |x, y| {
                let line = PathElement::new([(x, y), (x + 26, y)], FIX.stroke_width(3));
                area.draw(&line)?;
                Ok(area.draw(&Circle::new((x + 13, y), 6, FIX.filled()))?)
            })?;
        }
        if !self.truths.is_empty() {
            legend.add("true place", |x, y| {
                Ok(area.draw(&Cross::new((x + 13, y), 8, INK.stroke_width(3)))?)
            })?;
        }
        Ok(())
    }
}
