//! Whether the stated errors of a direction finder's bearings hold the truth.

use foxhunt_host::array::{Method, coverage};

#[test]
fn nine_of_ten_intervals_hold_the_truth_among_reflections() {
    for method in Method::ALL {
        for spectra in [false, true] {
            let found = coverage(method, spectra, 200, 77);
            assert!(found.any >= 0.9, "{} {spectra}: {found:?}", method.name());
            // Not by being wide.
            assert!(found.stated < 9.0, "{} {spectra}: {found:?}", method.name());
        }
    }
}
