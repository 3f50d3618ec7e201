//! Results as lines or datagrams.

use super::{chasemapper, cot, feature, nmea};
use crate::{live::hub::Out, settings::Form};

/// Writes results in a form.
#[derive(Debug, Clone)]
pub struct Formatter {
    form: Form,
    name: String,
    run: u64,
}

impl Formatter {
    /// In a form, by a vehicle of a name, in a run that a number tells from others.
    pub fn new(form: Form, name: &str, run: u64) -> Self {
        Self {
            form,
            name: name.to_owned(),
            run,
        }
    }

    /// What a result is in this form: lines without their ends, or none.
    pub fn lines(&self, out: &Out, seq: u64) -> Vec<String> {
        match (self.form, out) {
            (Form::Nmea, Out::Report(report)) => report.lines().map(str::to_owned).collect(),
            (_, Out::Report(_)) => Vec::new(),
            (Form::Nmea, Out::Message(message)) => nmea::waypoints(message),
            (Form::Geojson, Out::Message(message)) => {
                let features = feature::features(message, &self.name, self.run, seq);
                features
                    .into_iter()
                    .map(|(_, json)| json.to_string())
                    .collect()
            }
            (Form::Chasemapper, Out::Message(message)) => {
                chasemapper::messages(message, &self.name)
            }
            (Form::Cot, Out::Message(message)) => cot::events(message, &self.name),
        }
    }

    /// What ends a line.
    pub fn end(&self) -> &'static str {
        match self.form {
            Form::Nmea => "\r\n",
            _ => "\n",
        }
    }
}
