#![no_main]

libfuzzer_sys::fuzz_target!(|data: &[u8]| foxhunt_fuzz::messages::check(data));
