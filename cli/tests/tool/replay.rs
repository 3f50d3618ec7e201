//! Commands that read logs.

use std::fs;

use serde_json::Value;

use crate::program::{Folder, drive, printed, run};

#[test]
fn several_logs_are_merged_by_time() {
    let folder = Folder::new();
    let log = fs::read_to_string(drive()).unwrap();
    let (receiver, finder): (Vec<&str>, Vec<&str>) = log
        .split_inclusive('\n')
        .partition(|line| line.starts_with('$'));
    folder.file("receiver.nmea", receiver.concat());
    folder.file("kraken.csv", finder.concat());
    let both = run(
        &folder,
        &["replay", "kraken.csv", "receiver.nmea", "--json"],
    );
    let both: Value = serde_json::from_str(&printed(&both)).unwrap();
    let one = run(&folder, &["replay", drive().to_str().unwrap(), "--json"]);
    let one: Value = serde_json::from_str(&printed(&one)).unwrap();
    assert_eq!(one["bearings"], 55);
    assert!(both["bearings"].as_u64().unwrap() >= 54, "{both}");
    let place = |of: &Value| of["fixes"][0]["latitude"].as_f64().unwrap();
    assert!((place(&one) - place(&both)).abs() < 5e-4);
}

#[test]
fn exit_codes_say_what_happened() {
    let folder = Folder::new();
    folder.file("nothing.log", "nothing\n");
    for (arguments, code) in [
        (&["replay", "nothing.log"][..], 3),
        (&["explain", "nothing.log"], 3),
        (&["replay", "no-such.log"], 1),
        (&["replay"], 2),
        (&["replay", "nothing.log", "--locator", "none"], 2),
        (&["live", "--check", "no-such.toml"], 1),
        (&["init"], 0),
        (&["init"], 1),
        (&["live", "--check", "foxhunt.toml"], 0),
    ] {
        let output = run(&folder, arguments);
        let error = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(code), "{arguments:?}: {error}");
    }
}

#[test]
fn a_wrong_setting_is_named_with_its_line() {
    let folder = Folder::new();
    folder.file(
        "wrong.toml",
        "name = \"a\"\n[[input]]\nname = \"b\"\nsreial = \"x\"\n",
    );
    let output = run(&folder, &["live", "--check", "wrong.toml"]);
    let error = String::from_utf8_lossy(&output.stderr);
    assert!(
        error.contains("wrong.toml:4:") && error.contains("sreial"),
        "{error}"
    );
}

#[test]
fn a_log_tells_its_story() {
    let folder = Folder::new();
    let log = fs::read_to_string(drive()).unwrap();
    // The receiver's checksums are wrong from the third line on.
    folder.file("damaged.nmea", log.replace("RMC,0930", "RMC,0830"));
    let output = run(&folder, &["explain", "damaged.nmea"]);
    let text = printed(&output);
    assert!(
        text.contains("refused: checksum is wrong or missing"),
        "{text}"
    );
    assert!(text.contains("\n  damaged.nmea:2, 4, "), "{text}");
    assert!(text.contains("\n  first: $GPRMC"), "{text}");
    assert!(text.contains("a fix, within"), "{text}");
    let output = run(&folder, &["explain", drive().to_str().unwrap(), "--json"]);
    let story: Value = serde_json::from_str(&printed(&output)).unwrap();
    assert!(story["events"].as_array().unwrap().len() >= 2, "{story}");
}

#[test]
fn configurations_are_compared() {
    let folder = Folder::new();
    let drive = drive();
    let output = run(
        &folder,
        &[
            "compare",
            drive.to_str().unwrap(),
            "--json",
            "--with",
            "--locator single",
            "--with",
            "--locator plain",
        ],
    );
    let rows: Value = serde_json::from_str(&printed(&output)).unwrap();
    for row in rows.as_array().unwrap() {
        assert_eq!(row["sources"], 1);
        assert!(row["error_m"].as_f64().unwrap() < 100.0, "{row}");
        assert!(folder.0.join(row["picture"].as_str().unwrap()).is_file());
    }
}

#[test]
fn simulated_logs_are_replayed() {
    let folder = Folder::new();
    printed(&run(
        &folder,
        &["simulate", "two-sources", "-o", "two.nmea"],
    ));
    let output = run(&folder, &["replay", "two.nmea", "--json"]);
    let replayed: Value = serde_json::from_str(&printed(&output)).unwrap();
    assert_eq!(replayed["fixes"].as_array().unwrap().len(), 2);
    printed(&run(
        &folder,
        &["simulate", "tunnel", "-o", "tunnel.packets"],
    ));
    assert!(folder.0.join("tunnel.map").is_file());
}

