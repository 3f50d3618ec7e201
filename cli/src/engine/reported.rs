//! Sentences of a board's reports.

use foxhunt_decode::Report;
use foxhunt_host::geodesy::Place;

use super::{
    message::Message,
    search::{Engine, Happened, Say},
    site::of_report,
    words,
};

impl Engine {
    /// Takes a sentence of a report, unless there are bearings of which this program knows more than the report tells.
    pub(super) fn reported(&mut self, port: usize, line: &[u8], report: Report, say: Say) {
        if self.search > 0 {
            return;
        }
        let (Some(name), Some(input)) = (
            self.ports.get(port).map(|port| port.name.clone()),
            self.inputs.get_mut(port),
        ) else {
            return;
        };
        input.reports += 1;
        say(Happened::Report(&format!(
            "{}\r\n",
            String::from_utf8_lossy(line)
        )));
        if let Some(tag) = of_report(&name, &None, &report, self.arrived_ms) {
            say(Happened::Message(Message::Tag(tag)));
            return;
        }
        let mut board = std::mem::take(&mut self.board);
        let answers = board.take(
            report,
            |time| self.dates.at(time),
            |course, metres| {
                let place = self.place?;
                let degrees = |e7: i32| f64::from(e7) / 1e7;
                let from = Place {
                    latitude: degrees(place.latitude_e7()),
                    longitude: degrees(place.longitude_e7()),
                };
                Some(words::way(from, course, metres))
            },
        );
        self.board = board;
        for answer in answers {
            say(Happened::Message(Message::Answer(answer)));
        }
    }
}
