//! The commands of the guide's chapters, as they stand there.

use std::{
    fs,
    path::Path,
    process::{Command, Stdio},
};

use crate::program::{Folder, drive, printed, run};

/// The blocks of code of a kind in a chapter.
fn blocks(chapter: &str, kind: &str) -> Vec<String> {
    let guide = Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs/src");
    let text = fs::read_to_string(guide.join(chapter)).unwrap();
    let begin = format!("\n```{kind}\n");
    let blocks = text.split(&begin).skip(1);
    blocks
        .map(|rest| rest.split("\n```").next().unwrap().to_owned())
        .collect()
}

/// Writes the files of a chapter: those whose first line says what they are called.
fn write_files(folder: &Folder, chapter: &str) {
    for block in blocks(chapter, "toml") {
        let name = block
            .lines()
            .next()
            .and_then(|line| line.strip_prefix("# "));
        if let Some(name) = name {
            folder.file(name, &block);
        }
    }
}

/// Runs the commands of a chapter that end by themselves; says which they were.
fn run_commands(folder: &Folder, chapter: &str) -> Vec<String> {
    let program = Path::new(env!("CARGO_BIN_EXE_foxhunt"));
    let path = format!(
        "{}:{}",
        program.parent().unwrap().display(),
        std::env::var("PATH").unwrap()
    );
    let ends = |line: &str| {
        let is_live = line.starts_with("foxhunt live");
        let needs_board = line.contains("--serial ");
        line.starts_with("foxhunt ")
            && !needs_board
            && (!is_live || line.contains("--check") || line.contains("--until-end"))
    };
    let all = blocks(chapter, "sh").join("\n");
    let lines: Vec<String> = (all.lines().filter(|line| ends(line)))
        .map(str::to_owned)
        .collect();
    for line in &lines {
        // The page of several tests at once needs several ports.
        let line = line.replace(
            "foxhunt live --until-end",
            "foxhunt live --no-page --until-end",
        );
        let output = Command::new("sh")
            .args(["-c", &line])
            .env("PATH", &path)
            .current_dir(&folder.0)
            .stdin(Stdio::null())
            .output()
            .unwrap();
        let error = String::from_utf8_lossy(&output.stderr);
        assert!(output.status.success(), "{chapter}: {line}: {error}");
    }
    lines
}

#[test]
#[cfg(unix)]
fn the_chapter_about_tunnels_holds() {
    let folder = Folder::new();
    write_files(&folder, "tunnel.md");
    // A survey of one floor, as somebody has walked it.
    printed(&run(
        &folder,
        &["simulate", "building.toml", "-o", "own.log"],
    ));
    let survey = fs::read_to_string(folder.0.join("own.csv")).unwrap();
    let floor = survey
        .lines()
        .next()
        .unwrap()
        .split(',')
        .position(|name| name == "floor");
    let rows = survey
        .lines()
        .enumerate()
        .filter(|(number, row)| *number == 0 || row.split(',').nth(floor.unwrap()) == Some("0"));
    let rows: Vec<&str> = rows.map(|(_, row)| row).collect();
    folder.file("survey.csv", rows.join("\n"));

    let commands = run_commands(&folder, "tunnel.md");
    assert_eq!(commands.len(), 10, "{commands:?}");
    for (file, tags) in [("tags.geojsonl", 8), ("floors.geojsonl", 3)] {
        let features = fs::read_to_string(folder.0.join(file)).unwrap();
        let features = features
            .lines()
            .map(|line| serde_json::from_str(line).unwrap());
        let found: std::collections::BTreeSet<u64> = features
            .map(|feature: serde_json::Value| feature["properties"]["tag"].as_u64().unwrap())
            .collect();
        assert_eq!(found.len(), tags, "{file}");
    }
    let floors = fs::read_to_string(folder.0.join("floors.geojsonl")).unwrap();
    for part in [
        "\"floor\":",
        "\"floor_probability\":",
        "\"room\":\"corridor\"",
    ] {
        assert!(floors.contains(part), "{part}");
    }
    for file in ["expected.svg", "map.rs", "building-2.map"] {
        assert!(folder.0.join(file).is_file(), "{file}");
    }
}

#[test]
#[cfg(unix)]
fn the_chapter_about_live_holds() {
    let folder = Folder::new();
    write_files(&folder, "live.md");
    fs::copy(drive(), folder.0.join("drive.nmea")).unwrap();
    folder.file(
        "scenario.toml",
        "seed = 1\ninterval_s = 9.0\nsigma_rad = 0.05\noutlier_rate = 0.1\nmirrored_rate = 0.0\nbias_rad = 0.0\n\
         [vehicle]\ncorners = [[0.0, 0.0], [900.0, 0.0]]\nspeed_m_s = 12.0\nstart_s = 0.0\n\
         [[sources]]\ncorners = [[900.0, 1000.0]]\nspeed_m_s = 1.0\nstart_s = 0.0\n",
    );
    let commands = run_commands(&folder, "live.md");
    assert_eq!(commands.len(), 6, "{commands:?}");
    printed(&run(&folder, &["live", "--check", "board.toml"]));
}
