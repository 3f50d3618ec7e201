//! A gateway that goes on after a reset: it is kept in RAM that a reset leaves alone, after every bearing.
//!
//! `cargo xtask cost` measures what that takes (`snapshot.kept`): about an eighth of an update by a bearing. A core with a
//! data cache would have to write it back each time.

use core::cell::UnsafeCell;
use core::sync::atomic::{AtomicBool, Ordering};

use foxhunt::gateway::Event;
use foxhunt::snapshot::{Error, Keeper};
use foxhunt_gateways::kept::{CONFIG, Gateway as Vehicle};

type Buffers = [[u8; Keeper::<Vehicle>::BYTES]; 2];

struct Shared(UnsafeCell<Buffers>);

// SAFETY: `buffers` gives it away once.
unsafe impl Sync for Shared {}

// The startup code neither clears this section nor writes to it.
#[cfg_attr(target_os = "none", unsafe(link_section = ".uninit.kept"))]
static BUFFERS: Shared = Shared(UnsafeCell::new([[0; Keeper::<Vehicle>::BYTES]; 2]));
static TAKEN: AtomicBool = AtomicBool::new(false);

/// The buffers with what the last reset found there; `None` when they have been asked for before.
fn buffers() -> Option<[&'static mut [u8]; 2]> {
    if TAKEN.swap(true, Ordering::Relaxed) {
        return None;
    }
    let mut place = BUFFERS.0.get();
    // The compiler believes in the zeros above. To it, this may write anything.
    // SAFETY: it does nothing.
    unsafe { core::arch::asm!("/* {0} */", inout(reg) place) };
    // SAFETY: there is no other reference, and every byte is a valid `u8`.
    let [one, other] = unsafe { &mut *place };
    Some([one, other])
}

/// A vehicle's gateway that is restored with the first byte.
pub struct Gateway {
    vehicle: Vehicle,
    keeper: Option<Keeper<'static, Vehicle>>,
    is_awake: bool,
}

impl Gateway {
    pub const EMPTY: Self = Self {
        vehicle: Vehicle::EMPTY,
        keeper: None,
        is_awake: false,
    };

    pub fn push(&mut self, port: usize, byte: u8) -> Option<Event> {
        if !self.is_awake {
            self.wake();
        }
        let event = self.vehicle.push(port, byte, &CONFIG)?;
        if let Event::Fix(_) | Event::NotObservable(_) | Event::Restarted = event
            && let Some(keeper) = &mut self.keeper
        {
            // It has room.
            let _ = keeper.save(&self.vehicle);
            // All of it is in the RAM before the next byte is read.
            #[cfg(target_os = "none")]
            cortex_m::asm::dsb();
        }
        Some(event)
    }

    pub fn report(&self) -> &str {
        self.vehicle.report()
    }

    fn wake(&mut self) {
        self.is_awake = true;
        let Some(buffers) = buffers() else { return };
        let keeper = self.keeper.insert(Keeper::new(buffers));
        tell(keeper.restore(&mut self.vehicle));
    }
}

/// Logs whether there was anything to go on with.
fn tell(restored: Result<u32, Error>) {
    #[cfg(target_os = "none")]
    match restored {
        Ok(number) => defmt::info!("goes on with snapshot {}", number),
        Err(reason) => defmt::info!("begins anew: {}", reason),
    }
    #[cfg(not(target_os = "none"))]
    let _ = restored;
}
