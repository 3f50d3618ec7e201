//! defmt over semihosting. Unlike the crate of that purpose it has no panic path.

use core::cell::UnsafeCell;

use cortex_m::{interrupt, register::primask};
use cortex_m_semihosting::hio::{self, HostStream};
use defmt::Encoder;

struct State {
    encoder: Encoder,
    stream: Option<HostStream>,
    /// Whether interrupts were on before the message.
    interrupts: bool,
}

struct Shared(UnsafeCell<State>);

// SAFETY: used only between `acquire` and `release`, where interrupts are off, and the board has one core.
unsafe impl Sync for Shared {}

static STATE: Shared = Shared(UnsafeCell::new(State {
    encoder: Encoder::new(),
    stream: None,
    interrupts: false,
}));

#[defmt::global_logger]
struct Logger;

// SAFETY: `acquire` keeps everybody else out until `release`.
unsafe impl defmt::Logger for Logger {
    fn acquire() {
        let interrupts = primask::read().is_active();
        interrupt::disable();
        // SAFETY: interrupts are off. defmt itself does not acquire twice.
        let state = unsafe { &mut *STATE.0.get() };
        state.interrupts = interrupts;
        if state.stream.is_none() {
            state.stream = hio::hstderr().ok();
        }
        state
            .encoder
            .start_frame(|bytes| send(&mut state.stream, bytes));
    }

    unsafe fn flush() {}

    unsafe fn release() {
        // SAFETY: called after `acquire`, with interrupts off.
        let state = unsafe { &mut *STATE.0.get() };
        state
            .encoder
            .end_frame(|bytes| send(&mut state.stream, bytes));
        if state.interrupts {
            // SAFETY: `acquire` has switched them off; nobody around it relies on that.
            unsafe { interrupt::enable() };
        }
    }

    unsafe fn write(bytes: &[u8]) {
        // SAFETY: called after `acquire`, with interrupts off.
        let state = unsafe { &mut *STATE.0.get() };
        state
            .encoder
            .write(bytes, |bytes| send(&mut state.stream, bytes));
    }
}

/// Sends bytes; without a debugger they are dropped.
fn send(stream: &mut Option<HostStream>, bytes: &[u8]) {
    if let Some(stream) = stream {
        let _ = stream.write_all(bytes);
    }
}
