//! What a gateway and a locator are told, on the command line and in a settings file.

mod library;

use anyhow::{Context, Result, bail, ensure};
use clap::ValueEnum;
use clap::builder::{PossibleValuesParser, TypedValueParser};
use foxhunt::{
    aoa::{
        Mixture,
        robust::{self, Correlation, Errors},
    },
    gateway::{
        self, BearingReference, SigmaTable,
        formats::{self, Finder, Sense as Turn, kraken, ublox},
    },
};
use serde::{Deserialize, Serialize};

use crate::wrong::Wrong;

/// What takes the bearings.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum, Serialize, Deserialize, Default)]
#[serde(rename_all = "kebab-case")]
pub enum Kind {
    /// One source, and every bearing is right but for its error: the firmware `vehicle`.
    Plain,
    /// Several sources; bearings may be outliers, mirrored, biased: the firmware `vehicle_robust`.
    #[default]
    Robust,
    /// One source that stays where it is, with such bearings.
    Single,
    /// One source that may move, with such bearings.
    Moving,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
enum Reference {
    /// From the bow: the heading is added.
    Relative,
    TrueNorth,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
enum Sense {
    /// Of a KrakenSDR by its spectra; clockwise of others.
    Recognised,
    Clockwise,
    CounterClockwise,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
enum Confidence {
    /// Up to 1 a fraction, decibels above.
    Recognised,
    Decibels,
    Fraction,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
enum Heading {
    /// By the label, and by whether the KrakenSDR moves.
    Recognised,
    /// By GPS only while the KrakenSDR moves.
    Vehicle,
    /// As stated, always.
    Station,
    /// The compass's, always.
    Compass,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
enum Sigmas {
    /// What the firmware takes: of each device what its format has by default.
    Firmware,
    /// From --worst-sigma to --best-sigma.
    Linear,
    /// What is known of each device, also of an Agrelo and a u-blox board.
    Devices,
}

/// How lines are read.
#[derive(Debug, Clone, PartialEq, clap::Args, Serialize, Deserialize)]
#[command(next_help_heading = "How lines are read")]
#[serde(default, deny_unknown_fields, rename_all = "kebab-case")]
pub struct Reading {
    /// The only direction finder that is heard: lines of others are rejected. Unless given, every one is heard.
    #[arg(long, value_parser = finders())]
    #[serde(with = "named", skip_serializing_if = "Option::is_none")]
    finder: Option<Finder>,
    /// What the angles count from.
    #[arg(long, value_enum, default_value_t = Reference::Relative)]
    reference: Reference,
    /// Which way the angles of a KrakenSDR or a u-blox board grow.
    #[arg(long, value_enum, default_value_t = Sense::Recognised)]
    sense: Sense,
    /// What the confidence of a KrakenSDR is.
    #[arg(long, value_enum, default_value_t = Confidence::Recognised)]
    confidence: Confidence,
    /// Which heading of a KrakenSDR holds, and when.
    #[arg(long, value_enum, default_value_t = Heading::Recognised)]
    heading: Heading,
    /// The frequency of the source: lines of others from a KrakenSDR are rejected.
    #[arg(long, value_name = "HERTZ", allow_negative_numbers = true)]
    frequency: Option<u32>,
    /// The tag to look for, as a u-blox board names it: 12 hexadecimal digits.
    #[arg(long, value_name = "TAG", value_parser = tag)]
    #[serde(with = "hexadecimal", skip_serializing_if = "Option::is_none")]
    tag: Option<u64>,
    /// Bearings of a lower quality, 0 to 100, are rejected.
    #[arg(
        long,
        value_name = "QUALITY",
        default_value_t = 40.0,
        allow_negative_numbers = true
    )]
    minimum_quality: f32,
    /// How sigmas follow from the quality.
    #[arg(long, value_enum, default_value_t = Sigmas::Firmware)]
    sigmas: Sigmas,
    /// Standard deviation of a bearing of quality 100; unless given, 2. Only where sigmas are linear.
    #[arg(long, value_name = "DEGREES", allow_negative_numbers = true)]
    best_sigma: Option<f32>,
    /// Standard deviation of a bearing of quality 0; unless given, 10. Only where sigmas are linear.
    #[arg(long, value_name = "DEGREES", allow_negative_numbers = true)]
    worst_sigma: Option<f32>,
    /// How far apart in time a bearing and its position or heading may be.
    #[arg(
        long,
        value_name = "MILLISECONDS",
        default_value_t = 2_000,
        allow_negative_numbers = true
    )]
    maximum_age: u32,
    /// From this speed on the course over ground is the heading, where there is no compass.
    #[arg(
        long,
        value_name = "METRES PER SECOND",
        default_value_t = 1.5,
        allow_negative_numbers = true
    )]
    minimum_speed: f32,
    /// Positions that are further from the last, and the first one, wait for another that agrees; `inf` believes all.
    #[arg(
        long,
        value_name = "METRES PER SECOND",
        default_value_t = 100.0,
        allow_negative_numbers = true
    )]
    maximum_speed: f32,
    /// Variation of magnetic north, to the east, for compasses that state none, in place of what sentences state.
    #[arg(long, value_name = "DEGREES", allow_negative_numbers = true)]
    variation: Option<f32>,
    /// Positions that a simulator made or somebody entered are used, too.
    #[arg(long)]
    simulated: bool,
    /// Seeds the particles.
    #[arg(long, default_value_t = 1, allow_negative_numbers = true)]
    seed: u64,
}

