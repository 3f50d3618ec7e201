//! What users told wrongly, and what they are told then.

use crate::program::{Folder, printed, run};

/// What the program says of its failure.
fn refused(folder: &Folder, arguments: &[&str]) -> String {
    let output = run(folder, arguments);
    assert!(!output.status.success(), "{arguments:?}");
    String::from_utf8(output.stderr)
        .unwrap()
        .trim_end()
        .to_owned()
}

#[test]
fn a_value_is_named_as_it_was_told() {
    let folder = Folder::new();
    for (option, value, what) in [
        ("--outliers", "1.5", "must be from 0.001 to 0.9"),
        ("--minimum-quality", "101", "must be from 0 to 100"),
        ("--bias-sigma", "40", "must be from 0 to 28.6 degrees"),
        ("--maximum-age", "3600001", "must be at most an hour"),
    ] {
        let error = refused(&folder, &["replay", "no-such.log", option, value]);
        assert_eq!(error, format!("error: {option} {what}"));
    }
    folder.file("s.toml", "[errors]\nmirrored = 0.1\noutliers = 1.5\n");
    assert_eq!(
        refused(&folder, &["live", "s.toml"]),
        "error: s.toml:3:1: errors: outliers must be from 0.001 to 0.9"
    );
}

#[test]
fn settings_are_checked_as_a_whole() {
    let folder = Folder::new();
    folder.file("s.toml", "[[input]]\nname = \"r\"\ntcp = \"receiver\"\n");
    assert_eq!(
        refused(&folder, &["live", "--check", "s.toml"]),
        "error: s.toml:3:1: input r: tcp needs a host and a port: receiver has no port"
    );
    folder.file(
        "s.toml",
        "[[input]]\nname = \"r\"\nserial = \"/dev/ttyUSB0\"\n[[output]]\nname = \"map\"\nudp = \"127.0.0.1:1\"\n\
         [[output]]\nname = \"b\"\nmqtt = { broker = \"localhost\" }\n",
    );
    assert_eq!(
        printed(&run(&folder, &["live", "--check", "s.toml"])),
        "s.toml: all right\ninput r: serial /dev/ttyUSB0, 9600 baud\noutput map: nmea to udp 127.0.0.1:1\n\
         output b: geojson to mqtt localhost:1883, below foxhunt\npage: 127.0.0.1:8073\n"
    );
    printed(&run(&folder, &["init"]));
    let said = printed(&run(&folder, &["live", "--check", "foxhunt.toml"]));
    assert!(said.contains("nothing comes in"), "{said}");
    let said = printed(&run(&folder, &["live", "--check"]));
    assert!(
        said.contains("no settings") && said.contains("input stdin: the standard input"),
        "{said}"
    );
}

#[test]
fn a_file_is_named_once() {
    let folder = Folder::new();
    folder.file("s.toml", "seed = 1\nfoo = 3\n");
    folder.file(
        "b.toml",
        "[building]\nseed = 1\npeople = 0\nseconds = 3.0\n",
    );
    for name in ["s.toml", "b.toml"] {
        let error = refused(&folder, &["simulate", name, "-o", "x"]);
        assert_eq!(error.matches(name).count(), 1, "{error}");
    }
}

#[test]
fn options_of_a_comparison_are_those_of_a_replay() {
    let error = refused(
        &Folder::new(),
        &["compare", "no-such.log", "--with", "--foo"],
    );
    assert!(error.contains("Usage: foxhunt replay [OPTIONS]"), "{error}");
}
