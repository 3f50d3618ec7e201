//! A reset in the middle of a drive: the firmware `vehicle_kept` loses no more than what comes while it is down.

use std::time::Duration;

use anyhow::{Context, Result, ensure};
use foxhunt::{aoa::Fix, gateway::Event};
use foxhunt_gateways::kept;
use foxhunt_host::scripts::Script;

use crate::{
    board::{self, KEPT, QUERY, ensure_same},
    monitor::{Listener, Monitor},
    project,
    qemu::Machine,
};

/// Seconds of the drive between two sources: when the board is reset, and when it reads on.
const DOWN: [usize; 2] = [160, 163];

/// Fails unless the firmware goes on after a reset with what it knew, byte for byte as a gateway on the host does that is
/// restored; and unless that has a fix at the first bearing, about as large as the last, and one that begins anew has none.
pub fn compare() -> Result<()> {
    let scene = Script::TwoSources.scene(1);
    let seconds: Vec<&[u8]> = seconds(scene.drive.bytes()).collect();
    let (before, after) = (&seconds[..DOWN[0]], &seconds[DOWN[1]..]);
    let [before, after] = [before, after].map(|part| [&part.concat(), QUERY].concat());

    let mut first = Host::new(None)?;
    first.push(&before)?;
    let last = first.fixes.last().copied().flatten();
    let last = last.context("there is no fix before the reset")?;
    let mut second = Host::new(Some(&first.kept))?;
    second.push(&after)?;
    let next = second.fixes.first().copied().flatten();
    let next = next.context("there is no fix at the first bearing after the reset")?;
    let [old, new] = [last, next].map(|fix| fix.ellipse(0.95).semi_major);
    ensure!(
        new < 1.1 * old,
        "after the reset the fix is uncertain by {new} m instead of {old} m"
    );
    let mut cold = Host::new(None)?;
    cold.push(&after)?;
    ensure!(
        cold.fixes.first() == Some(&None),
        "one bearing makes a fix: nothing shows that any were kept"
    );

    let mut board = Board::boot()?;
    ensure_same(&board::answer(&mut board.machine, &before)?, &first.output)
        .context("before the reset")?;
    board.monitor.reset()?;
    ensure_same(&board::answer(&mut board.machine, &after)?, &second.output)
        .context("after the reset")
}

/// The lines of a drive by the second: each begins with the receiver's.
fn seconds(drive: &[u8]) -> impl Iterator<Item = &[u8]> {
    const BEGIN: &[u8] = b"$GPRMC";
    let begins = (0..drive.len()).filter(|&at| drive[at..].starts_with(BEGIN));
    let begins: Vec<usize> = begins.chain([drive.len()]).collect();
    let ranges = begins.windows(2).map(|pair| pair[0]..pair[1]);
    ranges
        .map(|range| &drive[range])
        .collect::<Vec<_>>()
        .into_iter()
}

/// A gateway on the host, and a snapshot of it after the last bearing.
struct Host {
    gateway: Box<kept::Gateway>,
    kept: Vec<u8>,
    output: Vec<u8>,
    /// At every bearing that was used.
    fixes: Vec<Option<Fix>>,
}

impl Host {
    fn new(kept: Option<&[u8]>) -> Result<Self> {
        let mut gateway = Box::new(kept::Gateway::EMPTY);
        if let Some(kept) = kept {
            gateway.restore(kept)?;
        }
        Ok(Self {
            gateway,
            kept: Vec::new(),
            output: Vec::new(),
            fixes: Vec::new(),
        })
    }

    fn push(&mut self, bytes: &[u8]) -> Result<()> {
        let mut buffer = vec![0; foxhunt::snapshot::largest::<kept::Gateway>()];
        for byte in bytes {
            let Some(event) = self.gateway.push(0, *byte, &kept::CONFIG) else {
                continue;
            };
            self.output.extend(self.gateway.report().as_bytes());
            let fix = match event {
                Event::Fix(fix) => Some(fix),
                Event::NotObservable(_) => None,
                _ => continue,
            };
            self.fixes.push(fix);
            self.kept = self.gateway.snapshot(&mut buffer)?.to_vec();
        }
        Ok(())
    }
}

/// The firmware in the emulator.
struct Board {
    machine: Machine,
    monitor: Monitor,
}

impl Board {
    fn boot() -> Result<Self> {
        let listener = Listener::new()?;
        let limit = Duration::from_secs(120);
        let monitor = ["-qmp", &listener.address()?];
        let machine = Machine::boot_with(&project::firmware(KEPT)?, limit, &monitor)?;
        let monitor = listener.accept()?;
        Ok(Self { machine, monitor })
    }
}
