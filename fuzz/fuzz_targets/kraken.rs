#![no_main]

libfuzzer_sys::fuzz_target!(|data: &[u8]| {
    let line = foxhunt_fuzz::begun("1795348800");
    foxhunt_fuzz::vehicle(foxhunt::gateway::Finder::Kraken, data, &line);
    foxhunt_fuzz::spectra(data, &line);
    foxhunt_fuzz::spectra(data, foxhunt_fuzz::kraken);
});
