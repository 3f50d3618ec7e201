//! The gateway of a tunnel, a floor or a building, of any size.

use foxhunt::{
    fingerprint::{
        RadioMap, Zone,
        tracker::{Building, Ground, OnFloor, Packed, Passage, Site, Stored, Storey, Walls},
    },
    gateway::beacon::{BeaconGateway, Config, Event},
};

/// The most points and beacons of a map of one floor, and of those of all floors of a building.
pub const POINTS: usize = 4096;
pub const BEACONS: usize = 16;
pub const POINTS_OF_ALL: usize = 16_384;
pub const BEACONS_OF_ALL: usize = 64;

/// With as many tags and particles as the firmware of a tunnel.
type OneFloor<const D: usize> = BeaconGateway<64, 300, POINTS, BEACONS, D>;
type Floors<const D: usize> =
    BeaconGateway<64, 300, POINTS_OF_ALL, BEACONS_OF_ALL, D, OnFloor<Packed<D>>>;

/// One for each kind of site.
pub enum Gateways {
    Line(Box<OneFloor<1>>, Config<Site<'static>>),
    Plane(Box<OneFloor<2>>, Config<Site<'static>>),
    Lines(Box<Floors<1>>, Config<Building<'static>>),
    Planes(Box<Floors<2>>, Config<Building<'static>>),
}

/// What is known of where a tag is, beside its place.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Within {
    /// The likeliest floor, where there are several, and its probability.
    pub floor: Option<(u8, f32)>,
    /// The number of the likeliest room, if it is in any, and its probability.
    pub room: Option<(usize, f32)>,
}

impl Gateways {
    /// Of a site of one floor.
    pub fn of_floor(config: Config<Site<'static>>) -> Self {
        match config.site.map.lattice().axes() {
            1 => Self::Line(Box::new(BeaconGateway::EMPTY), config),
            _ => Self::Plane(Box::new(BeaconGateway::EMPTY), config),
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
    ) -> anyhow::Result<Self> {
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
            1 => Self::Lines(Box::new(BeaconGateway::EMPTY), config),
            _ => Self::Planes(Box::new(BeaconGateway::EMPTY), config),
        })
    }

    /// Takes a byte.
    pub fn push(&mut self, byte: u8) -> Option<Event> {
        match self {
            Self::Line(gateway, config) => gateway.push(byte, config),
            Self::Plane(gateway, config) => gateway.push(byte, config),
            Self::Lines(gateway, config) => gateway.push(byte, config),
            Self::Planes(gateway, config) => gateway.push(byte, config),
        }
    }

    /// What to send for the last message.
    pub fn report(&self) -> &str {
        match self {
            Self::Line(gateway, _) => gateway.report(),
            Self::Plane(gateway, _) => gateway.report(),
            Self::Lines(gateway, _) => gateway.report(),
            Self::Planes(gateway, _) => gateway.report(),
        }
    }

    /// The floor and the room of a tag.
    pub fn within(&self, tag: u32, rooms: &[Zone<'_>]) -> Within {
        match self {
            Self::Line(gateway, config) => within(gateway, &config.site, tag, rooms),
            Self::Plane(gateway, config) => within(gateway, &config.site, tag, rooms),
            Self::Lines(gateway, config) => within(gateway, &config.site, tag, rooms),
            Self::Planes(gateway, config) => within(gateway, &config.site, tag, rooms),
        }
    }
}

fn within<const P: usize, const B: usize, const D: usize, S: Stored>(
    gateway: &BeaconGateway<64, 300, P, B, D, S>,
    site: &impl Ground,
    tag: u32,
    rooms: &[Zone<'_>],
) -> Within {
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
