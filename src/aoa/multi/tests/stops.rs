//! A vehicle that stops, and sources that pause.

use super::*;

/// Rows of stops between four sources at the corners of a room.
pub(super) const ROOM: [[f32; 2]; 4] = [[0.0, 0.0], [12.0, 0.0], [12.0, 12.0], [0.0, 12.0]];

pub(super) fn stop(index: usize) -> [f32; 2] {
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

/// Of two tracks of one source and one of another.
#[test]
fn the_track_of_fewer_bearings_is_deleted() {
    const PLACES: [[f32; 2]; 2] = [[900.0, 900.0], [2300.0, 500.0]];
    for (counts, deleted) in [([80, 60], 1), ([60, 80], 0), ([60, 60], 1)] {
        let mut sources = Three::EMPTY;
        let mut rng = generator(3);
        for (place, count) in [counts[0], counts[1], 80].into_iter().enumerate() {
            let whose = usize::from(place == 2);
            let sights = bearings((0..count).map(corner), &PLACES, |_, _| Some(whose), 3);
            for sight in &sights {
                sources.tracks[place]
                    .push(sight, &STRAIGHT, &mut rng)
                    .unwrap();
            }
            sources.slots[place].identity = Some(place as u16);
        }
        sources.delete_twin(2);
        assert!(sources.slots.iter().all(|slot| slot.identity.is_some()));
        sources.delete_twin(0);
        let free = |slot: &Slot| slot.identity.is_none();
        assert!(
            sources
                .slots
                .iter()
                .map(free)
                .eq((0..3).map(|place| place == deleted))
        );
    }
}

/// A bearing of the source that was not known to be one when it came.
#[test]
fn a_track_takes_the_bearings_that_it_can_explain_now() {
    let mut sources = MultiTarget::<3, One>::EMPTY;
    let mut rng = generator(1);
    let places = (0..21).map(stop);
    let sights = bearings(places, &ROOM[..1], |_, _| Some(0), 1);
    let (before, [missed, last]) = sights.split_last_chunk().unwrap();
    for sight in before {
        sources.push(sight, &Config::DEFAULT, &mut rng).unwrap();
    }
    let held = |sources: &MultiTarget<3, One>| sources.source(0).unwrap().fix.bearings;
    let heard =
        |sources: &MultiTarget<3, One>| sources.slots.iter().map(|slot| slot.heard).sum::<f32>();
    let [left, had] = [sources.candidates.entries().len() as u32, held(&sources)];
    let (heard_before, outliers) = (heard(&sources), sources.outliers);
    let beliefs = One::beliefs(&Config::DEFAULT.track);
    let missed = [(*missed).into()];
    (sources.candidates)
        .push(&missed, &robust::Shared::NOTHING, 7.0, &beliefs, &mut rng)
        .unwrap();
    assert_eq!(sources.candidates.entries().len() as u32, left + 1);
    sources.outliers += 1.0;
    sources.push(last, &Config::DEFAULT, &mut rng).unwrap();
    assert_eq!(sources.candidates.entries().len() as u32, left);
    assert_eq!(held(&sources), had + 2);
    assert_eq!(heard(&sources), heard_before + 2.0);
    assert_eq!(sources.outliers, outliers);
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

/// The bearings of all sources tell of the one array that takes them.
#[test]
fn scale_and_bias_are_known_from_all_sources() {
    const TURNED: f32 = 0.05;
    let (mut alone, mut together) = ([0.0; 2], [0.0; 2]);
    for seed in 0..10 {
        let places = (0..84).map(|i| stop(i / 4));
        let sights = bearings(places, &ROOM, |_, i| Some(i % 4), seed);
        let turn = |(i, one): (usize, &Observation)| {
            observe(i, one.position(), one.bearing().radians() + TURNED)
        };
        let turned: Vec<Observation> = sights.iter().enumerate().map(turn).collect();
        let own: Vec<Observation> = turned.iter().step_by(4).copied().collect();
        let mut one = Locator::<One>::new(robust::Config::DEFAULT).unwrap();
        let mut all = Locator::<MultiTarget<6, One>>::new(Config::DEFAULT).unwrap();
        run(&mut one, &own, seed);
        run(&mut all, &turned, seed);
        let sigmas = |bias: Option<Bias>, scale: Option<SigmaScale>| {
            [bias.unwrap().sigma_rad, scale.unwrap().sigma]
        };
        let bias = all.bias().unwrap();
        assert!((bias.mean_rad - TURNED).abs() < 4.0 * bias.sigma_rad);
        for (sum, sigma) in alone.iter_mut().zip(sigmas(one.bias(), one.sigma_scale())) {
            *sum += sigma;
        }
        for (sum, sigma) in together
            .iter_mut()
            .zip(sigmas(all.bias(), all.sigma_scale()))
        {
            *sum += sigma;
        }
    }
    // A half with four times as many bearings, if nothing else was unknown.
    assert!(together[0] < 0.75 * alone[0], "{together:?} {alone:?}");
    assert!(together[1] < 0.75 * alone[1], "{together:?} {alone:?}");
}

#[test]
fn one_more_source_is_pointed_at_before_it_has_a_fix() {
    let mut pointed = 0;
    for seed in 0..20 {
        let places = (0..84).map(|i| stop(i / 4));
        let sights = bearings(places, &ROOM, |_, i| Some(i % 4), seed);
        let mut sources = Locator::<MultiTarget<6, One>>::new(Config::DEFAULT).unwrap();
        let mut rng = generator(seed);
        let mut candidates: Vec<Hypothesis> = Vec::new();
        for observation in &sights {
            sources.push(observation, &mut rng).unwrap();
            candidates.extend(sources.candidates().filter(|one| one.probability > 0.5));
            let known: Vec<f32> = sources.candidates().map(|one| one.probability).collect();
            assert!(known.is_sorted_by(|a, b| a >= b) && known.iter().all(|p| *p <= 1.0));
        }
        let is_near = |one: &Hypothesis| {
            let [x, y] = one.position;
            ROOM.iter()
                .any(|place| (x - place[0]).hypot(y - place[1]) < 3.0)
        };
        pointed += u32::from(!candidates.is_empty() && candidates.iter().all(is_near));
        assert!(all(&sources).iter().all(|source| source.probability > 0.9));
    }
    assert!(pointed >= 15, "{pointed}");
}
