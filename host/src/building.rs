//! A simulated building: three floors of rooms along a corridor, an open stairwell, beacons, a survey and walks.
//!
//! The radio channel is that of the simulated tunnel, with ceilings: a path loss of -40 - 25 log10 d, shadowing that stays in
//! its place, and noise that is new in every packet. A ceiling takes 13 to 20 dB, drawn for each; through the stairwell, which
//! is open, a level takes the longer way and loses less.

use std::f64::consts::TAU;

use rand::{Rng, RngExt};

use foxhunt_simulation::{
    random::normal,
    survey::Survey,
    tunnel::{Packet, Shadow},
};

/// Floors.
pub const FLOORS: usize = 3;
/// Metres along x and along y, from zero.
pub const EXTENT: [f64; 2] = [36.0, 12.0];
/// The corridor reaches over the whole length between these, along y.
pub const CORRIDOR: [f64; 2] = [5.0, 7.0];
/// The stairwell is beside the corridor at its beginning: its least and its largest coordinates.
pub const STAIRS: [[f64; 2]; 2] = [[0.0, 7.0], [3.0, 12.0]];
/// Beacons on every floor, in metres.
const BEACONS: [[f64; 2]; 5] = [
    [4.0, 2.0],
    [10.0, 10.0],
    [18.0, 2.0],
    [26.0, 10.0],
    [33.0, 2.0],
];
/// Metres from floor to floor.
const STOREY: f64 = 3.0;
/// What a ceiling takes off a level, in dB.
const CEILING: [f64; 2] = [13.0, 20.0];
/// What a level loses from one floor to the next in the stairwell, in dB, and on its way in and out.
const STAIRWELL: f64 = 3.0;
/// Standard deviation of the shadowing, in dB, and the distance over which it falls to 1 / e, in metres.
const SHADOWING: [f64; 2] = [4.0, 3.0];
/// Standard deviation of a packet, in dB.
const NOISE: f64 = 4.0;
/// A tag on the chest is louder ahead than behind: half the difference, in dB. In the survey it is turned round.
const BODY: f64 = 3.0;
/// The weakest level that is heard, in dBm, and the fraction of the others that is lost.
const SENSITIVITY: f64 = -95.0;
const LOSS: f64 = 0.2;
/// Metres between the places of the survey, and packets of each beacon there.
const GRID: f64 = 1.5;
const READINGS: u32 = 6;
/// Seconds from one packet of a beacon to the next.
const INTERVAL: f64 = 0.5;

/// A room: its least and its largest coordinates, in metres.
pub type Room = [[f64; 2]; 2];

/// A building with its ceilings, rooms and shadowing drawn.
#[derive(Debug, Clone)]
pub struct Building {
    /// What each ceiling takes, from the lowest.
    ceilings: [f64; FLOORS - 1],
    /// By floor, the rooms: of 3 to 6 m along x, 5 m deep. The corridor is the first, the stairwell the second.
    pub rooms: [Vec<Room>; FLOORS],
    /// By beacon, then by floor.
    shadows: Vec<[Shadow; FLOORS]>,
}

/// Where somebody is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Place {
    /// In metres.
    pub position: [f64; 2],
    /// In floors from the lowest; between two on the stairs.
    pub height: f64,
}

impl Place {
    /// The number of the nearest floor.
    pub fn floor(&self) -> usize {
        self.height.round() as usize
    }
}

/// A walk, as the beacons' packets were heard.
#[derive(Debug, Clone)]
pub struct Walk {
    /// Where somebody was, twice a second from the start.
    pub places: Vec<Place>,
    /// In the order of time.
    pub packets: Vec<Packet>,
}

impl Walk {
    /// Where somebody was at a time, in seconds.
    pub fn at(&self, time: f64) -> Place {
        let step = (time / INTERVAL).round() as usize;
        self.places[step.min(self.places.len() - 1)]
    }
}

impl Building {
    /// All beacons, floor by floor.
    pub const BEACONS: usize = FLOORS * BEACONS.len();

    /// Draws a building.
    pub fn draw(rng: &mut impl Rng) -> Self {
        let ceilings = [0; FLOORS - 1].map(|_| rng.random_range(CEILING[0]..CEILING[1]));
        let rooms = [0; FLOORS].map(|_| {
            let mut rooms = vec![[[0.0, CORRIDOR[0]], [EXTENT[0], CORRIDOR[1]]], STAIRS];
            for (from, [low, high]) in [
                (0.0, [0.0, CORRIDOR[0]]),
                (STAIRS[1][0], [CORRIDOR[1], EXTENT[1]]),
            ] {
                let mut x = from;
                while x < EXTENT[0] {
                    // The last room takes what would be too narrow for another.
                    let width = rng.random_range(3.0..6.0);
                    let left = EXTENT[0] - x;
                    let width = if left < 6.0 {
                        left
                    } else {
                        f64::min(width, left - 3.0)
                    };
                    rooms.push([[x, low], [x + width, high]]);
                    x += width;
                }
            }
            rooms
        });
        let [sigma, correlation] = SHADOWING;
        let shadows = (0..Self::BEACONS)
            .map(|_| [0; FLOORS].map(|_| Shadow::draw(EXTENT, sigma, correlation, rng)))
            .collect();
        Self {
            ceilings,
            rooms,
            shadows,
        }
    }

