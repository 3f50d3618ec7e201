//! The task `boards`: what the firmwares of real boards take, and where their drivers could panic.

use std::{
    collections::{BTreeMap, BTreeSet},
    path::PathBuf,
};

use anyhow::{Result, ensure};
use comfy_table::{Table, presets::ASCII_MARKDOWN};
use foxhunt::{
    aoa::Clean,
    gateway::beacon::{BeaconGateway, MAX_TAGS},
    snapshot::largest,
};
use foxhunt_gateways::plain;
use foxhunt_host::figures::Figure;

use crate::{
    expected::Expected,
    figures::{self, KIB},
    marks,
    measure::{
        panic_sites::{self, Site},
        sections::{self, Occupied},
    },
    project,
    setup::{self, Need},
};

/// The options of `cargo xtask boards`.
#[derive(clap::Args)]
pub struct Options {
    /// Write the figures as JSON, too.
    #[arg(long, value_name = "FILE")]
    json: Option<PathBuf>,
    /// Write the table into the README.
    #[arg(long)]
    bless: bool,
}

/// A firmware of a real board.
struct Firmware {
    /// What the figures begin with.
    name: &'static str,
    board: &'static str,
    folder: &'static str,
    binary: &'static str,
    features: &'static [&'static str],
    chip: Chip,
    job: Job,
    /// Whether it keeps snapshots, for which it has a buffer.
    keeps: bool,
    /// The most flash that it may take.
    flash_kib: f64,
    /// The most RAM, without the stack.
    ram_kib: f64,
}

/// What a chip has.
struct Chip {
    target: &'static str,
    flash_kib: u64,
    ram_kib: u64,
    megahertz: f64,
}

/// What a firmware does.
#[derive(Clone, Copy)]
enum Job {
    /// The gateway of a vehicle with `Clean`.
    Vehicle,
    /// That of a vehicle in a city.
    City,
    /// That of a tunnel.
    Tunnel,
    /// A radio of a tunnel.
    Radio,
}

const STM32F411: Chip = Chip {
    target: project::BOARD,
    flash_kib: 512,
    ram_kib: 128,
    megahertz: 84.0,
};

const RP2350: Chip = Chip {
    target: "thumbv8m.main-none-eabihf",
    flash_kib: 4_096,
    ram_kib: 512,
    megahertz: 150.0,
};

/// Half of its flash is for a map and snapshots.
const NRF52840: Chip = Chip {
    target: project::BOARD,
    flash_kib: 512,
    ram_kib: 256,
    megahertz: 64.0,
};

const FIRMWARES: [Firmware; 6] = [
    Firmware {
        name: "stm32f4.vehicle",
        board: "STM32F411",
        folder: "stm32f4",
        binary: "foxhunt-stm32f4",
        features: &[],
        chip: STM32F411,
        job: Job::Vehicle,
        keeps: false,
        flash_kib: 80.0,
        ram_kib: 24.0,
    },
    Firmware {
        name: "pico2.vehicle",
        board: "Raspberry Pi Pico 2",
        folder: "pico2",
        binary: "foxhunt-pico2",
        features: &[],
        chip: RP2350,
        job: Job::Vehicle,
        keeps: false,
        flash_kib: 112.0,
        ram_kib: 24.0,
    },
    Firmware {
        name: "pico2.city",
        board: "Raspberry Pi Pico 2",
        folder: "pico2",
        binary: "foxhunt-pico2",
        features: &["city"],
        chip: RP2350,
        job: Job::City,
        keeps: false,
        flash_kib: 216.0,
        ram_kib: 80.0,
    },
    Firmware {
        name: "nrf52840.vehicle",
        board: "nRF52840",
        folder: "nrf52840",
        binary: "vehicle",
        features: &[],
        chip: NRF52840,
        job: Job::Vehicle,
        keeps: true,
        flash_kib: 96.0,
        ram_kib: 28.0,
    },
    Firmware {
        name: "nrf52840.tunnel",
        board: "nRF52840",
        folder: "nrf52840",
        binary: "tunnel",
        features: &[],
        chip: NRF52840,
        job: Job::Tunnel,
        keeps: true,
        flash_kib: 112.0,
        ram_kib: 168.0,
    },
    Firmware {
        name: "nrf52840.radio",
        board: "nRF52840",
        folder: "nrf52840",
        binary: "radio",
        features: &[],
        chip: NRF52840,
        job: Job::Radio,
        keeps: false,
        flash_kib: 24.0,
        ram_kib: 6.0,
    },
];

