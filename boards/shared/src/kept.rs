//! An application that goes on after its board was without power.

use embedded_storage::nor_flash::NorFlash;
use foxhunt::snapshot::Persist;

use crate::{Application, slots::Slots};

/// An application whose state can be kept.
pub trait Stateful: Application {
    /// All that it knows.
    type State: Persist;

    /// What it knows now.
    fn state(&mut self) -> &mut Self::State;

    /// Its state is that of a snapshot now, which may be so many seconds old.
    fn resume(&mut self, _seconds: u32) {}
}

/// Keeps the state of an application in pages of flash, every so many ticks in which a message ended.
#[derive(Debug)]
pub struct Kept<'a, A, F> {
    /// What is kept.
    pub application: A,
    /// The pages.
    pub slots: Option<Slots<F>>,
    buffer: &'a mut [u8],
    interval: u32,
    ticks: u32,
    has_news: bool,
}

impl<'a, A: Stateful, F: NorFlash> Kept<'a, A, F> {
    /// Goes on with the newest snapshot, if there is one. Without slots, nothing is kept.
    pub fn new(
        mut application: A,
        mut slots: Option<Slots<F>>,
        buffer: &'a mut [u8],
        interval: u32,
    ) -> Self {
        if let Some(slots) = &mut slots {
            let restored = slots.restore(application.state(), buffer);
            if restored.is_ok() {
                application.resume(interval);
            }
            #[cfg(target_os = "none")]
            match restored {
                Ok(number) => defmt::info!("goes on with snapshot {}", number),
                Err(reason) => defmt::info!("begins anew: {}", reason),
            }
            #[cfg(not(target_os = "none"))]
            let _ = restored;
        }
        Self {
            application,
            slots,
            buffer,
            interval,
            ticks: 0,
            has_news: false,
        }
    }
}

impl<A: Stateful, F: NorFlash> Application for Kept<'_, A, F> {
    fn push(&mut self, port: usize, byte: u8) -> bool {
        let has_ended = self.application.push(port, byte);
        self.has_news |= has_ended;
        has_ended
    }

    fn report(&self) -> &str {
        self.application.report()
    }

    fn tick(&mut self) {
        self.application.tick();
        self.ticks = self.ticks.saturating_add(1);
        if self.ticks < self.interval || !self.has_news {
            return;
        }
        (self.ticks, self.has_news) = (0, false);
        if let Some(slots) = &mut self.slots {
            let saved = slots.save(self.application.state(), self.buffer);
            #[cfg(target_os = "none")]
            if let Err(reason) = saved {
                defmt::warn!("no snapshot was kept: {}", reason);
            }
            #[cfg(not(target_os = "none"))]
            let _ = saved;
        }
    }
}
