//! The reports of a board.

use std::{fs, io::Write};

use foxhunt_decode::{Region, Report, report};
use foxhunt_gateways::{plain, robust};

use crate::program::{Folder, Live, drive, printed, run};

/// What the firmware sends.
macro_rules! sent {
    ($firmware:ident, $log:expr) => {{
        let mut gateway = Box::new($firmware::Gateway::EMPTY);
        let mut sent = String::new();
        for byte in $log {
            if gateway.push(0, *byte, &$firmware::CONFIG).is_some() {
                sent += gateway.report();
            }
        }
        sent
    }};
}

/// The last fix of the reports.
fn last_fix(sent: &str) -> (Region, u32) {
    let fixes = sent.lines().rev();
    let mut fixes = fixes.filter_map(|line| match report(line.as_bytes())? {
        Report::Fix {
            region, bearings, ..
        } => Some((region, bearings)),
        _ => None,
    });
    fixes.next().unwrap()
}

fn live(folder: &Folder) -> Live {
    let settings = "[[input]]\nname = \"board\"\nstdin = true\n\
                    [[output]]\nname = \"out\"\nfile = \"out.geojsonl\"\nform = \"geojson\"\n\
                    [[output]]\nname = \"line\"\nfile = \"out.nmea\"\n";
    Live::start(folder, settings, &[])
}

#[test]
fn the_fixes_of_a_board_are_shown_and_sent() {
    let log = fs::read(drive()).unwrap();
    for sent in [sent!(plain, &log), sent!(robust, &log)] {
        let (region, bearings) = last_fix(&sent);
        let folder = Folder::new();
        let mut live = live(&folder);
        let first = sent.split_inclusive('\n').take(1).collect::<String>();
        live.stdin().write_all(first.as_bytes()).unwrap();
        let why = live.until("why there is no fix", |live| {
            let answer = live.messages("answer").pop()?;
            (answer["time_ms"] != 0).then(|| answer["reason"].clone())
        });
        assert_eq!(why["code"], "FEW", "{why}");
        let rest = &sent.as_bytes()[first.len()..];
        live.stdin().write_all(rest).unwrap();
        let source = live.until("its last fix", |live| {
            let source = live.messages("answer").pop()?["sources"][0].clone();
            (source["bearings"] == bearings).then_some(source)
        });
        assert_eq!(source["lat"], region.latitude);
        assert_eq!(source["lon"], region.longitude);
        // 95 % of a normal distribution are within so many standard deviations.
        let semi = source["ellipse"]["semi_major_m"].as_f64().unwrap();
        assert!(
            (semi / region.sigmas_m[0] - 2.4477).abs() < 1e-2,
            "{source}"
        );
        live.until("every line used", |live| {
            let health = live.messages("health").pop()?;
            let input = &health["inputs"][0];
            (input["used"] == sent.lines().count()).then_some(())
        });
        live.stop();
        let out = fs::read_to_string(folder.0.join("out.geojsonl")).unwrap();
        assert!(out.contains("\"kind\":\"fix\""), "{out}");
        // What the board has sent is handed on.
        let nmea = fs::read_to_string(folder.0.join("out.nmea")).unwrap();
        let reports = nmea
            .split_inclusive('\n')
            .filter(|line| line.starts_with("$PFOX"));
        assert_eq!(reports.collect::<String>(), sent);
    }
}

#[test]
fn several_sources_of_a_board_keep_their_numbers() {
    let folder = Folder::new();
    printed(&run(
        &folder,
        &["simulate", "two-sources", "-o", "two.nmea"],
    ));
    let sent = sent!(robust, &fs::read(folder.0.join("two.nmea")).unwrap());
    let mut live = live(&folder);
    live.stdin().write_all(sent.as_bytes()).unwrap();
    let (region, bearings) = last_fix(&sent);
    let sources = live.until("its last fix", |live| {
        let sources = live.messages("answer").pop()?["sources"].clone();
        (sources[1]["bearings"] == bearings).then_some(sources)
    });
    assert_eq!(sources[1]["lat"], region.latitude);
    let numbers = [0, 1].map(|index| sources[index]["number"].as_u64().unwrap());
    assert_eq!(numbers, [0, 1], "{sources}");
}

#[test]
fn what_this_program_finds_itself_comes_before_what_a_board_reports() {
    let folder = Folder::new();
    let mut live = live(&folder);
    live.stdin().write_all(&fs::read(drive()).unwrap()).unwrap();
    live.until("all bearings", |live| (live.bearings() == 55).then_some(()));
    let before = live.answer();
    live.stdin()
        .write_all(b"$PFOXN,,FEW,0,,*5E\r\n%045/7\r\n")
        .unwrap();
    live.until("56 bearings", |live| (live.bearings() == 56).then_some(()));
    assert_eq!(
        live.answer()["sources"].as_array().unwrap().len(),
        1,
        "{before}"
    );
}

#[test]
fn tags_of_a_board_are_on_the_map_of_their_site() {
    let folder = Folder::new();
    printed(&run(&folder, &["simulate", "tunnel", "-o", "tunnel.log"]));
    let settings = "[[input]]\nname = \"gateway\"\nstdin = true\nsite = \"tunnel\"\n\
                    [[site]]\nname = \"tunnel\"\nmap = \"tunnel.map\"\nlatitude = 48.1\nlongitude = 11.5\n";
    let mut live = Live::start(&folder, settings, &[]);
    let line =
        "$PFOXT,12500,7,TRACKING,31.250,-0.500,1.000,0.000,2.000,1.000,0.0,-3.3,211.0*45\r\n";
    live.stdin().write_all(line.as_bytes()).unwrap();
    let tag = live.until("a tag", |live| live.messages("tag").pop());
    assert_eq!((&tag["site"], &tag["id"]), (&"tunnel".into(), &7.into()));
    assert_eq!(
        (&tag["x"], &tag["state"]),
        (&31.25.into(), &"TRACKING".into())
    );
    assert!(
        (tag["lon"].as_f64().unwrap() - 11.500_42).abs() < 1e-5,
        "{tag}"
    );
}
