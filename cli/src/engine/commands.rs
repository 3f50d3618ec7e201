//! Commands: bearings that are taken back, and marks.

use anyhow::{Context, Result, bail, ensure};
use foxhunt_decode::{Key, Refusal};

use super::message::{By, Mark, Message};
use super::piece::Command;
use super::search::{Engine, Happened, Say, Taken};

/// For so many milliseconds, a retract is what people mean by the last thing, even if bearings have come in since.
const FRESH_MS: i64 = 30_000;

/// The most bytes of the text of a mark, and the most marks.
const TEXT: usize = 500;
const MARKS: usize = 1_000;

impl Engine {
    pub(super) fn command(&mut self, command: &Command, time_ms: i64, say: Say) -> Result<()> {
        match command {
            Command::Retract(id) => {
                self.retract(*id, By::Page, say)?;
                self.retracts.done.push((time_ms, *id));
            }
            Command::Undo => self.undo(time_ms, say)?,
            Command::Mark {
                latitude,
                longitude,
                text,
            } => {
                ensure!(
                    (-90.0..=90.0).contains(latitude) && (-180.0..=180.0).contains(longitude),
                    "lat or lon is out of range"
                );
                ensure!(text.len() <= TEXT, "the text is longer than {TEXT} bytes");
                ensure!(self.marks.len() < MARKS, "there are {MARKS} marks");
                let mark = Mark {
                    id: self.next_mark,
                    lat: *latitude,
                    lon: *longitude,
                    text: text.clone(),
                    removed: None,
                };
                self.next_mark += 1;
                self.marks.insert(mark.id, mark.clone());
                say(Happened::Message(Message::Mark(mark)));
            }
            Command::Unmark(id) => {
                let mark = self.marks.remove(id);
                let mark = mark.with_context(|| format!("there is no mark {id}"))?;
                let removed = Some(true);
                say(Happened::Message(Message::Mark(Mark { removed, ..mark })));
            }
        }
        Ok(())
    }

    fn retract(&mut self, id: u64, by: By, say: Say) -> Result<()> {
        self.change(id, true)?;
        say(Happened::Message(Message::Retracted { id, by }));
        self.answer(say);
        Ok(())
    }

    /// Takes a bearing back, or takes it again.
    fn change(&mut self, id: u64, is_retracted: bool) -> Result<()> {
        let index = usize::try_from(id).ok().and_then(|id| id.checked_sub(1));
        let taken = index.and_then(|index| self.bearings.get_mut(index));
        let taken = taken.with_context(|| format!("there is no bearing {id}"))?;
        if taken.is_retracted == is_retracted {
            let what = if is_retracted { "already" } else { "not" };
            bail!("bearing {id} is {what} taken back");
        }
        ensure!(
            taken.search == self.search && self.hunt.bearings() > taken.index,
            "bearing {id} is of a search that is over"
        );
        ensure!(
            self.hunt.retract(taken.index, is_retracted),
            "bearing {id} cannot be taken back"
        );
        taken.is_retracted = is_retracted;
        Ok(())
    }

    fn undo(&mut self, time_ms: i64, say: Say) -> Result<()> {
        let is_last = |(then, id): &(i64, u64)| {
            time_ms - then <= FRESH_MS || self.bearings.len() as u64 == *id
        };
        if let Some((_, id)) = self.retracts.done.pop_if(|last| is_last(last)) {
            self.change(id, false)?;
            say(Happened::Message(Message::Restored { id }));
            self.answer(say);
            return Ok(());
        }
        let of_search = |taken: &Taken| taken.search == self.search && !taken.is_retracted;
        let last = self.bearings.iter().rposition(of_search);
        let last = last.context("there is no bearing to take back")?;
        self.retract(last as u64 + 1, By::Undo, say)
    }

    /// A station takes one of its bearings back.
    pub(super) fn delete(&mut self, key: &Key, say: Say) -> Result<(), Refusal> {
        const REFUSED: Refusal = Refusal::Field("id");
        let id = match &key.id {
            Some(_) => self.keys.get(key).copied(),
            // The last one of the station.
            None => {
                let of_station = self.keys.iter().filter(|(one, id)| {
                    let taken = self.bearings.get((**id - 1) as usize);
                    one.station == key.station && taken.is_some_and(|taken| !taken.is_retracted)
                });
                of_station.map(|(_, id)| *id).max()
            }
        };
        let id = id.ok_or(REFUSED)?;
        self.retract(id, By::Device, say).map_err(|_| REFUSED)
    }
}