impl Default for Reading {
    /// What holds where nothing is told on the command line.
    fn default() -> Self {
        #[derive(clap::Parser)]
        struct Nothing {
            #[command(flatten)]
            reading: Reading,
        }
        <Nothing as clap::Parser>::parse_from([""]).reading
    }
}

/// A direction finder by its name.
mod named {
    use foxhunt::gateway::formats::Finder;
    use serde::{Deserialize, Deserializer, Serialize, Serializer, de::Error};

    pub fn serialize<S: Serializer>(finder: &Option<Finder>, to: S) -> Result<S::Ok, S::Error> {
        finder.map(Finder::name).serialize(to)
    }

    pub fn deserialize<'de, D: Deserializer<'de>>(from: D) -> Result<Option<Finder>, D::Error> {
        let name = String::deserialize(from)?;
        let found = Finder::ALL.iter().find(|one| one.name() == name);
        let unknown = || D::Error::custom(format!("there is no direction finder {name}"));
        found.copied().map(Some).ok_or_else(unknown)
    }
}

/// A tag by its 12 digits.
mod hexadecimal {
    use serde::{Deserialize, Deserializer, Serialize, Serializer, de::Error};

    pub fn serialize<S: Serializer>(tag: &Option<u64>, to: S) -> Result<S::Ok, S::Error> {
        tag.map(|tag| format!("{tag:012X}")).serialize(to)
    }

    pub fn deserialize<'de, D: Deserializer<'de>>(from: D) -> Result<Option<u64>, D::Error> {
        let text = String::deserialize(from)?;
        super::tag(&text).map(Some).map_err(D::Error::custom)
    }
}

/// The direction finders that the library knows, by their names.
fn finders() -> impl TypedValueParser<Value = Finder> {
    let named = |name: String| Finder::ALL.iter().copied().find(|one| one.name() == name);
    PossibleValuesParser::new(Finder::ALL.iter().map(|finder| finder.name()))
        .map(move |name| named(name).expect("a possible value"))
}

fn tag(text: &str) -> Result<u64> {
    ensure!(text.len() == 12, "a tag has 12 digits");
    u64::from_str_radix(text, 16).context("a tag has hexadecimal digits")
}

