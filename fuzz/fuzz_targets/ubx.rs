#![no_main]

libfuzzer_sys::fuzz_target!(|data: &[u8]| foxhunt_fuzz::vehicle(data, foxhunt_fuzz::ubx));
