#![no_main]

libfuzzer_sys::fuzz_target!(|data: &[u8]| {
    foxhunt_fuzz::spectra(data, |text| [text, b"\n"].concat());
    foxhunt_fuzz::spectra(data, foxhunt_fuzz::kraken);
});
