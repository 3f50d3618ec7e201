//! What the colours of a map stand for.

use anyhow::Result;
use plotters::{coord::Shift, prelude::*};

use super::{
    BEARING, FIX, HYPOTHESIS, INK, LABELS, MARGIN, MIRRORED, Map, PARTICLE, PAST, REJECTED, WIDTH,
    font, shade, width,
};

impl Map {
    /// In as many rows as it takes.
    pub(super) fn legend(&self, area: &DrawingArea<SVGBackend, Shift>) -> Result<()> {
        const LEFT: i32 = LABELS as i32 + 16;
        let (mut x, mut y) = (LEFT, 15);
        let mut entry = |name: &str, draw: &dyn Fn(i32, i32) -> Result<()>| -> Result<()> {
            let style = font(16);
            let length = 34 + width(area, name, &style)?;
            if x + length > WIDTH as i32 - MARGIN as i32 {
                (x, y) = (LEFT, y + 26);
            }
            draw(x, y)?;
            area.draw(&Text::new(name, (x + 34, y - 9), style))?;
            x += length + 32;
            Ok(())
        };
        let line = |x, y, style| area.draw(&PathElement::new([(x, y), (x + 26, y)], style));
        entry("where bearings were taken", &|x, y| {
            if !self.track.is_empty() {
                line(x, y, INK.stroke_width(2))?;
            }
            Ok(area.draw(&Circle::new((x + 13, y), 3, INK.filled()))?)
        })?;
        entry("bearings", &|x, y| {
            Ok(line(x, y, BEARING.mix(0.7).stroke_width(2))?)
        })?;
        if !self.rejected.is_empty() {
            entry("rejected", &|x, y| {
                line(x, y, REJECTED.stroke_width(2))?;
                area.draw(&Circle::new((x + 6, y), 7, WHITE.filled()))?;
                area.draw(&Circle::new((x + 6, y), 7, REJECTED.stroke_width(1)))?;
                Ok(area.draw(&Cross::new((x + 6, y), 4, REJECTED.stroke_width(2)))?)
            })?;
        }
        if !self.past.is_empty() {
            entry("of the past", &|x, y| Ok(line(x, y, PAST.stroke_width(2))?))?;
        }
        if !self.mirrored.is_empty() {
            entry("mirrored", &|x, y| {
                Ok(line(x, y, MIRRORED.stroke_width(2))?)
            })?;
        }
        if let Some(regions) = self.densities.first() {
            let shares = regions
                .iter()
                .map(|r| format!("{:.0}", 100.0 * r.probability));
            let name = format!("{} % of the density", shares.collect::<Vec<_>>().join(", "));
            entry(&name, &|x, y| {
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
            })?;
        }
        if !self.particles.is_empty() {
            entry("particles", &|x, y| {
                for (dx, dy) in [(4, 3), (12, -4), (20, 2)] {
                    area.draw(&Circle::new(
                        (x + dx, y + dy),
                        4,
                        PARTICLE.mix(0.6).filled(),
                    ))?;
                }
                Ok(())
            })?;
        }
        if !self.hypotheses.is_empty() {
            entry("hypotheses", &|x, y| {
                Ok(line(x, y, HYPOTHESIS.stroke_width(2))?)
            })?;
        }
        if !self.ellipses.is_empty() {
            entry("fix and its 95 % ellipse", &|x, y| {
                line(x, y, FIX.stroke_width(3))?;
                Ok(area.draw(&Circle::new((x + 13, y), 6, FIX.filled()))?)
            })?;
        }
        if !self.truths.is_empty() {
            entry("true place", &|x, y| {
                Ok(area.draw(&Cross::new((x + 13, y), 8, INK.stroke_width(3)))?)
            })?;
        }
        Ok(())
    }
}
