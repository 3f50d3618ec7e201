//! Tags in a building of three floors: on which floor, and in which room.

use anyhow::{Context, Result};
use foxhunt::{
    fingerprint::{
        Lattice, RadioMap, Reading, ReadingError, Zone,
        tracker::{
            Building as Site, BuildingTracker, Config, Passage, Site as Floor, Storey, Walls,
            Workspace,
        },
    },
    random::{SeedableRng, Xoshiro128PlusPlus},
};
use foxhunt_host::{
    building::{Building, EXTENT, FLOORS, Room, STAIRS, Walk},
    figures::Figure,
    radio_map::{Recipe, SiteSurvey},
};
use foxhunt_simulation::random::generator;
use indicatif::ParallelProgressIterator;
use rayon::prelude::*;

use super::{
    study::{Study, progress},
    table::table,
};

/// Seconds of a walk, and until the first score.
const SECONDS: f64 = 300.0;
const FIRST_S: f64 = 5.0;
/// Walks in each building.
const WALKS: u32 = 5;
/// Particles.
const PARTICLES: usize = 300;
/// How often a tag in the stairwell changes the floor, for the tracker: a third of the time that it takes.
const STAIRS_S: f32 = 5.0;
/// Metres from one point of the maps to the next.
const SPACING: f32 = 1.5;
/// Room for the points of all floors.
const POINTS: usize = 1024;
const BEACONS: usize = Building::BEACONS;

/// The probabilities of the ellipses that are scored.
const ELLIPSES: [f32; 3] = [0.5, 0.8, 0.95];

/// In how many seconds the tag was in the ellipse of each probability.
#[derive(Default, Clone, Copy)]
struct Held {
    seconds: f64,
    held: [f64; ELLIPSES.len()],
}

impl Held {
    fn add(self, other: Self) -> Self {
        let pairs = self.held.iter().zip(other.held);
        let mut held = self.held;
        for (sum, (a, b)) in held.iter_mut().zip(pairs) {
            *sum = a + b;
        }
        Self {
            seconds: self.seconds + other.seconds,
            held,
        }
    }

    fn fractions(&self) -> [f64; ELLIPSES.len()] {
        self.held.map(|held| held / f64::max(self.seconds, 1.0))
    }
}

/// What was said, and what was right.
#[derive(Default)]
struct Scores {
    /// Probabilities that were stated, each with whether it was so.
    floors: Vec<(f32, bool)>,
    rooms: Vec<(f32, bool)>,
    /// Of those who move and of those who are at rest, where the floor was right.
    ellipses: [Held; 2],
    /// Seconds, and those in which the likeliest was right.
    seconds: f64,
    right_floor: f64,
    right_room: f64,
    /// Off the stairs only.
    level: f64,
    right_on_level: f64,
}

impl Scores {
    fn add(mut self, other: Self) -> Self {
        self.floors.extend(other.floors);
        self.rooms.extend(other.rooms);
        let [moving, rest] = self.ellipses;
        self.ellipses = [moving.add(other.ellipses[0]), rest.add(other.ellipses[1])];
        self.seconds += other.seconds;
        self.right_floor += other.right_floor;
        self.right_room += other.right_room;
        self.level += other.level;
        self.right_on_level += other.right_on_level;
        self
    }
}

/// Runs the walks.
///
/// # Errors
/// If a map cannot be made or a packet is refused.
pub fn run(study: &Study) -> Result<Vec<Figure>> {
    let walks = study.runs.unwrap_or(1000);
    let buildings = walks.div_ceil(WALKS);
    println!(
        "{} walks of {SECONDS} s in {buildings} buildings of three floors, by {} beacons on each; scored every second from \
         {FIRST_S} s on\n",
        buildings * WALKS,
        BEACONS / FLOORS,
    );
    let mut figures = Vec::new();
    for (name, words, config) in [
        ("default", "by default", Config::DEFAULT),
        ("told", "told how errors are", told()),
    ] {
        let scores = (0..u64::from(buildings))
            .into_par_iter()
            .progress_with(progress(buildings.into(), words)?)
            .map(|run| in_building(study.seed, run, config))
            .try_reduce(Scores::default, |a, b| Ok(a.add(b)))?;
        println!("{words}:\n");
        figures.extend(summary(name, &scores));
    }
    Ok(figures)
}

/// Of tags whose errors are as they are here: independent from beacon to beacon, normal, and those of the survey's tag.
///
/// What errors have in common a survey cannot tell, because it is how a walk differs from the survey: places that are left out
/// of measured surveys are told best with a larger tempering than those of the simulated ones.
fn told() -> Config {
    Config {
        tempering: 1.0,
        gate_sigmas: f32::INFINITY,
        offset_probability: 0.0,
        ..Config::DEFAULT
    }
}

