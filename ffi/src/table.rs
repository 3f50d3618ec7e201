//! The sizes of all types, for the header: cbindgen cannot know them.

use crate::beacon::{FoxhuntBeacon, FoxhuntBeaconConfig, FoxhuntBeaconEvent};
use crate::clean::{FoxhuntClean, FoxhuntCleanConfig};
use crate::result::FoxhuntText;
use crate::robust::{FoxhuntRobust, FoxhuntRobustConfig};
use crate::several::{FoxhuntSeveral, FoxhuntSeveralConfig};
use crate::tracker::{
    FoxhuntSite, FoxhuntTagFix, FoxhuntTracker, FoxhuntTrackerConfig, FoxhuntWorkspace,
};
use crate::vehicle::{
    FoxhuntEvent, FoxhuntLineConfig, FoxhuntPlace, FoxhuntRobustVehicle,
    FoxhuntRobustVehicleConfig, FoxhuntVehicle, FoxhuntVehicleConfig,
};
use crate::words::{
    FoxhuntAnswer, FoxhuntEllipse, FoxhuntFix, FoxhuntGenerator, FoxhuntHypothesis,
    FoxhuntObservation, FoxhuntSource, FoxhuntSymmetric2,
};

/// A type, for the program that writes the header.
#[repr(C)]
pub struct Entry {
    /// Its name, filled up with zeros.
    name: [u8; 40],
    /// Its size in bytes.
    size: u32,
    /// Its alignment in bytes.
    align: u32,
    /// Whether C knows its size alone.
    is_opaque: u32,
}

const fn entry<T>(text: &str, is_opaque: bool) -> Entry {
    let mut name = [0; 40];
    let bytes = text.as_bytes();
    let mut i = 0;
    while i < bytes.len() {
        name[i] = bytes[i];
        i += 1;
    }
    Entry {
        name,
        size: size_of::<T>() as u32,
        align: align_of::<T>() as u32,
        is_opaque: is_opaque as u32,
    }
}

macro_rules! table {
    (opaque: $($opaque:ident),+; plain: $($plain:ident),+ $(;)?) => {
        const COUNT: usize = [$(stringify!($opaque)),+].len() + [$(stringify!($plain)),+].len();

        /// Every type.
        #[unsafe(no_mangle)]
        static FOXHUNT_TYPES: [Entry; COUNT] = [
            $(entry::<$opaque>(stringify!($opaque), true),)+
            $(entry::<$plain>(stringify!($plain), false),)+
        ];
    };
}

table! {
    opaque: FoxhuntGenerator, FoxhuntClean, FoxhuntRobust, FoxhuntSeveral, FoxhuntVehicle, FoxhuntRobustVehicle, FoxhuntSite,
        FoxhuntTracker, FoxhuntWorkspace, FoxhuntBeacon;
    plain: FoxhuntText, FoxhuntObservation, FoxhuntSymmetric2, FoxhuntFix, FoxhuntAnswer, FoxhuntHypothesis, FoxhuntSource,
        FoxhuntEllipse, FoxhuntCleanConfig, FoxhuntRobustConfig, FoxhuntSeveralConfig, FoxhuntLineConfig,
        FoxhuntVehicleConfig, FoxhuntRobustVehicleConfig, FoxhuntEvent, FoxhuntPlace, FoxhuntTrackerConfig, FoxhuntTagFix,
        FoxhuntBeaconConfig, FoxhuntBeaconEvent;
}
