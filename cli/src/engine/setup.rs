//! What a search is told.

use crate::{
    reading::{Belief, Kind, Reading},
    settings::{self, Input, Settings},
};

/// What a search is told.
#[derive(Debug, Clone, Default)]
pub struct Setup {
    /// What this vehicle or station is called.
    pub name: String,
    /// What takes the bearings.
    pub locator: Kind,
    /// How lines are read.
    pub reading: Reading,
    /// What is believed of errors.
    pub belief: Belief,
    /// What comes in, by name, and the place whose tags it tells of, if it does.
    pub inputs: Vec<(String, Option<String>)>,
    /// Places with radio maps.
    pub sites: Vec<settings::Site>,
}

impl From<&Settings> for Setup {
    fn from(settings: &Settings) -> Self {
        let input = |input: &Input| {
            let site = input.site.as_ref().map(|site| site.to_string());
            (input.name.to_string(), site)
        };
        Self {
            name: settings.name.to_string(),
            locator: settings.locator,
            reading: settings.reading.clone(),
            belief: settings.errors.clone(),
            inputs: settings.input.iter().map(input).collect(),
            sites: settings.site.clone(),
        }
    }
}
