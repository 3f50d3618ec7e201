//! No input makes the gateway fail, and a rejected message changes nothing.

use foxhunt::aoa::{Clean, Locate, clean};
use foxhunt::gateway::{self, Config, Counters, Event, Rejected};
use proptest::prelude::*;

type Locator = Clean<50, 16>;
type Gateway = gateway::Gateway<Locator>;

fn gateway() -> Gateway {
    Gateway::new(Config::new(clean::Config::DEFAULT)).unwrap()
}

fn sentence(payload: &str) -> String {
    let checksum = payload.bytes().fold(0, |sum, byte| sum ^ byte);
    format!("${payload}*{checksum:02X}\r\n")
}

/// A drive east at 25 m/s past a source 800 m to the north: RMC, a heading, one bearing of each kind a second.
fn drive() -> Vec<u8> {
    // The first position waits for the second.
    let mut text = sentence("GPRMC,115959.00,A,4807.038,N,01131.000000,E,48.6,090.0,221126,,,A");
    for second in 0..20 {
        let east = 25.0 * f64::from(second);
        // A minute of longitude is 1,240 m there.
        let minutes = 31.0 + east / 1_240.0;
        text += &sentence(&format!(
            "GPRMC,1200{second:02}.00,A,4807.038,N,011{minutes:09.6},E,48.6,090.0,221126,,,A"
        ));
        text += &sentence("HEHDT,90.0,T");
        let relative = (0.0 - 800.0_f64)
            .atan2(250.0 - east)
            .to_degrees()
            .rem_euclid(360.0);
        let time = 1_795_348_800_100_i64 + i64::from(second) * 1_000;
        let spectrum: Vec<String> = (0..360)
            .map(|degree| {
                let off = (f64::from(degree) + relative + 180.0).rem_euclid(360.0) - 180.0;
                format!("{:.2}", (20.0 - 0.05 * off * off).max(0.0))
            })
            .collect();
        let spectrum = spectrum.join(", ");
        text += &format!(
            "{time}, {relative:.1}, 9.0, -30, 433920000, UCA, 224, fox, 0, 0, 0, 0, GPS, R, R, R, R, {spectrum}\n"
        );
        text += &format!("%{:03}/7\r", relative as u32 % 360);
    }
    text += &sentence("PFOXQ");
    text.into_bytes()
}

/// Everything that a gateway has sent.
fn run<'a>(gateway: &mut Gateway, bytes: impl IntoIterator<Item = &'a u8>) -> String {
    let mut output = String::new();
    for byte in bytes {
        if gateway.push(0, *byte).is_some() {
            output += gateway.vehicle().report();
        }
    }
    output
}

/// All that the locator knows, bit by bit.
fn state(locator: &Locator) -> (Vec<u32>, String) {
    let [east, north] = locator.columns();
    let columns = [east, north, locator.weights()];
    let observations: Vec<_> = locator.observations().collect();
    let bits = columns.into_iter().flatten().map(|v| v.to_bits()).collect();
    (bits, format!("{observations:?} {:?}", locator.answer()))
}

/// The lines by what became of them, added up.
fn counted(counters: &Counters) -> u32 {
    let used = counters.sentences + counters.bearings + counters.ignored;
    let asked = counters.queries + counters.restarts;
    let rejected = Rejected::ALL.map(|reason| counters.rejected(reason));
    used + asked + rejected.iter().sum::<u32>()
}

/// Every report is a sentence with a correct checksum.
fn check(output: &str) {
    for line in output.split_terminator("\r\n") {
        let (payload, checksum) = line[1..].split_once('*').expect("a checksum");
        assert!(line.starts_with("$PFOX") && line.is_ascii(), "{line}");
        assert_eq!(sentence(payload), format!("${payload}*{checksum}\r\n"));
    }
}

#[test]
fn the_drive_is_located() {
    let mut gateway = gateway();
    let output = run(&mut gateway, &drive());
    check(&output);
    let fix = output.lines().rev().nth(1).unwrap();
    assert!(fix.starts_with("$PFOXF,120019.000,4807."), "{fix}");
    assert_eq!(gateway.vehicle().counters().bearings, 40);
    assert_eq!(
        counted(gateway.vehicle().counters()),
        gateway.vehicle().counters().lines
    );
    // One report a second, and the two that answer the query.
    assert_eq!(output.lines().count(), 20 + 2);
}