impl Reading {
    /// Fails if anything is told that another setting makes idle.
    fn ensure_of_use(&self) -> Result<(), Wrong> {
        let heard = self
            .finder
            .as_ref()
            .map_or(Finder::ALL, std::slice::from_ref);
        let mut formats = self.formats();
        let none_linear = heard
            .iter()
            .all(|finder| formats.sigmas_mut(*finder).is_some());
        let only = |devices: &[Finder]| !heard.iter().any(|finder| devices.contains(finder));
        const TABLES: &str = "sigmas by tables: see sigmas";
        const NOT_KRAKEN: &str = "a finder other than kraken";
        for (field, given, idle, other) in [
            ("best-sigma", self.best_sigma.is_some(), none_linear, TABLES),
            (
                "worst-sigma",
                self.worst_sigma.is_some(),
                none_linear,
                TABLES,
            ),
            (
                "tag",
                self.tag.is_some(),
                only(&[Finder::Ublox]),
                "a finder other than ublox",
            ),
            (
                "frequency",
                self.frequency.is_some(),
                only(&[Finder::Kraken]),
                NOT_KRAKEN,
            ),
            (
                "confidence",
                self.confidence != Confidence::Recognised,
                only(&[Finder::Kraken]),
                NOT_KRAKEN,
            ),
            (
                "heading",
                self.heading != Heading::Recognised,
                only(&[Finder::Kraken]),
                NOT_KRAKEN,
            ),
            (
                "sense",
                self.sense == Sense::CounterClockwise,
                only(&[Finder::Kraken, Finder::Ublox]),
                "a finder other than kraken and ublox",
            ),
        ] {
            if given && idle {
                let what = format!("is of no use with {other}");
                return Err(Wrong::new(field, what));
            }
        }
        Ok(())
    }

    /// Seeds the particles.
    pub fn seed(&self) -> u64 {
        self.seed
    }

    /// The configuration of the gateway, with that of its locator.
    ///
    /// # Errors
    /// Names the field that is out of range, or of no use beside another.
    pub fn config<C>(&self, locator: C) -> Result<gateway::Config<C>> {
        self.ensure_of_use()?;
        let config = gateway::Config {
            formats: self.formats(),
            reference: match self.reference {
                Reference::Relative => BearingReference::Relative,
                Reference::TrueNorth => BearingReference::TrueNorth,
            },
            seed: self.seed,
            min_quality: self.minimum_quality,
            best_sigma_rad: self.best_sigma.unwrap_or(2.0).to_radians(),
            worst_sigma_rad: self.worst_sigma.unwrap_or(10.0).to_radians(),
            max_age_ms: self.maximum_age,
            min_speed_m_s: self.minimum_speed,
            max_speed_m_s: self.maximum_speed,
            variation_deg: self.variation,
            ..gateway::Config::new(locator)
        };
        config.check().map_err(library::named)?;
        Ok(config)
    }

    /// What the formats are told.
    fn formats(&self) -> formats::Config {
        let sense = match self.sense {
            Sense::Recognised => None,
            Sense::Clockwise => Some(Turn::Clockwise),
            Sense::CounterClockwise => Some(Turn::CounterClockwise),
        };
        let confidence = match self.confidence {
            Confidence::Recognised => None,
            Confidence::Decibels => Some(kraken::Confidence::Decibels),
            Confidence::Fraction => Some(kraken::Confidence::Fraction),
        };
        let heading = match self.heading {
            Heading::Recognised => kraken::Heading::Recognised,
            Heading::Vehicle => kraken::Heading::Vehicle,
            Heading::Station => kraken::Heading::Station,
            Heading::Compass => kraken::Heading::Compass,
        };
        let mut formats = formats::Config {
            finder: self.finder,
            simulated: self.simulated,
            ..formats::Config::DEFAULT
        };
        formats.kraken.sense = sense;
        formats.kraken.confidence = confidence;
        formats.kraken.heading = heading;
        formats.kraken.frequencies_hz = self.frequency.into_iter().collect::<Vec<_>>().leak();
        formats.ublox.sense = sense.unwrap_or(Turn::Clockwise);
        formats.ublox.tags = self.tag.into_iter().collect::<Vec<_>>().leak();
        match self.sigmas {
            Sigmas::Firmware => {}
            Sigmas::Linear => {
                for finder in Finder::ALL {
                    *formats.sigmas_mut(*finder) = None;
                }
            }
            Sigmas::Devices => {
                formats.agrelo.sigmas = Some(&SigmaTable::BEAM_WIDTHS);
                formats.ublox.sigmas = Some(&ublox::SIGMAS);
                formats.ublox.quality_by_azimuth = true;
            }
        }
        formats
    }
}

