#![no_main]

libfuzzer_sys::fuzz_target!(|data: &[u8]| {
    let line = foxhunt_fuzz::begun("%");
    foxhunt_fuzz::vehicle(foxhunt::gateway::Finder::Agrelo, data, line);
});
