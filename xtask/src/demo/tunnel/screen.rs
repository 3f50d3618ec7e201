//! The fixes on the terminal, as they come.

use std::collections::BTreeMap;

use anyhow::Result;
use foxhunt::fingerprint::RadioMap;
use foxhunt_host::packets::Scene;
use indicatif::ProgressBar;

use crate::reports::beacon::{self, Report, TagFix};

/// Columns of the tunnel's drawing.
const COLUMNS: usize = 82;

/// What has been shown.
pub struct Screen<'a> {
    scene: &'a Scene,
    bar: &'a ProgressBar,
    /// From one end of the map to the other, in metres.
    ends: [f64; 2],
    /// The last fix of each tag.
    fixes: BTreeMap<u32, TagFix>,
    /// The second that is drawn next.
    second: u32,
    /// Bytes of the output that were read.
    read: usize,
}

impl<'a> Screen<'a> {
    pub fn new(scene: &'a Scene, bar: &'a ProgressBar) -> Result<Self> {
        let map = RadioMap::new(&scene.map)?;
        let last = map.lattice().points() - 1;
        let ends = [0, last].map(|point| f64::from(map.lattice().position(point)[0]));
        Ok(Self {
            scene,
            bar,
            ends,
            fixes: BTreeMap::new(),
            second: 1,
            read: 0,
        })
    }

    /// Shows what is new in all that the firmware has sent so far.
    pub fn show(&mut self, output: &[u8]) {
        // A report may come in pieces: only whole lines are read.
        let end = output.iter().rposition(|byte| *byte == b'\n');
        let end = end.map_or(0, |last| last + 1);
        for report in beacon::parse(&output[self.read..end]) {
            self.take(report);
        }
        self.read = end;
    }

    fn take(&mut self, report: Report) {
        match report {
            Report::Radio {
                time,
                radio,
                is_silent,
            } => {
                let what = if is_silent {
                    "hears nothing"
                } else {
                    "hears again"
                };
                self.say(&format!("{time:4.0} s  radio {radio} {what}"));
            }
            Report::Fix(fix) => {
                let known = self.fixes.get(&fix.tag);
                let is_news =
                    fix.state == "LOST" || known.is_some_and(|known| known.state == "LOST");
                if is_news && known.is_none_or(|known| known.state != fix.state) {
                    let (time, tag) = (fix.time, fix.tag);
                    let state = fix.state.to_lowercase();
                    self.say(&format!("{time:4.0} s  tag {tag} is {state}"));
                }
                let time = fix.time;
                self.fixes.insert(fix.tag, fix);
                if time >= f64::from(self.second) {
                    self.draw(time);
                    self.second = time as u32 + 1;
                }
            }
            Report::Status(_) => {}
        }
    }

    fn say(&self, line: &str) {
        self.bar.suspend(|| println!("{line}"));
    }

    /// Where everybody is.
    fn draw(&self, time: f64) {
        let mut errors = Vec::new();
        for fix in self.fixes.values() {
            let truth = self.scene.recording.truth.get(&fix.tag);
            if let Some([x, y]) = truth.and_then(|path| path.at(fix.time)) {
                errors.push((fix.place[0] - x).hypot(fix.place[1] - y));
            }
        }
        errors.sort_by(f64::total_cmp);
        let median = errors.get(errors.len() / 2).copied().unwrap_or(f64::NAN);
        let mut fixes = self.fixes.values();
        let line = match (fixes.next(), fixes.next()) {
            (Some(fix), None) => {
                let [x, y] = fix.place;
                format!(
                    "{time:4.0} s  {x:6.2} {y:6.2} m  {median:6.2} m from the truth  1 sigma {:5.2} m  {}",
                    fix.sigma,
                    fix.state.to_lowercase()
                )
            }
            _ => format!(
                "{time:4.0} s  [{}]  median error {median:.1} m",
                self.strip()
            ),
        };
        self.say(&line);
    }

    /// The tunnel from above: the last digit of each tag where it is.
    fn strip(&self) -> String {
        let mut strip = vec!['.'; COLUMNS];
        let [from, to] = self.ends;
        for (tag, fix) in &self.fixes {
            let column = (fix.place[0] - from) / (to - from) * (COLUMNS - 1) as f64;
            if let Some(place) = strip.get_mut(column.round() as usize) {
                *place = char::from_digit(tag % 10, 10).unwrap_or('?');
            }
        }
        strip.into_iter().collect()
    }
}