/// What is believed of the errors of bearings.
#[derive(Debug, Clone, Default, PartialEq, clap::Args, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields, rename_all = "kebab-case")]
#[command(next_help_heading = "The errors of bearings, of all locators but plain")]
pub struct Belief {
    /// Standard deviation of the common bias of all bearings, as of an array that is not mounted straight; unless
    /// given, 2.9 as in the firmware.
    #[arg(long, value_name = "DEGREES", allow_negative_numbers = true)]
    bias_sigma: Option<f32>,
    /// Standard deviation of the places where bearings are taken; unless given, 3 as in the firmware.
    #[arg(long, value_name = "METRES", allow_negative_numbers = true)]
    position_sigma: Option<f32>,
    /// Rate of mirrored bearings, before it is learned; unless given, 0.08.
    #[arg(long, value_name = "RATE", allow_negative_numbers = true)]
    mirrored: Option<f32>,
    /// Rate of outliers, before it is learned; unless given, 0.12.
    #[arg(long, value_name = "RATE", allow_negative_numbers = true)]
    outliers: Option<f32>,
    /// Metres over which the errors of neighbouring bearings become independent; unless given, 5.
    #[arg(long, value_name = "METRES", allow_negative_numbers = true)]
    correlation_distance: Option<f32>,
    /// The source is as likely nearer than this as farther away; unless given, 20000.
    #[arg(long, value_name = "METRES", allow_negative_numbers = true)]
    range: Option<f32>,
}

impl Belief {
    /// Fails if a field is out of range, or told to a locator that does not listen.
    ///
    /// # Errors
    /// Names the field.
    pub fn check(&self, kind: Kind) -> Result<()> {
        if kind != Kind::Plain {
            return self.config().map(drop);
        }
        for (field, given) in [
            ("bias-sigma", self.bias_sigma),
            ("position-sigma", self.position_sigma),
            ("mirrored", self.mirrored),
            ("outliers", self.outliers),
            ("correlation-distance", self.correlation_distance),
            ("range", self.range),
        ] {
            if given.is_some() {
                bail!(Wrong::new(field, "is of no use to the locator plain"));
            }
        }
        Ok(())
    }

    /// The configuration of the locator: that of the firmware, but for what is told.
    ///
    /// # Errors
    /// Names the field that is out of range.
    pub fn config(&self) -> Result<robust::Config> {
        let mut config = robust::Config::CITY;
        let Errors {
            rates,
            bias_sigma_rad,
            position_sigma_m,
            correlation: Correlation { distance_m, .. },
            ..
        } = &mut config.errors;
        if let Some(degrees) = self.bias_sigma {
            *bias_sigma_rad = degrees.to_radians();
        }
        if let Some(metres) = self.position_sigma {
            *position_sigma_m = metres;
        }
        *rates = Mixture::new(
            self.mirrored.unwrap_or(rates.mirrored),
            self.outliers.unwrap_or(rates.outlier),
        );
        if let Some(metres) = self.correlation_distance {
            *distance_m = metres;
        }
        if let Some(metres) = self.range {
            config.range_m = metres;
        }
        match config.check() {
            Ok(()) => Ok(config),
            Err(error) if error.field() == "direct" => {
                let what = format!("and mirrored are too many together: {error}");
                Err(Wrong::new("outliers", what).into())
            }
            Err(error) if ["range_m", "nearest_m"].contains(&error.field()) => {
                let least = config.nearest_m;
                let what = format!("must be from {least} m on, and finite: {error}");
                Err(Wrong::new("range", what).into())
            }
            Err(error) => Err(library::named(error)),
        }
    }
}
