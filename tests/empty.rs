//! Empty states are all zero bits, so that a `static` of them takes no flash.

use foxhunt::{
    aoa::{Clean, Locate, presets::City, spectrum::Spectrum},
    filter::ParticleFilter,
    fingerprint::{
        Posterior,
        tracker::{Tracker, Trackers, Workspace},
    },
    gateway::{
        FullReport, Vehicle,
        beacon::BeaconGateway,
        formats::{Agrelo, Kraken, Nmea},
    },
    proposal::{AuxiliaryFilter, PointMassFilter, UnscentedParticleFilter},
    refine::Memory,
    weights::Weights,
};

/// Whether a constant consists of bytes that are all zero.
fn is_zero<T>(state: &T) -> bool {
    let bytes = std::ptr::from_ref(state).cast::<u8>();
    // SAFETY: every byte is within the value. The states have no padding, or it is zero where it stands in a static.
    (0..size_of::<T>()).all(|i| unsafe { bytes.add(i).read() } == 0)
}

macro_rules! assert_zero {
    ($($state:expr => $type:ty),+ $(,)?) => {$({
        static STATE: $type = $state;
        assert!(is_zero(&STATE), stringify!($type));
    })+};
}

#[test]
fn empty_states_take_no_flash() {
    assert_zero! {
        ParticleFilter::EMPTY => ParticleFilter<2, 500>,
        Weights::EMPTY => Weights<300>,
        UnscentedParticleFilter::EMPTY => UnscentedParticleFilter<2, 10>,
        AuxiliaryFilter::EMPTY => AuxiliaryFilter<2, 10>,
        PointMassFilter::EMPTY => PointMassFilter<2, 10>,
        Memory::EMPTY => Memory<2, 100>,
        City::EMPTY => City<3>,
        Posterior::EMPTY => Posterior<80>,
        Workspace::EMPTY => Workspace<300, 80>,
        Tracker::EMPTY => Tracker<300>,
        Trackers::EMPTY => Trackers<8, 300>,
        BeaconGateway::EMPTY => BeaconGateway<8, 300, 80>,
        Vehicle::EMPTY => Vehicle<Clean<60, 16>>,
        Vehicle::EMPTY => Vehicle<Clean<60, 16>, (Nmea, Agrelo, Kraken<Spectrum>), FullReport, 3>,
    }
}
