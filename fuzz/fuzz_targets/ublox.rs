#![no_main]

libfuzzer_sys::fuzz_target!(|data: &[u8]| {
    let line = foxhunt_fuzz::begun("+UUDF:");
    foxhunt_fuzz::vehicle(foxhunt::gateway::Finder::Ublox, data, line);
});
