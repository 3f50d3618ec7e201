#![no_main]

libfuzzer_sys::fuzz_target!(|data: &[u8]| {
    let framing = foxhunt::gateway::beacon::Framing::Frames;
    foxhunt_fuzz::beacons(framing, data, foxhunt_fuzz::beacon_frame);
});
