//! Where results meet those who want them: pages, outputs, brokers.
//!
//! The last results are kept; everybody reads on from where they were, at their own pace. Who is too slow misses some, and is
//! told how many.

use std::{
    collections::VecDeque,
    sync::{Arc, Mutex, MutexGuard, PoisonError},
};

use tokio::sync::watch;

use super::view::View;
use crate::engine::message::Message;

/// Results that are kept.
const KEPT: usize = 20_000;

/// A result.
#[derive(Debug, Clone, PartialEq)]
pub enum Out {
    /// For pages and programs.
    Message(Box<Message>),
    /// Sentences, as the firmware sends them.
    Report(String),
}

/// A result with its number.
#[derive(Debug)]
pub struct Item {
    /// From 1 on.
    pub seq: u64,
    /// What it is.
    pub out: Out,
    /// The message as JSON; empty for a report.
    pub json: String,
}

/// See the module.
#[derive(Debug)]
pub struct Hub {
    state: Mutex<State>,
    changed: watch::Sender<u64>,
}

#[derive(Debug, Default)]
struct State {
    seq: u64,
    items: VecDeque<Arc<Item>>,
    view: View,
    /// There will be no more.
    is_over: bool,
}

impl State {
    /// Adds a result with its JSON.
    fn take(&mut self, out: Out, json: String) {
        self.seq += 1;
        if let Out::Message(message) = &out {
            self.view.take(message);
        }
        if self.items.len() == KEPT {
            self.items.pop_front();
        }
        let seq = self.seq;
        self.items.push_back(Arc::new(Item { seq, out, json }));
    }
}

impl Hub {
    /// A hub without results. Numbers go on from `seq`, so that pages that stayed open notice nothing of a restart.
    pub fn new(seq: u64) -> Self {
        let state = State {
            seq,
            ..State::default()
        };
        Self {
            state: Mutex::new(state),
            changed: watch::channel(seq).0,
        }
    }

    fn lock(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Adds results. Whoever reads, or asks for all that is known, meets all of them or none.
    pub fn add(&self, outs: impl IntoIterator<Item = Out>) {
        let items = outs.into_iter().map(|out| {
            let json = match &out {
                Out::Message(message) => serde_json::to_string(message).unwrap_or_default(),
                Out::Report(_) => String::new(),
            };
            (out, json)
        });
        let items: Vec<_> = items.collect();
        // Most lines come to nothing: nobody is woken for them.
        if items.is_empty() {
            return;
        }
        let seq = {
            let mut state = self.lock();
            for (out, json) in items {
                state.take(out, json);
            }
            state.seq
        };
        self.changed.send_replace(seq);
    }

    /// There will be no more results: who has read all of them is told so.
    pub fn end(&self) {
        self.lock().is_over = true;
        self.changed.send_modify(|_| {});
    }

    /// The number of the last result, and messages that say all that is known.
    pub fn state(&self) -> (u64, Vec<Message>) {
        let state = self.lock();
        (state.seq, state.view.messages())
    }

    /// The number of the last result.
    pub fn seq(&self) -> u64 {
        self.lock().seq
    }

    /// Reads from after a number on.
    pub fn reader(self: &Arc<Self>, after: u64) -> Reader {
        Reader {
            hub: self.clone(),
            changed: self.changed.subscribe(),
            after,
        }
    }
}

/// Somebody who reads results.
#[derive(Debug)]
pub struct Reader {
    hub: Arc<Hub>,
    changed: watch::Receiver<u64>,
    after: u64,
}

impl Reader {
    /// The next results, of which there is at least one, and how many were missed before them. `None` when there will be no
    /// more.
    pub async fn next(&mut self) -> Option<(Vec<Arc<Item>>, u64)> {
        /// The most at once.
        const MOST: usize = 1_000;
        loop {
            self.changed.borrow_and_update();
            {
                let state = self.hub.lock();
                if let Some(first) = state.items.front()
                    && state.seq > self.after
                {
                    let lost = first.seq.saturating_sub(self.after + 1);
                    let skip = (self.after + 1).saturating_sub(first.seq) as usize;
                    let items: Vec<_> = state.items.iter().skip(skip).take(MOST).cloned().collect();
                    if let Some(last) = items.last() {
                        self.after = last.seq;
                        return Some((items, lost));
                    }
                }
                if state.is_over {
                    return None;
                }
            }
            self.changed.changed().await.ok()?;
        }
    }

    /// The number of the last result that was read.
    pub fn after(&self) -> u64 {
        self.after
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[tokio::test]
    async fn nothing_wakes_nobody() {
        let hub = Arc::new(Hub::new(0));
        let reader = hub.reader(0);
        hub.add([]);
        assert!(!reader.changed.has_changed().unwrap());
        hub.add([Out::Report("one".to_owned()), Out::Report("two".to_owned())]);
        assert!(reader.changed.has_changed().unwrap());
        assert_eq!(hub.seq(), 2);
    }

    #[tokio::test]
    async fn who_is_too_slow_is_told() {
        let hub = Arc::new(Hub::new(5));
        let (mut slow, mut quick) = (hub.reader(5), hub.reader(5));
        for k in 0..KEPT + 10 {
            hub.add([Out::Report(k.to_string())]);
            if k == 0 {
                let (items, lost) = quick.next().await.unwrap();
                assert_eq!((items.len(), items[0].seq, lost), (1, 6, 0));
            }
        }
        let (items, lost) = slow.next().await.unwrap();
        assert_eq!((items[0].seq, lost), (16, 10));
        let mut read = items.len();
        while slow.after() < hub.seq() {
            read += slow.next().await.unwrap().0.len();
        }
        assert_eq!(read, KEPT);
        hub.end();
        assert!(slow.next().await.is_none());
    }
}
