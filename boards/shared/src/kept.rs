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

#[cfg(test)]
mod tests {
    extern crate std;

    use foxhunt_gateways::board::{CONFIG, Gateway};

    use super::*;
    use crate::slots::tests::{Flash, PAGE};
    use crate::vehicle::Hunt;

    const DRIVE: &[u8] = include_bytes!("../../../examples/data/drive.nmea");
    const QUERY: &[u8] = b"$PFOXQ*50\r\n";
    const SNAPSHOT: usize = foxhunt::snapshot::largest::<Gateway>().next_multiple_of(4);
    const PAGES: usize = 200;
    const INTERVAL: u32 = 3;

    fn slots(flash: Flash) -> Option<Slots<Flash>> {
        Slots::new(flash, 0..(PAGES * PAGE) as u32, SNAPSHOT).ok()
    }

    /// Starts a board on a flash, gives it bytes and ticks, takes its power, and tells what it answered to the last query.
    fn live(flash: &mut Flash, bytes: &[u8], ticks: u32) -> std::string::String {
        let (mut gateway, mut buffer) = (std::boxed::Box::new(Gateway::EMPTY), [0; SNAPSHOT]);
        let hunt = Hunt::new(&mut *gateway, &CONFIG);
        let mut kept = Kept::new(hunt, slots(flash.clone()), &mut buffer, INTERVAL);
        for byte in bytes {
            kept.push(0, *byte);
        }
        for _ in 0..ticks {
            kept.tick();
        }
        let mut answer = std::string::String::new();
        for byte in QUERY {
            if kept.push(0, *byte) {
                answer.push_str(kept.report());
            }
        }
        *flash = kept.slots.unwrap().flash().clone();
        answer
    }

    #[test]
    fn what_was_known_is_known_again() {
        let mut flash = Flash::new(PAGES);
        let known = live(&mut flash, DRIVE, INTERVAL);
        assert!(known.starts_with("$PFOXF,"));
        let (fix, _status) = known.split_once('\n').unwrap();
        // Nothing new: nothing is written, and the next life goes on from the same.
        for _ in 0..2 {
            let again = live(&mut flash, b"", 10 * INTERVAL);
            assert_eq!(again.split_once('\n').unwrap().0, fix);
        }
        let mut state = Gateway::EMPTY;
        let number = slots(flash)
            .unwrap()
            .restore(&mut state, &mut [0; SNAPSHOT]);
        assert_eq!(number, Ok(1));
    }

    #[test]
    fn nothing_is_kept_before_its_time() {
        let mut flash = Flash::new(PAGES);
        live(&mut flash, DRIVE, INTERVAL - 1);
        assert!(live(&mut flash, b"", 0).starts_with("$PFOXN,,FEW"));
    }
}
