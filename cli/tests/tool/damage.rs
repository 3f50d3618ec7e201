//! Files that were damaged.

use std::fs;

use foxhunt::random::{Rng, SeedableRng, Xoshiro128PlusPlus};

use crate::program::{Folder, drive, printed, run};

const DRIVE: &str = "seed = 1\ninterval_s = 9.0\nsigma_rad = 0.05\noutlier_rate = 0.1\nmirrored_rate = 0.0\nbias_rad = 0.0\n\
    [vehicle]\ncorners = [[0.0, 0.0], [900.0, 0.0]]\nspeed_m_s = 12.0\nstart_s = 0.0\n\
    [[sources]]\ncorners = [[900.0, 1000.0]]\nspeed_m_s = 1.0\nstart_s = 0.0\n";
const TUNNEL: &str = "[tunnel]\nseed = 1\n[[tunnel.people]]\ntag = 7\n\
    way = { corners = [[2.0, 1.2], [74.0, 1.2]], speed_m_s = 1.2, start_s = 0.0 }\n";
const BUILDING: &str = "[building]\nseed = 1\npeople = 2\nseconds = 60.0\n";

/// A few bytes lost, replaced or put in, of those that readers of text trip over.
fn damaged(text: &[u8], rng: &mut Xoshiro128PlusPlus) -> Vec<u8> {
    const PIECES: [&[u8]; 14] = [
        b"",
        b"-1",
        b"0",
        b"1e308",
        b"1e-300",
        b"nan",
        b"inf",
        b"99999999999999999999",
        b"\xff",
        b"\"",
        b"[",
        b"]",
        b"\n",
        b"{}",
    ];
    let mut damaged = text.to_vec();
    let mut below = |most: usize| rng.next_u32() as usize % most;
    for _ in 0..=below(3) {
        let from = below(damaged.len());
        let to = damaged.len().min(from + below(20));
        let piece = PIECES[below(PIECES.len())];
        damaged.splice(from..to, piece.iter().copied());
        damaged.push(b'\n');
    }
    damaged
}

#[test]
fn damaged_files_are_read_or_refused() {
    let folder = Folder::new();
    folder.file("building.toml", BUILDING);
    printed(&run(
        &folder,
        &["simulate", "building.toml", "-o", "b.packets"],
    ));
    let survey = fs::read(folder.0.join("b.csv")).unwrap();
    let survey = &survey[..survey.len().min(4_000)];
    let log = fs::read(drive()).unwrap();
    let files: [(&str, &[u8], &[&str]); 5] = [
        (
            "drive.toml",
            DRIVE.as_bytes(),
            &["simulate", "drive.toml", "-o", "out"],
        ),
        (
            "tunnel.toml",
            TUNNEL.as_bytes(),
            &["simulate", "tunnel.toml", "-o", "out"],
        ),
        (
            "building.toml",
            BUILDING.as_bytes(),
            &["simulate", "building.toml", "-o", "out"],
        ),
        ("survey.csv", survey, &["survey", "check", "survey.csv"]),
        ("log.nmea", &log, &["explain", "log.nmea"]),
    ];
    let mut rng = Xoshiro128PlusPlus::seed_from_u64(1);
    for _ in 0..12 {
        for (name, text, arguments) in files {
            let text = damaged(text, &mut rng);
            folder.file(name, &text);
            let output = run(&folder, arguments);
            let error = String::from_utf8_lossy(&output.stderr);
            let is_known = matches!(output.status.code(), Some(0..=3));
            let shown = String::from_utf8_lossy(&text);
            assert!(
                is_known && !error.contains("panicked"),
                "{name}: {error}\n{shown}"
            );
        }
    }
}
