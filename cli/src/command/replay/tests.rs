use std::{env, fs, path::PathBuf, process};

use clap::Parser;

use super::*;

/// The drive that comes with the project.
fn example() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../examples/data/drive.nmea")
}

#[derive(Parser)]
struct Task {
    #[command(flatten)]
    options: Options,
}

fn replay(file: &Path, more: &[&str]) -> (Result<()>, PathBuf) {
    let name = format!("foxhunt-replay-{}-{}", process::id(), more.join("-"));
    let directory = env::temp_dir().join(name.replace('.', "-"));
    let mut arguments = vec!["replay".into(), file.as_os_str().to_owned()];
    arguments.extend(["--output".into(), directory.clone().into()]);
    arguments.extend(more.iter().map(Into::into));
    let task = Task::try_parse_from(arguments).expect("these are options");
    (run(&task.options), directory)
}

/// The shipped drive, by every locator: all find the source within their ellipse, widened to 99.99 %.
#[test]
fn the_shipped_drive_is_kept() {
    let file = example();
    let truth = foxhunt_host::drive::truth(&fs::read(&file).unwrap()).unwrap();
    for locator in ["plain", "robust", "single", "moving"] {
        let (done, directory) = replay(&file, &["--locator", locator]);
        done.unwrap();
        let table = fs::read_to_string(directory.join("fixes.csv")).unwrap();
        let mut lines = table.lines();
        let heads: Vec<&str> = lines.next().unwrap().split(',').collect();
        let last: Vec<&str> = lines.last().unwrap().split(',').collect();
        let field = |name: &str| {
            let column = heads.iter().position(|head| *head == name).unwrap();
            last[column].parse::<f64>().unwrap()
        };
        let place = foxhunt_host::geodesy::Place {
            latitude: field("latitude"),
            longitude: field("longitude"),
        };
        let [east, north] = place.local(truth);
        assert!(
            east.hypot(north) < 4.3 / 2.448 * field("semi_major_m"),
            "{locator}"
        );
        assert!(directory.join("archive.geojson").is_file());
        assert!(directory.join("picture.svg").is_file());
        assert!(directory.join("archive.kml").is_file());
        assert!(directory.join("archive.gpx").is_file());
        fs::remove_dir_all(directory).unwrap();
    }
}

#[test]
fn nothing_is_written_of_nothing() {
    let (done, directory) = replay(Path::new("no/such.log"), &["--seed", "2"]);
    assert!(
        done.unwrap_err()
            .to_string()
            .contains("cannot open no/such.log")
    );
    assert!(!directory.exists());

    let file = example();
    // The drive's finder is a KrakenSDR.
    let (done, directory) = replay(&file, &["--finder", "agrelo"]);
    assert!(
        done.unwrap_err()
            .to_string()
            .contains(&format!("no bearing of {} was used", file.display()))
    );
    assert!(!directory.exists());
}

#[test]
fn what_a_locator_does_not_listen_to_is_refused() {
    let file = example();
    let (done, _) = replay(&file, &["--locator", "plain", "--bias-sigma", "3"]);
    assert!(
        done.unwrap_err()
            .to_string()
            .contains("--bias-sigma is of no use")
    );
    let (done, _) = replay(&file, &["--outliers", "1.5"]);
    assert!(done.unwrap_err().to_string().contains("outlier"));
}

#[test]
fn what_contradicts_is_refused_before_anything_is_read() {
    // There is no such log: that it is not said shows that nothing was read.
    let refused = |more: &[&str]| {
        let (done, _) = replay(Path::new("no/such.log"), more);
        done.unwrap_err().to_string()
    };
    for more in [
        ["--sigmas", "devices", "--best-sigma", "3"],
        ["--sigmas", "devices", "--worst-sigma", "12"],
        ["--finder", "kraken", "--best-sigma", "3"],
        ["--finder", "kraken", "--tag", "CCF9578E0D8A"],
        ["--finder", "ublox", "--frequency", "433920000"],
        ["--finder", "agrelo", "--confidence", "decibels"],
        ["--finder", "agrelo", "--sense", "counter-clockwise"],
    ] {
        let error = refused(&more);
        assert!(error.contains("is of no use with"), "{more:?}: {error}");
    }
    for (more, reason) in [
        (["--outliers", "-1"], "outlier"),
        (["--minimum-speed", "-1"], "speed"),
        (["--minimum-quality", "-0.5"], "quality"),
        (["--range", "-5"], "range"),
    ] {
        let error = refused(&more).to_lowercase();
        assert!(error.contains(reason), "{more:?}: {error}");
    }
    // What belongs together is not.
    for more in [
        ["--finder", "ublox", "--tag", "CCF9578E0D8A"],
        ["--confidence", "fraction", "--frequency", "433920000"],
        ["--sigmas", "linear", "--best-sigma", "3"],
    ] {
        let error = refused(&more);
        assert!(
            error.contains("cannot open no/such.log"),
            "{more:?}: {error}"
        );
    }
}

#[test]
fn a_file_is_no_directory_to_write_to() {
    let example = example();
    for output in [example.clone(), example.join("below")] {
        let arguments = [
            "replay".as_ref(),
            "no/such.log".as_ref(),
            "-o".as_ref(),
            output.as_os_str(),
        ];
        let task = Task::try_parse_from(arguments).expect("these are options");
        let error = run(&task.options).unwrap_err().to_string();
        assert!(
            error.contains("cannot write to") && error.contains("is no directory"),
            "{error}"
        );
    }
}