    /// The level of a beacon, in dBm, on a floor.
    fn level_on(&self, beacon: usize, position: [f64; 2], floor: usize) -> f64 {
        let (own, place) = (beacon / BEACONS.len(), BEACONS[beacon % BEACONS.len()]);
        let floors = own.abs_diff(floor) as f64;
        let between = own.min(floor)..own.max(floor);
        let ceilings: f64 = self.ceilings[between].iter().sum();
        let along = (position[0] - place[0]).hypot(position[1] - place[1]);
        let direct = path_loss(along.hypot(STOREY * floors)) - ceilings;
        let level = if floors > 0.0 {
            let stairs = [0, 1].map(|axis| 0.5 * (STAIRS[0][axis] + STAIRS[1][axis]));
            let to = |[x, y]: [f64; 2]| (x - stairs[0]).hypot(y - stairs[1]);
            let way = to(position) + to(place) + STOREY * floors;
            sum_of(direct, path_loss(way) - STAIRWELL * (floors + 1.0))
        } else {
            direct
        };
        level + self.shadows[beacon][floor].at(position)
    }

    /// The level of a beacon, in dBm, anywhere.
    fn level(&self, beacon: usize, place: &Place) -> f64 {
        let below = (place.height as usize).min(FLOORS - 2);
        let fraction = place.height - below as f64;
        let [low, high] = [below, below + 1].map(|f| self.level_on(beacon, place.position, f));
        low + fraction * (high - low)
    }

    /// A packet of a beacon, in whole dBm, if it is heard by somebody who is turned to a direction.
    fn packet(
        &self,
        beacon: usize,
        place: &Place,
        heading: f64,
        rng: &mut impl Rng,
    ) -> Option<f64> {
        let to = BEACONS[beacon % BEACONS.len()];
        let to = (to[1] - place.position[1]).atan2(to[0] - place.position[0]);
        let body = BODY * (to - heading).cos();
        let level = self.level(beacon, place) + body + NOISE * normal(rng);
        let lost = rng.random_bool(LOSS) || level < SENSITIVITY;
        (!lost).then_some(level.round())
    }

    /// A survey of a floor.
    pub fn survey(&self, floor: usize, rng: &mut impl Rng) -> Survey {
        let mut survey = Survey::default();
        let [columns, rows] = EXTENT.map(|metres| (metres / GRID) as usize);
        for n in 0..columns * rows {
            let cell = [n % columns, n / columns];
            let place = Place {
                position: cell.map(|number| GRID * (number as f64 + 0.5)),
                height: floor as f64,
            };
            let of_beacon = |beacon| {
                let readings = 0..READINGS;
                readings
                    .filter_map(|reading| {
                        let heading = TAU * f64::from(reading) / f64::from(READINGS);
                        self.packet(beacon, &place, heading, rng)
                    })
                    .collect()
            };
            survey.places.push(place.position);
            survey
                .samples
                .push((0..Self::BEACONS).map(of_beacon).collect());
        }
        survey
    }

    /// A walk of so many seconds: to rooms on any floor, where somebody stays for a while.
    pub fn walk(&self, seconds: f64, rng: &mut impl Rng) -> Walk {
        let mut places = vec![self.anywhere(rng)];
        let steps = (seconds / INTERVAL) as usize + 1;
        while places.len() < steps {
            let to = self.anywhere(rng);
            self.go(&mut places, to, rng);
            stay(&mut places, rng.random_range(5.0..40.0));
        }
        places.truncate(steps);
        let mut packets = Vec::new();
        let mut heading = rng.random_range(0.0..TAU);
        for (step, place) in places.iter().enumerate() {
            let before = places[step.saturating_sub(1)].position;
            let moved = [0, 1].map(|axis| place.position[axis] - before[axis]);
            if moved != [0.0; 2] {
                heading = moved[1].atan2(moved[0]);
            }
            for beacon in 0..Self::BEACONS {
                if let Some(level) = self.packet(beacon, place, heading, rng) {
                    packets.push(Packet {
                        time: INTERVAL * (step as f64 + beacon as f64 / Self::BEACONS as f64),
                        beacon,
                        level,
                    });
                }
            }
        }
        Walk { places, packets }
    }

    /// A place in a room, half a metre from its walls.
    fn anywhere(&self, rng: &mut impl Rng) -> Place {
        let floor = rng.random_range(0..FLOORS);
        let rooms = &self.rooms[floor][2..];
        let [least, most] = rooms[rng.random_range(0..rooms.len())];
        Place {
            position: [0, 1].map(|axis| rng.random_range(least[axis] + 0.5..most[axis] - 0.5)),
            height: floor as f64,
        }
    }

