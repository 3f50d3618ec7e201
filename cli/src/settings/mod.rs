//! The settings file: what comes in, how it is read, and where it goes.

mod inputs;
mod name;
mod outputs;
mod place;

use std::{fs, path::Path, path::PathBuf};

use anyhow::{Context, Result};
use serde::{Deserialize, Serialize};

use crate::{
    reading::{Belief, Kind, Reading},
    wrong::{Wrong, address},
};
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
    /// The file of its radio map; of the lowest floor, if there are several.
    pub map: PathBuf,
    /// The maps of the floors above it, from the lowest to the highest.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub above: Vec<PathBuf>,
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
    /// Where people change floors.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub passage: Vec<Passage>,
    /// Rooms that tags may be in.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub room: Vec<Room>,
}

/// Stairs between two floors, or a lift between more.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub struct Passage {
    /// The floors that it joins, counted from 0.
    pub floors: Vec<u8>,
    /// Its corners on the maps, in metres.
    pub corners: Vec<[f32; 2]>,
    /// After how many seconds in it somebody is on another floor, on average.
    #[serde(default = "Passage::seconds")]
    pub seconds: f32,
}

impl Passage {
    /// A third of the time that stairs take.
    fn seconds() -> f32 {
        5.0
    }
}

/// A room of a floor.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub struct Room {
    /// What it is called.
    pub name: String,
    /// Its floor, counted from 0.
    #[serde(default)]
    pub floor: u8,
    /// Its corners on the map, in metres.
    pub corners: Vec<[f32; 2]>,
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

/// What is wrong, and where.
struct Fault {
    /// The names of tables and the field, or numbers in arrays, with points between them.
    path: String,
    what: String,
}

impl Fault {
    fn new(path: String, what: String) -> Self {
        Self { path, what }
    }

    /// Of a table.
    fn of(table: &str, error: anyhow::Error) -> Self {
        match error.downcast_ref::<Wrong>() {
            Some(Wrong { field, what }) => Self::new(
                format!("{table}.{field}"),
                format!("{table}: {field} {what}"),
            ),
            None => Self::new(table.to_owned(), format!("{table}: {error:#}")),
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
            let at = error
                .span()
                .map(|span| place::line_and_column(text, span.start));
            (at, error.message().to_owned())
        })?;
        settings.check().map_err(|Fault { path, what }| {
            let at = place::find(text, &path).map(|start| place::line_and_column(text, start));
            (at, what)
        })?;
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

    /// Fails if a value cannot be.
    fn check(&self) -> Result<(), Fault> {
        let named = |table: &str, number: usize, name: &str, wrong: Wrong| {
            let Wrong { field, what } = wrong;
            let path = format!("{table}.{number}.{field}");
            let field = if field.is_empty() {
                ""
            } else {
                &format!("{field} ")
            };
            Fault::new(path, format!("{table} {name}: {field}{what}"))
        };
        for (number, input) in self.input.iter().enumerate() {
            let site = (input.site.as_ref()).filter(|of| {
                let is_it = |site: &Site| site.name == **of;
                !self.site.iter().any(is_it)
            });
            let known = match site {
                None => Ok(()),
                Some(of) => {
                    let what = format!("is {}, but no [[site]] has that name", &**of);
                    Err(Wrong::new("site", what))
                }
            };
            (input.source().and(known))
                .map_err(|wrong| named("input", number, &input.name, wrong))?;
        }
        for (number, output) in self.output.iter().enumerate() {
            (output.sink()).map_err(|wrong| named("output", number, &output.name, wrong))?;
        }
        for (table, names) in [
            (
                "input",
                self.input.iter().map(|one| &one.name).collect::<Vec<_>>(),
            ),
            ("output", self.output.iter().map(|one| &one.name).collect()),
            ("site", self.site.iter().map(|one| &one.name).collect()),
        ] {
            let again = |(number, name): &(usize, &&Name)| names[..*number].contains(*name);
            if let Some((number, name)) = names.iter().enumerate().find(again) {
                let what = format!("two {table}s are called {}", &***name);
                return Err(Fault::new(format!("{table}.{number}.name"), what));
            }
        }
        if let Some(log) = &self.log {
            for (field, value) in [("megabytes", log.megabytes), ("files", log.files)] {
                if value == 0 {
                    let what = format!("log: {field} must be at least 1");
                    return Err(Fault::new(format!("log.{field}"), what));
                }
            }
        }
        address("listen", &self.web.listen).map_err(|wrong| Fault::of("web", wrong.into()))?;
        let config = self.reading.config(()).map(drop);
        config.map_err(|error| Fault::of("reading", error))?;
        let errors = self.errors.check(self.locator);
        errors.map_err(|error| Fault::of("errors", error))
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

    /// The line and what is said of wrong settings.
    fn wrong(text: &str) -> (Option<usize>, String) {
        let (at, what) = Settings::parse(text).unwrap_err();
        (at.map(|(line, _)| line), what)
    }

    #[test]
    fn a_value_that_cannot_be_is_named_with_its_line() {
        for (text, line, what) in [
            (
                "[errors]\n\noutliers = 1.5\n",
                3,
                "errors: outliers must be from 0.001 to 0.9",
            ),
            (
                "[reading]\nseed = 1\nminimum-quality = 101.0",
                3,
                "reading: minimum-quality must be from 0 to 100",
            ),
            (
                "[reading]\nfinder = \"kraken\"\nbest-sigma = 3.0",
                3,
                "reading: best-sigma is of no use with sigmas by tables",
            ),
            (
                "locator = \"plain\"\n[errors]\nrange = 9.0",
                3,
                "errors: range is of no use to the locator plain",
            ),
            ("[errors]\nrange = -9.0", 2, "errors: range must be from"),
            (
                "errors.outliers = 0.6\nerrors.mirrored = 0.5",
                1,
                "errors: outliers and mirrored are too many",
            ),
            (
                "[web]\nlisten = \"8073\"",
                2,
                "web: listen needs a host and a port",
            ),
            (
                "[log]\nfile = \"a\"\nfiles = 0",
                3,
                "log: files must be at least 1",
            ),
            (
                "[[input]]\nname = \"a\"\nstdin = true\n[[input]]\nname = \"b\"\nudp = \"127.0.0.1\"",
                6,
                "input b: udp needs a host and a port: 127.0.0.1 has no port",
            ),
            (
                "[[input]]\nname = \"a\"\nstdin = true\nsite = \"t\"",
                4,
                "input a: site is t, but no [[site]]",
            ),
            (
                "[[input]]\nhttp = \"http://\"",
                2,
                "input vehicle: http is no address",
            ),
            (
                "[[output]]\nname = \"o\"\ntcp = \"localhost\"",
                3,
                "output o: tcp needs a host and a port",
            ),
            (
                "[[output]]\nname = \"o\"\n[output.mqtt]\nbroker = \"localhost:x\"",
                4,
                "output o: mqtt.broker needs",
            ),
            (
                "[[output]]\nform = \"cot\"\nmqtt = { broker = \"b\" }",
                2,
                "output vehicle: form must be geojson",
            ),
        ] {
            let (at, said) = wrong(text);
            assert_eq!(at, Some(line), "{text}: {said}");
            assert!(said.starts_with(what), "{said}");
        }
    }

    #[test]
    fn what_is_wrong_is_said_with_its_line() {
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
        let (line, what) = wrong(&twice);
        assert!(line == Some(5) && what.contains("two inputs"), "{what}");
        assert!(wrong("name = \"a/b\"").1.contains("letters"));
    }
}
