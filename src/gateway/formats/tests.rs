//! What holds for every format.

extern crate std;

use super::format::{Reading, Sentence};
use super::*;
use crate::gateway::outcome::Rejected;

/// The reading of a line of one format.
pub fn read<F: Format>(line: &str, config: &F::Config) -> Result<Reading, Rejected> {
    let mut format = F::EMPTY;
    match format.parse(line.as_bytes(), config)? {
        Sentence::Reading(reading) => Ok(reading),
        other => panic!("{line} is no bearing but {other:?}"),
    }
}

#[test]
fn every_finder_has_a_name_and_an_example_that_only_it_reads() {
    for &finder in Finder::ALL {
        let line = finder.example().as_bytes();
        let which = All::which(line[0], 0);
        let read = |heard| {
            let config = Config {
                finder: heard,
                ..Config::DEFAULT
            };
            let mut formats = All::EMPTY;
            formats.parse(which, line, &config)
        };
        assert!(matches!(read(None), Ok(Sentence::Reading(_))), "{finder:?}");
        for &other in Finder::ALL {
            let expected = (other != finder).then_some(Rejected::OtherFinder);
            assert_eq!(read(Some(other)).err(), expected);
        }
        let same = |other: &&Finder| other.name() == finder.name();
        assert_eq!(Finder::ALL.iter().filter(same).count(), 1);
    }
}

#[test]
fn formats_that_are_not_named_are_not_read() {
    type Some = (Nmea, Agrelo);
    for &finder in Finder::ALL {
        let first = finder.example().as_bytes()[0];
        assert_eq!(Some::which(first, 0) != 0, finder == Finder::Agrelo);
    }
    assert_eq!(All::which(b'?', 0), 0);
    type Most = (
        Ubx,
        Ubx,
        Ubx,
        Ubx,
        Ubx,
        Ubx,
        Ubx,
        Ubx,
        Ubx,
        Ubx,
        Ubx,
        Agrelo,
    );
    assert_eq!(Most::which(b'%', 0), 12);
    assert!(Most::layout(12).is_some() && Most::layout(13).is_none());
    assert!(All::layout(0).is_none());
}
