//! What the browser calls: a C interface.
//!
//! Text and bytes go in and out through two buffers. The caller asks [`input`] for room, fills it, and calls a function, which
//! takes what is in it as its argument. The function returns how many bytes [`output`] has for it: JSON, of a state or of
//! `{"error": ..}`. One module holds one hunt, one log and one walk; who wants several makes several instances.

use std::sync::{Mutex, MutexGuard, PoisonError};

use serde::{Serialize, de::DeserializeOwned};

use crate::{Hunt, Log, Walkers};

struct Session {
    input: Vec<u8>,
    output: Vec<u8>,
    hunt: Option<Hunt>,
    log: Option<Log>,
    walkers: Option<Walkers>,
}

// The browser has one thread: the lock is free.
static SESSION: Mutex<Session> = Mutex::new(Session {
    input: Vec::new(),
    output: Vec::new(),
    hunt: None,
    log: None,
    walkers: None,
});

fn session() -> MutexGuard<'static, Session> {
    SESSION.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Makes room for so many bytes of input, and says where.
#[unsafe(no_mangle)]
pub extern "C" fn input(length: usize) -> *mut u8 {
    let mut session = session();
    session.input.clear();
    session.input.resize(length, 0);
    session.input.as_mut_ptr()
}

/// Where the output is.
#[unsafe(no_mangle)]
pub extern "C" fn output() -> *const u8 {
    session().output.as_ptr()
}

/// Starts a hunt with the options that are the input.
#[unsafe(no_mangle)]
pub extern "C" fn hunt_start() -> usize {
    session().answer(|session| {
        let hunt = Hunt::new(session.options()?)?;
        let state = json(&hunt.state());
        session.hunt = Some(hunt);
        state
    })
}

/// Goes to where so many bearings were taken.
#[unsafe(no_mangle)]
pub extern "C" fn hunt_seek(position: usize) -> usize {
    session().answer(|session| {
        let hunt = session.hunt.as_mut().ok_or("no hunt was started")?;
        hunt.seek(position);
        json(&hunt.state())
    })
}

/// Starts to read a log with the options that are the input.
#[unsafe(no_mangle)]
pub extern "C" fn log_start() -> usize {
    session().answer(|session| {
        session.log = Some(Log::new(session.options()?)?);
        Ok(Vec::new())
    })
}

/// Reads the bytes of the input.
#[unsafe(no_mangle)]
pub extern "C" fn log_push() -> usize {
    session().answer(|session| {
        let log = session.log.as_mut().ok_or("no log was started")?;
        log.push(&session.input);
        json(&log.state())
    })
}

/// Starts a walk with the options that are the input.
#[unsafe(no_mangle)]
pub extern "C" fn walkers_start() -> usize {
    session().answer(|session| {
        let walkers = Walkers::new(&session.options()?)?;
        let state = json(&walkers.state(0));
        session.walkers = Some(walkers);
        state
    })
}

/// Goes to a time.
#[unsafe(no_mangle)]
pub extern "C" fn walkers_seek(time_ms: u32) -> usize {
    session().answer(|session| {
        let walkers = session.walkers.as_mut().ok_or("no walk was started")?;
        walkers.seek(time_ms);
        json(&walkers.state(time_ms))
    })
}

impl Session {
    fn options<T: DeserializeOwned>(&self) -> Result<T, String> {
        serde_json::from_slice(&self.input).map_err(|error| error.to_string())
    }

    /// Makes an answer the output, and says how long it is.
    fn answer(&mut self, run: impl FnOnce(&mut Self) -> Result<Vec<u8>, String>) -> usize {
        let answer = run(self);
        self.output = answer.unwrap_or_else(|error| {
            let error = serde_json::json!({ "error": error });
            error.to_string().into_bytes()
        });
        self.output.len()
    }
}

fn json(state: &impl Serialize) -> Result<Vec<u8>, String> {
    serde_json::to_vec(state).map_err(|error| error.to_string())
}