/// Prints the tables, and returns the figures.
fn summary(name: &str, scores: &Scores) -> Vec<Figure> {
    let figure = |what: &str, value: f64| Figure::new(format!("floors.{name}.{what}"), value, "");
    let wrong = |right: f64, of: f64| 1.0 - right / of;
    let floors = reliability("floor", &scores.floors);
    let ellipses = ellipses(&scores.ellipses);
    vec![
        figure("wrong_floor", wrong(scores.right_floor, scores.seconds)).at_most(0.03),
        figure(
            "wrong_floor_off_the_stairs",
            wrong(scores.right_on_level, scores.level),
        ),
        figure("wrong_room", wrong(scores.right_room, scores.seconds)),
        figure("floor_reliability", floors),
        figure("room_reliability", reliability("room", &scores.rooms)),
        figure("ellipse_reliability", ellipses),
    ]
}

/// Prints how often ellipses held the tag, and returns by how much that differs from their probabilities, on average.
fn ellipses(of: &[Held; 2]) -> f64 {
    let mut header = vec!["ellipses of".to_owned()];
    header.extend(ELLIPSES.map(|p| format!("{:.0} %", 100.0 * p)));
    header.push("seconds".to_owned());
    let mut table = table(header, 1);
    let mut sum = 0.0;
    for (name, held) in ["who moves", "who is at rest"].into_iter().zip(of) {
        let fractions = held.fractions();
        let off = fractions.iter().zip(ELLIPSES);
        sum += off.map(|(f, p)| (f - f64::from(p)).abs()).sum::<f64>();
        let mut row = vec![name.to_owned()];
        row.extend(fractions.map(|fraction| format!("{:.1} %", 100.0 * fraction)));
        row.push(format!("{}", held.seconds));
        table.add_row(row);
    }
    println!("{table}\n");
    sum / (of.len() * ELLIPSES.len()) as f64
}

/// Prints how often what was stated with a probability was so, and returns the mean difference between both, weighted by how
/// often it was stated, of those that are neither certain nor impossible.
fn reliability(name: &str, stated: &[(f32, bool)]) -> f64 {
    const EDGES: [f32; 11] = [0.0, 0.02, 0.1, 0.2, 0.3, 0.5, 0.7, 0.8, 0.9, 0.98, 1.1];
    let mut table = table([name, "stated", "so", "times"], 1);
    let (mut sum, mut weight) = (0.0, 0.0);
    for edges in EDGES.windows(2) {
        let within = |(p, _): &&(f32, bool)| *p >= edges[0] && *p < edges[1];
        let bin: Vec<_> = stated.iter().filter(within).collect();
        let count = bin.len() as f64;
        if count == 0.0 {
            continue;
        }
        let mean = bin.iter().map(|(p, _)| f64::from(*p)).sum::<f64>() / count;
        let so = bin.iter().filter(|(_, so)| *so).count() as f64 / count;
        if edges[0] >= 0.02 && edges[1] < 1.0 {
            sum += count * (mean - so).abs();
            weight += count;
        }
        table.add_row([
            format!("{} to {}", edges[0], edges[1].min(1.0)),
            format!("{mean:.3}"),
            format!("{so:.3}"),
            format!("{count}"),
        ]);
    }
    println!("{table}\n");
    sum / f64::max(weight, 1.0)
}

/// Makes the maps of a building, and follows some walks.
fn in_building(seed: u64, run: u64, config: Config) -> Result<Scores> {
    let mut rng = generator(seed, run);
    let building = Building::draw(&mut rng);
    let points = EXTENT.map(|metres| (metres as f32 / SPACING) as u16 + 1);
    let lattice = Lattice::new([0.0; 2], SPACING, points[0], points[1])?;
    let beacons: Vec<u32> = (0..BEACONS as u32).collect();
    let mut maps = Vec::new();
    for floor in 0..FLOORS {
        let survey = building.survey(floor, &mut rng);
        let survey = SiteSurvey::of(&survey, &beacons).among(&beacons);
        maps.push(survey.map(&Recipe::on(lattice), &mut |_| ())?.bytes);
    }
    let mut scores = Scores::default();
    for walk in 0..u64::from(WALKS) {
        let walk_seed = seed ^ (run * u64::from(WALKS) + walk);
        let walk = building.walk(SECONDS, &mut rng);
        scores = scores.add(follow(&building, &maps, &walk, config, walk_seed)?);
    }
    Ok(scores)
}

fn corners([[x0, y0], [x1, y1]]: &Room) -> [[f32; 2]; 4] {
    [[*x0, *y0], [*x1, *y0], [*x1, *y1], [*x0, *y1]].map(|corner| corner.map(|c| c as f32))
}

/// All rooms, by floor.
fn zones(corners: &[Vec<[[f32; 2]; 4]>]) -> Vec<Zone<'_>> {
    let floors = corners.iter().enumerate();
    let rooms = floors.flat_map(|(floor, rooms)| {
        rooms.iter().enumerate().map(move |(room, corners)| Zone {
            id: (100 * floor + room) as u16,
            floor: floor as u8,
            corners,
        })
    });
    rooms.collect()
}