proptest! {
    #[test]
    fn any_bytes(bytes in prop::collection::vec(any::<u8>(), 0..20_000)) {
        check(&run(&mut gateway(), &bytes));
    }

    /// Closer to real lines than random bytes.
    #[test]
    fn any_text(lines in prop::collection::vec(
        "(\\$(GP|HE|PF)(RMC|GGA|VTG|HDT|THS|OXQ|OXR),|%|1[0-9]{12},)[-+.,0-9ANSEWTKM/*]{0,100}[\r\n]", 0..100)
    ) {
        check(&run(&mut gateway(), lines.concat().as_bytes()));
    }

    /// Sentences of every kind, some damaged, some interrupted, and junk.
    #[test]
    fn every_line_is_counted_once(lines in prop::collection::vec(
        (0usize..15, any::<prop::sample::Index>(), any::<bool>()), 0..60)
    ) {
        let time = 1_795_348_800_100_i64;
        let kinds = [
            sentence("GPRMC,120000.00,A,4807.038,N,01131.000,E,48.6,090.0,221126,,,A"),
            sentence("GPRMC,120001.00,V,,,,,,,221126,,,N"),
            sentence("HEHDT,90.0,T"),
            sentence("GPGSV,1,1,00"),
            sentence("PFOXQ"),
            sentence("PFOXR"),
            "%045/9\r".into(),
            format!("{time}, 45, 90.0, -30, 433920000, UCA, 224, fox, 0, 0, 0, 0, GPS, R, R, R, R, 1\n"),
            "+UUDF:6C1DEBA4241B,-65,26,-65,6,37,\"\",\"\",1\r\n".into(),
            "?\n".into(),
            sentence("HCHDG,98.3,0.0,E,12.6,W"),
            "!AIVDM,1,1,,A,15RTgt0PAso;90TKcjM8h6g208CQ,0*4A\r\n".into(),
            format!("C0450999084{time:015}\r\n"),
            "N0CALL>APRS:=4807.04N/01131.00E\\088/036/045/729\r\n".into(),
            "".into(),
        ];
        // An acknowledgement, of which no byte is the end of a line.
        let frame = [0xB5, 0x62, 0x05, 0x01, 0x02, 0x00, 0x06, 0x41, 0x4F, 0x78];
        let mut gateway = gateway();
        let mut events = 0;
        for (kind, cut, is_cut) in lines {
            let line = kinds[kind].as_bytes();
            let line = if line.is_empty() { &frame[..] } else { line };
            let line = if is_cut { &line[..cut.index(line.len())] } else { line };
            events += line.iter().filter(|byte| gateway.push(0, **byte).is_some()).count();
        }
        events += usize::from(gateway.push(0, b'\n').is_some());
        let counters = gateway.vehicle().counters();
        prop_assert_eq!(counters.lines as usize, events);
        prop_assert_eq!(counted(counters), counters.lines);
        for byte in sentence("PFOXQ").bytes() {
            gateway.push(0, byte);
        }
        let (_, status) = gateway.vehicle().report().split_once("$PFOXS,").unwrap();
        let counts = status.split('*').next().unwrap().split(',');
        let counts: Vec<u32> = counts.map(|count| count.parse().unwrap()).collect();
        prop_assert_eq!(counts[0], counts[1..].iter().sum::<u32>());
    }

    #[test]
    fn rejected_lines_leave_no_trace(
        flips in prop::collection::vec((any::<prop::sample::Index>(), 0..8), 1..200)
    ) {
        let mut bytes = drive();
        for (index, bit) in flips {
            let index = index.index(bytes.len());
            bytes[index] ^= 1u8 << bit;
        }
        let mut gateway = gateway();
        let mut output = String::new();
        let mut known = state(gateway.vehicle().locator());
        for byte in bytes {
            let event = gateway.push(0, byte);
            match event {
                Some(Event::Fix(_) | Event::NotObservable(_) | Event::Restarted) => known = state(gateway.vehicle().locator()),
                None => {}
                _ => prop_assert_eq!(&state(gateway.vehicle().locator()), &known),
            }
            if event.is_some() {
                output += gateway.vehicle().report();
            }
        }
        prop_assert_eq!(&state(gateway.vehicle().locator()), &known);
        check(&output);
    }

    /// Line ends may be CR, LF, or both, and empty lines mean nothing.
    #[test]
    fn line_ends_do_not_matter(ends in prop::collection::vec("(\r|\n|\r\n|\n\r\n\n)", 200)) {
        let drive = String::from_utf8(drive()).unwrap();
        let lines = drive.split(['\r', '\n']).filter(|line| !line.is_empty());
        let other: String = lines.zip(&ends).flat_map(|(line, end)| [line, end.as_str()]).collect();
        prop_assert_eq!(
            run(&mut gateway(), other.as_bytes()),
            run(&mut gateway(), drive.as_bytes())
        );
    }

    /// What was on the line before costs at most the line that it runs into.
    #[test]
    fn noise_before_a_drive(noise in prop::collection::vec(any::<u8>(), 0..500)) {
        let mut gateway = gateway();
        run(&mut gateway, &noise);
        gateway.vehicle_mut().restart();
        run(&mut gateway, &drive());
        prop_assert!(gateway.vehicle().counters().bearings >= 38);
    }
}