/// What is kept free for the stack when more particles or tags are put in: as much as that of a city takes on the emulated
/// board, and as much again for drivers and interrupts.
const STACK_BYTES: f64 = 36.0 * KIB;

/// A firmware that was built.
struct Built<'a> {
    firmware: &'a Firmware,
    occupied: Occupied,
    sites: BTreeSet<Site>,
}

/// Measures all, prints it, and fails if a limit is missed or a line of this project could panic.
pub fn run(options: &Options) -> Result<()> {
    let cost = Expected::read()?;
    let built = FIRMWARES.iter().map(Built::new);
    let built: Vec<Built> = built.collect::<Result<_>>()?;
    let table = summary(&built, &cost)?.to_string();
    println!("{table}\n");
    println!("{}", panics(&built));
    let figures = built.iter().map(|built| built.figures(&cost));
    let figures = figures.collect::<Result<Vec<_>>>()?.concat();
    if let Some(file) = &options.json {
        figures::write_json(&figures, file)?;
    }
    let own: Vec<&str> = built.iter().flat_map(Built::own).collect();
    ensure!(
        own.is_empty(),
        "lines of this project could panic:\n  {}",
        own.join("\n  ")
    );
    marks::BOARDS.keep(&table, options.bless)?;
    figures::check(&figures)
}

/// The same as a check.
pub fn check() -> Result<()> {
    run(&Options {
        json: None,
        bless: false,
    })
}

/// The firmware of the STM32F411 for the emulator, which has no clocks to set up.
pub fn emulated_stm32f4() -> Result<PathBuf> {
    FIRMWARES[0].build(&["emulated"])
}

impl Firmware {
    fn folder(&self) -> PathBuf {
        project::root().join("boards").join(self.folder)
    }

    fn build(&self, features: &[&str]) -> Result<PathBuf> {
        setup::ensure(&[Need::Target(self.chip.target), Need::LlvmTools])?;
        let mut cargo = project::cargo();
        cargo.current_dir(self.folder());
        let features = features.join(",");
        let what = ["--release", "--locked", "--bin", self.binary];
        project::executable_by(cargo, &[&what[..], &["--features", &features]].concat())
    }

    /// How many of what it is about the RAM has room for.
    fn room(&self, occupied: &Occupied) -> Option<(&'static str, f64)> {
        let free = self.chip.ram_kib as f64 * KIB - occupied.ram as f64 - STACK_BYTES;
        match self.job {
            Job::Vehicle => {
                const BYTES: usize = size_of::<Clean<1_200, 64>>() - size_of::<Clean<200, 64>>();
                const SAVED: usize = largest::<Clean<1_200, 64>>() - largest::<Clean<200, 64>>();
                // That of the gateways.
                const { assert!(size_of::<plain::Locator>() == size_of::<Clean<200, 64>>()) };
                let saved = if self.keeps { SAVED } else { 0 };
                let each = (BYTES + saved) as f64 / 1_000.0;
                let particles = 200.0 + free / each;
                Some(("particles", 100.0 * (particles / 100.0).floor()))
            }
            Job::Tunnel => {
                type Tags<const T: usize> = BeaconGateway<T, 300, 512, 16, 1>;
                const BYTES: usize = size_of::<Tags<33>>() - size_of::<Tags<32>>();
                const SAVED: usize = largest::<Tags<33>>() - largest::<Tags<32>>();
                let tags = 32.0 + free / (BYTES + SAVED) as f64;
                Some(("tags", tags.floor().min(MAX_TAGS as f64)))
            }
            Job::City | Job::Radio => None,
        }
    }

