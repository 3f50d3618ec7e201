//! A vehicle that stops, and sources that pause.

use super::*;

/// Rows of stops between four sources at the corners of a room.
const ROOM: [[f32; 2]; 4] = [[0.0, 0.0], [12.0, 0.0], [12.0, 12.0], [0.0, 12.0]];

fn stop(index: usize) -> [f32; 2] {
    let (row, column) = (index / 7, index % 7);
    let column = if row % 2 == 0 { column } else { 6 - column };
    [2.4 + 1.2 * column as f32, 2.4 + 3.6 * row as f32]
}

#[test]
fn four_sources_are_found_from_stops() {
    let mut found = 0;
    for seed in 0..20 {
        // One bearing of each source at each of 21 stops.
        let places = (0..84).map(|i| stop(i / 4));
        let sights = bearings(places, &ROOM, |_, i| Some(i % 4), seed);
        let mut sources = Locator::<MultiTarget<6, One>>::new(Config::DEFAULT).unwrap();
        run(&mut sources, &sights, seed);
        let is_found = |place: &[f32; 2]| all(&sources).iter().any(|s| off(&s.fix, *place) < 3.0);
        found += u32::from(ROOM.iter().all(is_found) && all(&sources).len() == 4);
    }
    assert!(found >= 19, "{found}");
}

#[test]
fn a_source_that_pauses_keeps_its_number() {
    let truths = [[900.0, 900.0], [2300.0, 500.0]];
    let mut kept = 0;
    for seed in 0..20 {
        let places = (0..480).map(to_and_fro);
        // The second source pauses for half of the time.
        let whose = |kind: f32, i: usize| match (kind, i) {
            (0.0..0.1, _) => None,
            (0.5.., 0..120 | 360..) => Some(1),
            _ => Some(0),
        };
        let sights = bearings(places, &truths, whose, seed);
        let mut sources = three();
        let mut rng = generator(seed);
        let mut numbers = Vec::new();
        for (i, observation) in sights.iter().enumerate() {
            sources.push(observation, &mut rng).unwrap();
            if [119, 359, 479].contains(&i) {
                let there = all(&sources)
                    .into_iter()
                    .find(|s| off(&s.fix, truths[1]) < 100.0);
                numbers.push(there.map(|source| source.identity));
            }
        }
        kept += u32::from(numbers[0].is_some() && numbers[1].is_none() && numbers[2] == numbers[0]);
    }
    assert!(kept >= 19, "{kept}");
}
