//! The settings file: what comes in, how it is read, and where it goes.

mod inputs;
mod name;
mod outputs;

use std::{fs, path::Path, path::PathBuf};

use anyhow::{Context, Result, bail, ensure};
use serde::{Deserialize, Serialize};

use crate::reading::{Belief, Kind, Reading};
pub use inputs::{Input, Source};
pub use name::Name;
pub use outputs::{Form, Mqtt, Output, Sink};

/// The commented file that `foxhunt init` writes.
pub const EXAMPLE: &str = include_str!("example.toml");

/// All settings.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields, rename_all = "kebab-case")]
pub struct Settings {
    /// What this vehicle or station is called; other vehicles know it by that name.
    pub name: Name,
    /// What takes the bearings.
    pub locator: Kind,
    /// How lines are read.
    pub reading: Reading,
    /// What is believed of errors.
    pub errors: Belief,
    /// What comes in.
    pub input: Vec<Input>,
    /// Where it goes.
    pub output: Vec<Output>,
    /// Places with radio maps.
    pub site: Vec<Site>,
    /// The raw log.
    pub log: Option<Log>,
    /// The page.
    pub web: Web,
}

/// A place with a radio map, where radios hear tags.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub struct Site {
    /// What inputs call it.
    pub name: Name,
    /// The file of its radio map.
    pub map: PathBuf,
    /// How people walk there.
    #[serde(default)]
    pub walks: Walks,
    /// Packets come as binary frames.
    #[serde(default)]
    pub frames: bool,
    /// Where the origin of the map is, in degrees.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub latitude: Option<f64>,
    /// Where the origin of the map is, in degrees.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub longitude: Option<f64>,
    /// By how much the y axis of the map is turned clockwise from north, in degrees.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub turned_deg: Option<f64>,
}

/// How people walk.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Walks {
    /// Along a tunnel.
    #[default]
    Tunnel,
    /// About an office floor.
    Floor,
}

/// The raw log.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub struct Log {
    /// Where it is written.
    pub file: PathBuf,
    /// At this size another file is begun.
    #[serde(default = "Log::megabytes")]
    pub megabytes: u32,
    /// So many files are kept, the one that is written to among them.
    #[serde(default = "Log::files")]
    pub files: u32,
}

impl Log {
    fn megabytes() -> u32 {
        100
    }

    fn files() -> u32 {
        10
    }
}

/// The page.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields, rename_all = "kebab-case")]
pub struct Web {
    /// Whether there is one.
    pub enabled: bool,
    /// Where it is served.
    pub listen: String,
    /// What a browser must know, where that is not this machine alone; made up if there is none.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub token: Option<String>,
    /// A GeoJSON file that is drawn below everything.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub background: Option<PathBuf>,
    /// An MBTiles file of a map, of pictures, that is drawn below that.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub tiles: Option<PathBuf>,
}

impl Default for Web {
    fn default() -> Self {
        Self {
            enabled: true,
            listen: "127.0.0.1:8073".into(),
            token: None,
            background: None,
            tiles: None,
        }
    }
}

impl Settings {
    /// Reads a file.
    ///
    /// # Errors
    /// Names the file, the line, and what is wrong there.
    pub fn read(file: &Path) -> Result<Self> {
        let name = file.display();
        let text = fs::read_to_string(file).with_context(|| {
            format!("cannot read the settings {name}; `foxhunt init` writes some")
        })?;
        Self::parse(&text).map_err(|error| match error {
            (Some((line, column)), what) => anyhow::anyhow!("{name}:{line}:{column}: {what}"),
            (None, what) => anyhow::anyhow!("{name}: {what}"),
        })
    }

    /// Reads text; fails with the line and column, if they are known, and what is wrong there.
    fn parse(text: &str) -> Result<Self, (Option<(usize, usize)>, String)> {
        let settings: Self = toml::from_str(text).map_err(|error| {
            let at = error.span().map(|span| {
                let before = text.get(..span.start).unwrap_or(text);
                let line = 1 + before.matches('\n').count();
                let column = 1 + before.rsplit('\n').next().unwrap_or("").chars().count();
                (line, column)
            });
            (at, error.message().to_owned())
        })?;
        let checked = settings.check();
        checked.map_err(|error| (None, format!("{error:#}")))?;
        Ok(settings)
    }

