//! A quick form of `cargo xtask damage`.

use foxhunt_host::damage::{Logs, Outcome};

/// Of two million sentences none was wrong with one seed: of a twentieth, one is for a correct program less
/// likely than one in a hundred.
#[test]
fn no_damaged_position_is_believed() {
    let Some(data) = std::env::var_os("FOXHUNT_DATA") else {
        println!(
            "no_damaged_position_is_believed skipped: FOXHUNT_DATA does not name the directory of the measured data"
        );
        return;
    };
    let logs = Logs::read(data.as_ref()).unwrap();
    let outcome = Outcome::of(&logs, 100_000, 5, true);
    assert!(outcome.sentences >= 100_000);
    assert_eq!(outcome.wrong, 0, "{outcome:?}");
    // Where nothing waits, more are believed; but hardly any position is lost by waiting.
    let at_once = Outcome::of(&logs, 100_000, 5, false);
    assert_eq!(at_once.waited, 0);
    assert_eq!(outcome.believed + outcome.waited, at_once.believed);
}
