//! The watchdog of the MPS2 boards (a CMSDK APB watchdog): it resets a firmware that hangs.

const BASE: usize = 0x4000_8000;
const LOAD: usize = 0x000;
const CONTROL: usize = 0x008;
const CLEAR: usize = 0x00C;
const LOCK: usize = 0xC00;

const UNLOCK: u32 = 0x1ACC_E551;
/// Counting, and a reset when it has expired twice.
const CONTROL_ALL: u32 = 0b11;
const CLOCK_HZ: u32 = 25_000_000;

/// A watchdog that runs.
pub struct Watchdog(());

impl Watchdog {
    /// Starts the watchdog: it must be fed at least every `seconds`, 171 at most.
    ///
    /// If it is not, it raises the non-maskable interrupt; after the same time again it resets the board.
    pub fn start(seconds: u32) -> Self {
        write(LOCK, UNLOCK);
        write(LOAD, CLOCK_HZ.saturating_mul(seconds));
        write(CONTROL, CONTROL_ALL);
        Self(())
    }

    /// Lets it count from the start.
    pub fn feed(&mut self) {
        write(CLEAR, 1);
    }
}

fn write(register: usize, value: u32) {
    // SAFETY: the watchdog is there on this board, and these registers may be written at any time.
    unsafe { ((BASE + register) as *mut u32).write_volatile(value) }
}