/// A drive, a tunnel and a building, as files tell.
#[test]
fn scenarios_are_simulated_and_compared() {
    const DRIVE: &str = "seed = 1\ninterval_s = 3.0\nsigma_rad = 0.05\noutlier_rate = 0.1\nmirrored_rate = 0.0\n\
        bias_rad = 0.0\n[vehicle]\ncorners = [[0.0, 0.0], [1500.0, 0.0], [1500.0, 1500.0]]\nspeed_m_s = 12.0\n\
        start_s = 0.0\n[[sources]]\ncorners = [[900.0, 1000.0]]\nspeed_m_s = 1.0\nstart_s = 0.0\n";
    let folder = Folder::new();
    folder.file("drive.toml", DRIVE);
    let output = run(&folder, &["compare", "drive.toml", "--json"]);
    let rows: Value = serde_json::from_str(&printed(&output)).unwrap();
    let robust = &rows[3];
    assert_eq!(robust["options"], "--locator robust");
    // Within three times the ellipse of 95 %, as all but one of many millions are.
    let (error, semi) = (robust["error_m"].as_f64(), robust["semi_major_m"].as_f64());
    assert!(error.unwrap() < 3.0 * semi.unwrap(), "{robust}");
    let other = ["compare", "drive.toml", "--scenario-seed", "2", "--json"];
    let others: Value = serde_json::from_str(&printed(&run(&folder, &other))).unwrap();
    assert_ne!(others[3]["error_m"], robust["error_m"]);

    folder.file(
        "tunnel.toml",
        "[tunnel]\nseed = 1\n[[tunnel.people]]\ntag = 7\n\
         way = { corners = [[2.0, 1.2], [74.0, 1.2]], speed_m_s = 1.2, start_s = 0.0 }\n",
    );
    printed(&run(
        &folder,
        &["simulate", "tunnel.toml", "-o", "tunnel.packets"],
    ));
    let packets = fs::read_to_string(folder.0.join("tunnel.packets")).unwrap();
    assert!(packets.contains("$PFOXB,") && packets.contains("$PFOXG,0,7,2.000,1.200"));
    assert!(folder.0.join("tunnel.map").is_file());

    folder.file(
        "building.toml",
        "[building]\nseed = 1\npeople = 2\nseconds = 60.0\n",
    );
    printed(&run(
        &folder,
        &["simulate", "building.toml", "-o", "building.packets"],
    ));
    let check = printed(&run(
        &folder,
        &["survey", "check", "building.csv", "--json"],
    ));
    assert_eq!(check.lines().count(), 3, "{check}");

    folder.file(
        "wrong.toml",
        "[building]\nseed = 1\npeople = 2\nsecond = 60.0\n",
    );
    let wrong = run(&folder, &["simulate", "wrong.toml", "-o", "x"]);
    let error = String::from_utf8_lossy(&wrong.stderr).into_owned();
    assert!(
        !wrong.status.success() && error.contains("wrong.toml:4:"),
        "{error}"
    );
}

#[test]
fn lines_that_were_not_used_are_told_with_their_numbers() {
    let folder = Folder::new();
    let log = fs::read_to_string(drive()).unwrap();
    let count = log.lines().count();
    folder.file("a.nmea", format!("{log}{}", "rubbish\n".repeat(7)));
    let text = printed(&run(&folder, &["replay", "a.nmea"]));
    let places: Vec<String> = (1..=5).map(|k| (count + k).to_string()).collect();
    let said = format!(
        "rejected: line cannot be parsed: a.nmea:{} and 2 more\n",
        places.join(", ")
    );
    assert!(text.contains(&said), "{text}");
    let json = printed(&run(&folder, &["replay", "a.nmea", "--json"]));
    let json: Value = serde_json::from_str(&json).unwrap();
    let refused = &json["rejected"][0];
    assert_eq!(
        (&refused["count"], &refused["line"]),
        (&7.into(), &"rubbish".into())
    );
}

#[test]
fn packets_of_tags_are_for_a_site() {
    let folder = Folder::new();
    printed(&run(&folder, &["simulate", "tunnel", "-o", "tunnel.log"]));
    let output = run(&folder, &["replay", "tunnel.log"]);
    let error = String::from_utf8_lossy(&output.stderr);
    assert!(
        output.status.code() == Some(3)
            && error.contains("packets of tags")
            && error.contains("[[site]]"),
        "{error}"
    );
}

/// Whatever a log holds, it is read to its end.
#[test]
fn logs_of_real_receivers_are_read() {
    let Ok(data) = std::env::var("FOXHUNT_DATA") else {
        eprintln!("skipped: FOXHUNT_DATA does not name the data");
        return;
    };
    let folder = Folder::new();
    let logs = format!("{data}/nmea/logs");
    let Ok(entries) = fs::read_dir(&logs) else {
        eprintln!("skipped: there is no {logs}");
        return;
    };
    let files: Vec<_> = entries
        .filter_map(|entry| Some(entry.ok()?.path()))
        .collect();
    for file in files.iter().filter(|file| file.is_file()).take(40) {
        let output = run(&folder, &["replay", file.to_str().unwrap(), "--json"]);
        let code = output.status.code();
        assert!(matches!(code, Some(0 | 3)), "{}: {code:?}", file.display());
    }
}
