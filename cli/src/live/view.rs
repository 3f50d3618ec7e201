//! What a page needs to be told when it is opened.

use std::collections::{BTreeMap, VecDeque};

use crate::engine::message::{
    Answer, Bearing, By, Health, Mark, Message, Receiver, Refused, Site, Tag,
};

/// Bearings that are told.
const BEARINGS: usize = 2_000;

/// Refusals that are told.
const REFUSED: usize = 20;

/// All that is known.
#[derive(Debug, Default)]
pub struct View {
    receivers: BTreeMap<String, Receiver>,
    bearings: BTreeMap<u64, (Bearing, Option<By>)>,
    answer: Option<Answer>,
    sites: BTreeMap<String, Site>,
    tags: BTreeMap<(String, u32), Tag>,
    health: Option<Health>,
    marks: BTreeMap<u64, Mark>,
    refused: VecDeque<Refused>,
}

impl View {
    /// Takes a message.
    pub fn take(&mut self, message: &Message) {
        match message {
            Message::Receiver(one) => {
                self.receivers.insert(one.name.clone(), one.clone());
            }
            Message::Bearing(one) => {
                self.bearings.insert(one.id, (one.clone(), None));
                if self.bearings.len() > BEARINGS {
                    self.bearings.pop_first();
                }
            }
            Message::Retracted { id, by } => self.retract(*id, Some(*by)),
            Message::Restored { id } => self.retract(*id, None),
            Message::Answer(one) => self.answer = Some(one.clone()),
            Message::Tag(one) => {
                let key = (one.site.clone(), one.id);
                self.tags.insert(key, one.clone());
            }
            Message::Site(one) => {
                self.sites.insert(one.name.clone(), one.clone());
            }
            Message::Health(one) => self.health = Some(one.clone()),
            Message::Mark(one) if one.removed == Some(true) => {
                self.marks.remove(&one.id);
            }
            Message::Mark(one) => {
                self.marks.insert(one.id, one.clone());
            }
            Message::Refused(one) => {
                self.refused.push_back(one.clone());
                if self.refused.len() > REFUSED {
                    self.refused.pop_front();
                }
            }
            Message::Outliers { changed } => {
                for (id, outlier) in changed {
                    if let Some((bearing, _)) = self.bearings.get_mut(id) {
                        bearing.outlier = Some(*outlier);
                    }
                }
            }
        }
    }

    fn retract(&mut self, id: u64, by: Option<By>) {
        if let Some((_, retracted)) = self.bearings.get_mut(&id) {
            *retracted = by;
        }
    }

    /// Messages that lead to the same.
    pub fn messages(&self) -> Vec<Message> {
        let mut messages = Vec::new();
        messages.extend(self.sites.values().cloned().map(Message::Site));
        messages.extend(self.receivers.values().cloned().map(Message::Receiver));
        for (bearing, retracted) in self.bearings.values() {
            messages.push(Message::Bearing(bearing.clone()));
            let id = bearing.id;
            messages.extend(retracted.map(|by| Message::Retracted { id, by }));
        }
        messages.extend(self.answer.iter().cloned().map(Message::Answer));
        messages.extend(self.tags.values().cloned().map(Message::Tag));
        messages.extend(self.marks.values().cloned().map(Message::Mark));
        messages.extend(self.refused.iter().cloned().map(Message::Refused));
        messages.extend(self.health.iter().cloned().map(Message::Health));
        messages
    }
}