    /// Goes through the doors, along the corridor, and by the stairs if it must.
    fn go(&self, places: &mut Vec<Place>, to: Place, rng: &mut impl Rng) {
        let speed = rng.random_range(0.7..1.4);
        let corridor = 0.5 * (CORRIDOR[0] + CORRIDOR[1]);
        let from = places.last().copied().unwrap_or(to);
        let mut way = vec![[from.position[0], corridor]];
        if from.height != to.height {
            let [door, foot] = [[1.5, corridor], [1.5, STAIRS[0][1] + 1.0]];
            way.extend([door, foot]);
            walk_to(places, &way, speed);
            climb(places, to.height, rng.random_range(12.0..18.0));
            way = vec![foot, door];
        }
        way.extend([[to.position[0], corridor], to.position]);
        walk_to(places, &way, speed);
    }
}

/// Level in dBm at so many metres.
fn path_loss(metres: f64) -> f64 {
    -40.0 - 25.0 * metres.max(1.0).log10()
}

/// The level of two signals together.
fn sum_of(a: f64, b: f64) -> f64 {
    10.0 * (10f64.powf(0.1 * a) + 10f64.powf(0.1 * b)).log10()
}

fn stay(places: &mut Vec<Place>, seconds: f64) {
    if let Some(place) = places.last().copied() {
        places.extend(std::iter::repeat_n(place, (seconds / INTERVAL) as usize));
    }
}

/// Straight from each corner of the way to the next.
fn walk_to(places: &mut Vec<Place>, way: &[[f64; 2]], speed: f64) {
    for to in way {
        let Some(from) = places.last().copied() else {
            return;
        };
        let [dx, dy] = [to[0] - from.position[0], to[1] - from.position[1]];
        let steps = (dx.hypot(dy) / (speed * INTERVAL)).ceil().max(1.0);
        places.extend((1..=steps as usize).map(|step| {
            let fraction = step as f64 / steps;
            Place {
                position: [
                    from.position[0] + fraction * dx,
                    from.position[1] + fraction * dy,
                ],
                ..from
            }
        }));
    }
}

/// Up or down in the stairwell, so many seconds a floor: to its end and back again for each.
fn climb(places: &mut Vec<Place>, to: f64, seconds: f64) {
    let Some(foot) = places.last().copied() else {
        return;
    };
    let floors = (to - foot.height).abs();
    let steps = (floors * seconds / INTERVAL).ceil();
    places.extend((1..=steps as usize).map(|step| {
        let done = floors * step as f64 / steps;
        let turn = 1.0 - (2.0 * (done % 1.0) - 1.0).abs();
        Place {
            position: [foot.position[0], foot.position[1] + 3.0 * turn],
            height: foot.height + done * (to - foot.height).signum(),
        }
    }));
}

#[cfg(test)]
mod tests {
    use super::*;
    use foxhunt_simulation::random::generator;

    #[test]
    fn rooms_fill_the_floors_and_walks_stay_in_them() {
        for run in 0..20 {
            let mut rng = generator(3, run);
            let building = Building::draw(&mut rng);
            for rooms in &building.rooms {
                let area = |[a, b]: &Room| (b[0] - a[0]) * (b[1] - a[1]);
                let sum: f64 = rooms.iter().map(area).sum();
                assert!((sum - EXTENT[0] * EXTENT[1]).abs() < 1e-9, "{sum}");
                for [a, b] in &rooms[2..] {
                    assert!((3.0..=6.0 + 1e-9).contains(&(b[0] - a[0])));
                }
            }
            let walk = building.walk(600.0, &mut rng);
            assert_eq!(walk.places.len(), 1201);
            for pair in walk.places.windows(2) {
                let [a, b] = [pair[0], pair[1]];
                let moved = [0, 1].map(|axis| b.position[axis] - a.position[axis]);
                assert!(moved[0].hypot(moved[1]) < 0.8, "{a:?} {b:?}");
                let in_stairs = b.position[0] < 3.0 && b.position[1] > 7.0;
                assert!(a.height == b.height || in_stairs, "{b:?}");
                assert!((0.0..=2.0).contains(&b.height));
            }
        }
    }

    #[test]
    fn a_ceiling_takes_its_decibels_far_from_the_stairs_and_less_near_them() {
        let mut rng = generator(4, 0);
        let mut sums = [0.0; 2];
        for _ in 0..200 {
            let building = Building::draw(&mut rng);
            for (sum, (beacon, place)) in sums.iter_mut().zip([(4, [30.0, 2.0]), (0, [1.5, 8.0])]) {
                let [own, above] = [0, 1].map(|floor| building.level_on(beacon, place, floor));
                *sum += (own - above) / 200.0;
            }
        }
        assert!((13.0..25.0).contains(&sums[0]), "{sums:?}");
        assert!((5.0..14.0).contains(&sums[1]), "{sums:?}");
    }
}
