//! The gateway of a tunnel, a floor or a building, of any size.

use foxhunt::{
    fingerprint::{
        RadioMap, Zone,
        tracker::{Building, Ground, Passage, Site, Stored, Storey, Walls},
    },
    gateway::beacon::{BeaconGateway, BuildingGateway, Config, Event},
};

/// The most points and beacons of a map of one floor, and of those of all floors of a building.
pub const POINTS: usize = 4096;
pub const BEACONS: usize = 16;
pub const POINTS_OF_ALL: usize = 16_384;
pub const BEACONS_OF_ALL: usize = 64;

/// With as many tags and particles as the firmware of a tunnel.
type OneFloor<const D: usize> = BeaconGateway<64, 300, POINTS, BEACONS, D>;
type Floors<const D: usize> = BuildingGateway<64, 300, POINTS_OF_ALL, BEACONS_OF_ALL, D>;

/// A gateway of any kind of site, with its configuration.
pub trait Gateway {
    /// Takes a byte.
    fn push(&mut self, byte: u8) -> Option<Event>;

    /// What to send for the last message.
    fn report(&self) -> &str;

    /// The floor and the room of a tag.
    fn within(&self, tag: u32, rooms: &[Zone<'_>]) -> Within;
}

/// What is known of where a tag is, beside its place.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Within {
    /// The likeliest floor, where there are several, and its probability.
    pub floor: Option<(u8, f32)>,
    /// The number of the likeliest room, if it is in any, and its probability.
    pub room: Option<(usize, f32)>,
}

/// Of a site of one floor.
pub fn of_floor(config: Config<Site<'static>>) -> Box<dyn Gateway + Send> {
    match config.site.map.lattice().axes() {
        1 => Box::new((OneFloor::<1>::EMPTY, config)),
        _ => Box::new((OneFloor::<2>::EMPTY, config)),
    }
}

/// Of a building whose lowest floor is that of a configuration.
///
/// # Errors
/// If floors do not belong together, or passages join none.
pub fn of_building(
    lowest: &Config<Site<'static>>,
    above: Vec<RadioMap<'static>>,
    passages: Vec<Passage<'static>>,
) -> anyhow::Result<Box<dyn Gateway + Send>> {
    let walls = Walls::None;
    let above: Vec<_> = above.into_iter().map(|map| Storey { map, walls }).collect();
    let building = Building {
        lowest: lowest.site,
        above: above.leak(),
        passages: passages.leak(),
    };
    let config = Config {
        framing: lowest.framing,
        ..Config::new(building)
    };
    config.check()?;
    let lattice = lowest.site.map.lattice();
    let points = lattice.points() * (building.above.len() + 1);
    anyhow::ensure!(
        points <= POINTS_OF_ALL && lowest.site.map.beacons() <= BEACONS_OF_ALL,
        "a building has {POINTS_OF_ALL} points and {BEACONS_OF_ALL} beacons at most"
    );
    Ok(match lattice.axes() {
        1 => Box::new((Floors::<1>::EMPTY, config)),
        _ => Box::new((Floors::<2>::EMPTY, config)),
    })
}

impl<const P: usize, const B: usize, const D: usize, S: Stored, G: Ground<Floor = S::Floor>> Gateway
    for (BeaconGateway<64, 300, P, B, D, S>, Config<G>)
{
    fn push(&mut self, byte: u8) -> Option<Event> {
        let (gateway, config) = self;
        gateway.push(byte, config)
    }

    fn report(&self) -> &str {
        self.0.report()
    }

    fn within(&self, tag: u32, rooms: &[Zone<'_>]) -> Within {
        let (gateway, Config { site, .. }) = self;
        let Some((_, tracker)) = gateway.tags().find(|(known, _)| *known == tag) else {
            return Within::default();
        };
        let floor = tracker.floor().filter(|_| site.floors() > 1);
        let probable = (rooms.iter().enumerate())
            .filter_map(|(number, room)| Some((number, tracker.probability_in(room, site)?)))
            .filter(|(_, probability)| *probability > 0.0);
        Within {
            floor: floor.map(|floor| (floor, tracker.floor_probability(floor))),
            room: probable.max_by(|(_, one), (_, other)| one.total_cmp(other)),
        }
    }
}
