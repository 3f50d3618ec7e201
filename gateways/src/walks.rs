//! How people walk and radios hear in a tunnel: what the firmware of its gateway is built with, and its twin on the host.

use foxhunt::fingerprint::tracker::{Channel, Motion, Settings};

/// At any pace up to that of a bicycle, past few radios, whose packets are nearly independent.
pub const fn tunnel() -> Settings {
    let motion = Motion {
        velocity_m_s: 1.5,
        agility: 0.2,
        memory_s: f32::INFINITY,
    };
    let channel = Channel {
        mismatch_db: 2.0,
        tempering: 0.5,
        gate_deviations: f32::INFINITY,
        ..Channel::new()
    };
    match Settings::new().with_motion(motion) {
        Ok(settings) => match settings.with_channel(channel) {
            Ok(settings) => settings,
            Err(_) => panic!("a field of the channel is out of range"),
        },
        Err(_) => panic!("a field of the motion is out of range"),
    }
}
