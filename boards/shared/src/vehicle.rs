//! The gateway of a vehicle as an application.

use foxhunt::aoa::Locate;
use foxhunt::gateway::{Config, Event, ReportForm, Vehicle, formats::Formats};

use foxhunt::snapshot::Persist;

use crate::{Application, kept::Stateful};

/// A vehicle's gateway and its configuration.
#[derive(Debug)]
pub struct Hunt<'a, L: Locate, F: Formats, R: ReportForm, const PORTS: usize> {
    gateway: &'a mut Vehicle<L, F, R, PORTS>,
    config: &'a Config<L::Config>,
}

impl<'a, L: Locate, F: Formats, R: ReportForm, const PORTS: usize> Hunt<'a, L, F, R, PORTS> {
    /// The gateway, by this configuration from now on.
    pub fn new(gateway: &'a mut Vehicle<L, F, R, PORTS>, config: &'a Config<L::Config>) -> Self {
        Self { gateway, config }
    }
}

impl<L: Locate, F: Formats, R: ReportForm, const PORTS: usize> Application
    for Hunt<'_, L, F, R, PORTS>
{
    fn push(&mut self, port: usize, byte: u8) -> bool {
        let event = self.gateway.push(port, byte, self.config);
        if let Some(event) = &event {
            log(event);
        }
        event.is_some()
    }

    fn report(&self) -> &str {
        self.gateway.report()
    }
}

impl<L: Locate + Persist, F: Formats, R: ReportForm, const PORTS: usize> Stateful
    for Hunt<'_, L, F, R, PORTS>
{
    type State = Vehicle<L, F, R, PORTS>;

    fn state(&mut self) -> &mut Self::State {
        self.gateway
    }
}

/// Lines that are not used are nothing to be told of: the status counts them.
fn log(event: &Event) {
    #[cfg(target_os = "none")]
    match event {
        Event::Rejected(reason) => defmt::debug!("rejected: {}", reason),
        event => defmt::info!("{}", event),
    }
    #[cfg(not(target_os = "none"))]
    let _ = event;
}
