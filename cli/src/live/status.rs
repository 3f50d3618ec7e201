//! Whether inputs and outputs work.

use std::sync::{
    Mutex, PoisonError,
    atomic::{AtomicU64, Ordering::Relaxed},
};

use super::clock::now_ms;
use crate::engine::message::State;

/// How an input or output does.
#[derive(Debug)]
pub struct Status {
    /// What it is called.
    pub name: String,
    /// Milliseconds after which it is called silent; 0 for never.
    silent_ms: i64,
    /// Changes are not printed.
    is_quiet: bool,
    state: Mutex<(Option<State>, i64)>,
    /// When something came last, in milliseconds after 1970.
    heard_ms: AtomicU64,
    /// The last result that was read, for an output.
    pub read: AtomicU64,
    /// Results that wait.
    pub queued: AtomicU64,
    /// Results that were sent.
    pub sent: AtomicU64,
    /// Results that were not.
    pub lost: AtomicU64,
}

impl Status {
    /// One that has just been begun.
    pub fn new(name: &str, silent_s: u64) -> Self {
        Self {
            name: name.to_owned(),
            silent_ms: 1_000 * silent_s as i64,
            is_quiet: false,
            state: Mutex::new((None, now_ms())),
            heard_ms: AtomicU64::new(0),
            read: AtomicU64::new(0),
            queued: AtomicU64::new(0),
            sent: AtomicU64::new(0),
            lost: AtomicU64::new(0),
        }
    }

    /// One that prints nothing.
    pub fn quiet(name: &str) -> Self {
        Self {
            is_quiet: true,
            ..Self::new(name, 0)
        }
    }

    /// What it is, and since when.
    pub fn state(&self) -> (State, i64) {
        let (state, since) = *self.state.lock().unwrap_or_else(PoisonError::into_inner);
        (state.unwrap_or(State::Lost), since)
    }

    fn set(&self, new: State, why: &str) {
        let mut state = self.state.lock().unwrap_or_else(PoisonError::into_inner);
        if state.0 != Some(new) {
            *state = (Some(new), now_ms());
            if self.is_quiet {
                return;
            }
            let word = match new {
                State::Open => "open",
                State::Silent => "silent",
                State::Lost => "lost",
                State::Ended => "ended",
            };
            eprintln!("{}: {word}{why}", self.name);
        }
    }

    /// It is connected.
    pub fn opened(&self) {
        self.heard_ms.store(now_ms() as u64, Relaxed);
        self.set(State::Open, "");
    }

    /// It is not.
    pub fn lost(&self, why: impl std::fmt::Display) {
        self.set(State::Lost, &format!(": {why}"));
    }

    /// It has come to its end.
    pub fn ended(&self) {
        self.set(State::Ended, "");
    }

    /// Something has come.
    pub fn heard(&self) {
        self.heard_ms.store(now_ms() as u64, Relaxed);
        self.set(State::Open, "");
    }

    /// Looks whether it has fallen silent.
    pub fn check(&self) {
        let quiet = now_ms() - self.heard_ms.load(Relaxed) as i64;
        if self.silent_ms > 0 && self.state().0 == State::Open && quiet > self.silent_ms {
            self.set(State::Silent, &format!(" for {} s", quiet / 1_000));
        }
    }
}