    /// Settings as text that reads back to the same.
    pub fn text(&self) -> Result<String> {
        toml::to_string(self).context("settings that cannot be written")
    }

    /// Settings that a log holds.
    ///
    /// # Errors
    /// Says what is wrong.
    pub fn of_text(text: &str) -> Result<Self> {
        Self::parse(text).map_err(|(_, what)| anyhow::anyhow!("settings: {what}"))
    }

    fn check(&self) -> Result<()> {
        let mut names: Vec<&str> = self.input.iter().map(|input| &*input.name).collect();
        names.sort_unstable();
        if let Some(twice) = names.windows(2).find(|pair| pair[0] == pair[1]) {
            bail!("two inputs are called {}", twice[0]);
        }
        for input in &self.input {
            input
                .source()
                .with_context(|| format!("input {}", &*input.name))?;
        }
        for output in &self.output {
            output
                .sink()
                .with_context(|| format!("output {}", &*output.name))?;
        }
        if let Some(log) = &self.log {
            ensure!(
                log.megabytes >= 1 && log.files >= 1,
                "log: megabytes and files must be at least 1"
            );
        }
        Ok(())
    }

    /// The raw log is written to this file.
    pub fn set_log(&mut self, file: &Path) {
        let log = self.log.get_or_insert_with(|| Log {
            file: PathBuf::new(),
            megabytes: Log::megabytes(),
            files: Log::files(),
        });
        log.file = file.to_owned();
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    /// The example, with every setting that is commented out.
    fn all_of_the_example() -> String {
        EXAMPLE
            .lines()
            .map(|line| match line.strip_prefix("#") {
                Some(setting) if !setting.starts_with(' ') => format!("{setting}\n"),
                _ => format!("{line}\n"),
            })
            .collect()
    }

    #[test]
    fn the_example_is_read_with_and_without_its_comments() {
        Settings::of_text(EXAMPLE).unwrap();
        let all = all_of_the_example();
        let settings = Settings::of_text(&all).unwrap();
        assert!(settings.input.len() >= 10 && settings.output.len() >= 5);
        assert!(settings.log.is_some() && settings.web.background.is_some());
        assert!(settings.web.tiles.is_some());
        assert_eq!(
            Settings::of_text(&settings.text().unwrap()).unwrap(),
            settings
        );
    }

    proptest! {
        #[test]
        fn damaged_settings_are_read_or_refused(
            at in any::<prop::sample::Index>(), length in 0usize..40, with in ".{0,9}",
        ) {
            let all: Vec<char> = all_of_the_example().chars().collect();
            let (before, rest) = all.split_at(at.index(all.len()));
            let after = &rest[length.min(rest.len())..];
            let text: String = [before, &with.chars().collect::<Vec<_>>(), after].concat().iter().collect();
            if let Ok(settings) = Settings::of_text(&text) {
                prop_assert!(Settings::of_text(&settings.text().unwrap()).is_ok());
            }
        }
    }

    #[test]
    fn what_is_wrong_is_said_with_its_line() {
        let wrong = |text: &str| {
            let (at, what) = Settings::parse(text).unwrap_err();
            (at.map(|(line, _)| line), what)
        };
        let (line, what) = wrong("name = \"a\"\nlocater = \"robust\"\n");
        assert_eq!(line, Some(2));
        assert!(what.contains("locater"), "{what}");
        let (line, _) = wrong("[web]\nenabled = 3\n");
        assert_eq!(line, Some(2));
        let (_, what) = wrong("[[input]]\nname = \"a\"\n");
        assert!(what.contains("input a"), "{what}");
        let (_, what) = wrong("[[input]]\nname=\"a\"\nudp=\"0.0.0.0:1\"\nstdin=true\n");
        assert!(what.contains("input a"), "{what}");
        let twice = "[[input]]\nname=\"a\"\nstdin=true\n".repeat(2);
        assert!(wrong(&twice).1.contains("two inputs"));
        assert!(wrong("name = \"a/b\"").1.contains("letters"));
    }
}
