//! Surveys and maps.

use std::fs;

use crate::program::{Folder, printed, run};

/// What is refused by one command is refused by all, for the same reason, and named.
#[test]
fn a_survey_of_which_no_map_can_be_made_is_refused() {
    let folder = Folder::new();
    const HEAD: &str = "x,y,beacon,rssi\n";
    folder.file("none.csv", "");
    folder.file("head.csv", HEAD);
    folder.file("one.csv", format!("{HEAD}1.0,2.0,3,-50\n1.0,2.0,4,-50\n"));
    folder.file(
        "floors.csv",
        "floor,x,y,beacon,rssi\n0,1,2,3,-50\n0,4,2,3,-60\n1,1,2,3,-70\n",
    );
    for (file, what) in [
        ("none.csv", "none.csv: it is empty"),
        ("head.csv", "head.csv: there is no row below the names"),
        ("one.csv", "one.csv: all readings are of one place"),
        (
            "floors.csv",
            "floors.csv: floor 1: all readings are of one place",
        ),
    ] {
        for command in [
            &["survey", "check", file][..],
            &["survey", "build", file, "-o", "x.map"],
            &["survey", "predict", file],
        ] {
            let output = run(&folder, command);
            let error = String::from_utf8_lossy(&output.stderr);
            assert!(!output.status.success(), "{command:?}");
            assert!(error.starts_with(&format!("error: {what}")), "{error}");
        }
    }
    // A place is heard by one reading.
    folder.file("two.csv", format!("{HEAD}1.0,2.0,3,-50\n3.0,2.0,3,-60\n"));
    assert_eq!(
        printed(&run(&folder, &["survey", "check", "two.csv"])),
        "floor 0: 2 places, 1 beacon, 2 readings\n  heard at fewer than 3 places: beacons [3]\n"
    );
    assert!(fs::metadata(folder.0.join("x.map")).is_err());
}