/// Follows a walk, and scores it.
fn follow(
    building: &Building,
    maps: &[Vec<u8>],
    walk: &Walk,
    config: Config,
    seed: u64,
) -> Result<Scores> {
    let maps: Vec<RadioMap<'_>> = maps
        .iter()
        .map(|bytes| RadioMap::new(bytes))
        .collect::<Result<_, _>>()?;
    let (lowest, above) = maps.split_first().context("no map")?;
    let above: Vec<Storey<'_>> = above
        .iter()
        .map(|map| Storey {
            map: *map,
            walls: Walls::None,
        })
        .collect();
    let stairs = corners(&STAIRS);
    let passage = |floors| Passage {
        place: Zone {
            id: 0,
            floor: 0,
            corners: &stairs,
        },
        floors,
        seconds: STAIRS_S,
    };
    let passages = [passage(&[0, 1]), passage(&[1, 2])];
    let site = Site {
        lowest: Floor::new(*lowest, config)?,
        above: &above,
        passages: &passages,
    };
    site.check()?;
    let shapes: Vec<Vec<_>> = building
        .rooms
        .iter()
        .map(|rooms| rooms.iter().map(corners).collect())
        .collect();
    let rooms = zones(&shapes);
    let mut rng = Xoshiro128PlusPlus::seed_from_u64(seed);
    let mut workspace = Box::new(Workspace::<PARTICLES, POINTS, u8>::EMPTY);
    let mut tracker = BuildingTracker::<PARTICLES, BEACONS, 2>::EMPTY;
    let mut scores = Scores::default();
    let mut packets = walk.packets.iter().peekable();
    for second in 1..=SECONDS as usize {
        let time = second as f64;
        while let Some(packet) = packets.next_if(|packet| packet.time < time) {
            let heard = Reading {
                beacon: packet.beacon as u8,
                rssi_dbm: packet.level as f32,
            };
            let time_ms = (1e3 * packet.time) as u32;
            match tracker.push(time_ms, heard, &site, &mut workspace, &mut rng) {
                Ok(_) | Err(ReadingError::Strength) => {}
                Err(error) => return Err(error.into()),
            }
        }
        tracker.flush(&site, &mut workspace, &mut rng);
        if time < FIRST_S {
            continue;
        }
        score(&mut scores, &tracker, &site, &rooms, walk, time)?;
    }
    Ok(scores)
}

/// Scores a second: by where the tag was at the time of the fix.
fn score(
    scores: &mut Scores,
    tracker: &BuildingTracker<PARTICLES, BEACONS, 2>,
    site: &Site<'_>,
    rooms: &[Zone<'_>],
    walk: &Walk,
    time: f64,
) -> Result<()> {
    let fix = tracker
        .fix()
        .with_context(|| format!("no fix at {time} s"))?;
    let place = walk.at(1e-3 * f64::from(fix.time_ms));
    let is_level = place.height.fract() == 0.0;
    scores.seconds += 1.0;
    scores.level += f64::from(is_level);
    for floor in 0..FLOORS as u8 {
        let is_so = usize::from(floor) == place.floor();
        scores
            .floors
            .push((tracker.floor_probability(floor), is_so));
    }
    if tracker.floor().map(usize::from) == Some(place.floor()) {
        let before = walk.at(1e-3 * f64::from(fix.time_ms) - 1.0);
        let is_at_rest = usize::from(before.position == place.position);
        let within = |p| fix.contains(place.position.map(|metres| metres as f32), p);
        scores.ellipses[is_at_rest] = scores.ellipses[is_at_rest].add(Held {
            seconds: 1.0,
            held: ELLIPSES.map(|p| f64::from(u8::from(within(p)))),
        });
        scores.right_floor += 1.0;
        scores.right_on_level += f64::from(is_level);
    }
    let mut likeliest = (0.0, false);
    for room in rooms {
        let is_so = usize::from(room.floor) == place.floor()
            && room.contains(place.position.map(|metres| metres as f32));
        let probability = tracker.probability_in(room, site).unwrap_or(0.0);
        if probability > likeliest.0 {
            likeliest = (probability, is_so);
        }
        if probability > 0.0 || is_so {
            scores.rooms.push((probability, is_so));
        }
    }
    scores.right_room += f64::from(likeliest.1);
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tags_are_on_the_right_floor() {
        let all = (0..4).map(|run| in_building(1, run, Config::DEFAULT).unwrap());
        let scores = all.fold(Scores::default(), Scores::add);
        for figure in summary("default", &scores) {
            println!("{}: {:.4}", figure.name, figure.value);
            assert!(figure.ok() && figure.value < 0.25, "{figure:?}");
        }
    }
}