    /// How often it could take a bearing, or the packets of a tag in half a second.
    fn updates(&self, cost: &Expected) -> Result<Option<f64>> {
        // Cycles for an instruction, as those of a locator take them.
        let pace = cost.figure("m4f.robust.n64.update.cycles_modelled")?
            / cost.figure("m4f.robust.n64.update.instructions")?;
        let cycles = match self.job {
            Job::Vehicle => cost.figure("vehicle.update.mean.instructions")? * pace,
            Job::City => cost.figure("vehicle.robust.update.mean.instructions")? * pace,
            Job::Tunnel => cost.figure("m4f.tracker.n300.update.cycles_modelled")?,
            Job::Radio => return Ok(None),
        };
        Ok(Some((self.chip.megahertz * 1e6 / cycles).floor()))
    }
}

impl<'a> Built<'a> {
    fn new(firmware: &'a Firmware) -> Result<Self> {
        let elf = firmware.build(firmware.features)?;
        let sites = panic_sites::find(&elf, &firmware.folder())?;
        // No driver is without.
        let name = firmware.name;
        ensure!(!sites.is_empty(), "no lines were found in {name}");
        Ok(Self {
            firmware,
            occupied: sections::occupied(&elf)?,
            sites,
        })
    }

    fn figures(&self, cost: &Expected) -> Result<Vec<Figure>> {
        let Firmware {
            name,
            flash_kib,
            ram_kib,
            ..
        } = self.firmware;
        let figure = |part: &str, value: f64, unit: &str| {
            Figure::new(format!("boards.{name}.{part}"), value, unit)
        };
        let bytes = |part: &str, bytes: u64, limit: f64| {
            figure(&format!("{part}.bytes"), bytes as f64, "bytes").at_most(limit)
        };
        let mut figures = vec![
            bytes("flash", self.occupied.flash, flash_kib * KIB),
            bytes("data", self.occupied.data, 256.0),
            bytes("ram", self.occupied.ram, ram_kib * KIB),
        ];
        let room = self.firmware.room(&self.occupied);
        figures.extend(room.map(|(what, number)| figure("room", number, what)));
        let updates = self.firmware.updates(cost)?;
        figures.extend(updates.map(|number| figure("updates.modelled", number, "1/s")));
        Ok(figures)
    }

    /// Lines of this project that could panic.
    fn own(&self) -> impl Iterator<Item = &str> {
        let own = |site: &&Site| !site.is_awaited && site.is_own();
        self.sites.iter().filter(own).map(|site| site.line.as_str())
    }
}

/// A table for people, in the form of the README.
fn summary(built: &[Built], cost: &Expected) -> Result<Table> {
    let mut table = Table::new();
    table.load_style(ASCII_MARKDOWN).set_header([
        "board",
        "firmware",
        "flash",
        "RAM",
        "room for",
        "updates a second",
    ]);
    for Built {
        firmware, occupied, ..
    } in built
    {
        let part =
            |bytes: u64, of_kib: u64| format!("{:.0} of {of_kib} KiB", (bytes as f64 / KIB).ceil());
        let room = firmware.room(occupied);
        let updates = firmware.updates(cost)?;
        let (_, job) = firmware.name.split_once('.').unwrap_or_default();
        table.add_row([
            firmware.board,
            job,
            &part(occupied.flash, firmware.chip.flash_kib),
            &part(occupied.ram, firmware.chip.ram_kib),
            &room.map_or(String::new(), |(what, number)| format!("{number} {what}")),
            &updates.map_or(String::new(), |number| number.to_string()),
        ]);
    }
    Ok(table)
}

/// How many lines of each crate could panic.
fn panics(built: &[Built]) -> Table {
    let mut table = Table::new();
    table
        .load_style(ASCII_MARKDOWN)
        .set_header(["firmware", "lines that could panic, by crate"]);
    for built in built {
        let mut owners: BTreeMap<&str, u32> = BTreeMap::new();
        let mut awaited = 0;
        for site in &built.sites {
            match site.is_awaited {
                true => awaited += 1,
                false => *owners.entry(&site.owner).or_default() += 1,
            }
        }
        let owners = owners
            .iter()
            .map(|(owner, lines)| format!("{owner} {lines}"));
        let mut owners: Vec<String> = owners.collect();
        if awaited > 0 {
            owners.push(format!("futures that have ended {awaited}"));
        }
        table.add_row([built.firmware.name, &owners.join(", ")]);
    }
    table
}
