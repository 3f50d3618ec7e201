//! The firmware `vehicle` with NMEA and one format of a direction finder or receiver: what the format takes of the flash.
//! `cargo xtask cost` builds it with each.
//!
//! ```sh
//! FOXHUNT_FORMAT=3 cargo firmware one_format   # NMEA and KrakenSDR
//! ```

#![cfg_attr(target_os = "none", no_std, no_main)]

use foxhunt::aoa::spectrum::Spectrum;
use foxhunt::gateway::formats::{Agrelo, Aprs, Formats, Kn5r, Kraken, Nmea, Ublox, Ubx};
use foxhunt::gateway::{ShortReport, Vehicle};
use foxhunt_gateways::plain::{CONFIG, Locator};

/// The formats by their number.
trait Numbered {
    type Formats: Formats;
}

struct Number<const N: usize>;

macro_rules! formats {
    ($($number:literal: $formats:ty,)+) => {
        $(impl Numbered for Number<$number> {
            type Formats = $formats;
        })+
    };
}

formats! {
    0: (Nmea,),
    1: (Nmea, Ubx),
    2: (Nmea, Agrelo),
    3: (Nmea, Kraken),
    4: (Nmea, Kraken<Spectrum>),
    5: (Nmea, Ublox),
    6: (Nmea, Kn5r),
    7: (Nmea, Aprs),
}

const NUMBER: usize = match option_env!("FOXHUNT_FORMAT") {
    Some(digit) => (digit.as_bytes()[0] - b'0') as usize,
    None => 0,
};

type Gateway = Vehicle<Locator, <Number<NUMBER> as Numbered>::Formats, ShortReport, 3>;

foxhunt_emulated::firmware!(Gateway = Gateway::EMPTY, |gateway, port, byte| gateway
    .push(port, byte, &CONFIG));
