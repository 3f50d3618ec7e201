#![no_main]

libfuzzer_sys::fuzz_target!(|data: &[u8]| {
    foxhunt_fuzz::vehicle(foxhunt::gateway::Finder::Any, data, foxhunt_fuzz::nmea);
});
