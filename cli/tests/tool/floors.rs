//! Tags in a building of several floors.

use std::{
    collections::BTreeMap,
    fs::{self, File},
    process::{Command, Output},
};

use serde_json::Value;

use crate::program::{Folder, printed, run};

const SETTINGS: &str = r#"
[[input]]
name = "radios"
stdin = true
site = "building"

[[site]]
name = "building"
map = "building-0.map"
above = ["building-1.map", "building-2.map"]
walks = "floor"

[[site.passage]]
floors = [0, 1]
corners = [[0, 7], [3, 7], [3, 12], [0, 12]]

[[site.passage]]
floors = [1, 2]
corners = [[0, 7], [3, 7], [3, 12], [0, 12]]

[[site.room]]
name = "west"
floor = 1
corners = [[0, 0], [18, 0], [18, 12], [0, 12]]

[[site.room]]
name = "east"
floor = 1
corners = [[18, 0], [36, 0], [36, 12], [18, 12]]

[[output]]
name = "tags"
file = "tags.geojsonl"
form = "geojson"
"#;

fn building() -> Folder {
    let folder = Folder::new();
    folder.file(
        "building.toml",
        "[building]\nseed = 1\npeople = 3\nseconds = 120.0\n",
    );
    printed(&run(
        &folder,
        &["simulate", "building.toml", "-o", "building.log"],
    ));
    printed(&run(
        &folder,
        &["survey", "build", "building.csv", "-o", "building.map"],
    ));
    folder
}

fn live(folder: &Folder) -> Output {
    Command::new(env!("CARGO_BIN_EXE_foxhunt"))
        .args(["live", "--no-page", "--until-end", "site.toml"])
        .current_dir(&folder.0)
        .stdin(File::open(folder.0.join("building.log")).unwrap())
        .output()
        .unwrap()
}

#[test]
fn tags_have_a_floor_and_a_room_each_with_its_probability() {
    let folder = building();
    folder.file("site.toml", SETTINGS);
    printed(&live(&folder));
    let text = fs::read_to_string(folder.0.join("tags.geojsonl")).unwrap();
    let mut floors = BTreeMap::new();
    for line in text.lines() {
        let feature: Value = serde_json::from_str(line).unwrap();
        let tag = &feature["properties"];
        let floor = tag["floor"].as_u64().unwrap();
        let sure = tag["floor_probability"].as_f64().unwrap();
        assert!(
            floor < 3 && (1.0 / 3.0 - 1e-3..=1.0).contains(&sure),
            "{tag}"
        );
        *floors.entry(floor).or_insert(0) += 1;
        if let Some(room) = tag["room"].as_str() {
            let is_in = tag["room_probability"].as_f64().unwrap();
            assert!(is_in > 0.0 && ["west", "east"].contains(&room), "{tag}");
            // All of the floor is in one of the rooms, but for what is beyond the walls.
            assert!(floor != 1 || is_in > 0.45 * sure, "{tag}");
        }
    }
    assert!(
        floors.len() > 1 && floors.values().sum::<u32>() > 300,
        "{floors:?}"
    );
}

#[test]
fn floors_that_do_not_belong_together_are_refused() {
    let folder = building();
    for (from, to, what) in [
        ("floors = [0, 1]", "floors = [0, 3]", "passages"),
        ("floors = [0, 1]", "floors = [0]", "floors"),
        ("[[0, 7], [3, 7], [3, 12], [0, 12]]", "[[0, 7]]", "corners"),
        ("[[18, 0], [36, 0], [36, 12], [18, 12]]", "[]", "room east"),
        ("building-1.map", "building.log", "no radio map"),
        ("building-2.map", "building-3.map", "cannot read"),
    ] {
        folder.file("site.toml", SETTINGS.replace(from, to));
        let output = live(&folder);
        let error = String::from_utf8_lossy(&output.stderr).into_owned();
        assert!(
            !output.status.success() && error.contains(what),
            "{what}: {error}"
        );
    }
}
