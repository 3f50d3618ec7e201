//! What becomes of lines, and what is reported.

use super::*;
use crate::gateway::formats::Finder;

#[test]
fn only_the_configured_direction_finder_is_heard() {
    let fix = rmc("120000");
    let lines = [
        (Finder::Agrelo, String::from("%010/9\r")),
        (Finder::Kraken, kraken(NOON, 10.0, NOWHERE)),
        (
            Finder::Ublox,
            String::from("+UUDF:6C1DEBA4241B,-65,10,0,0,37,\"\",\"\",1\r"),
        ),
        (Finder::Kn5r, format!("C0100999084{NOON:015}\r")),
        (
            Finder::Aprs,
            String::from("N0CALL>APRS:=4807.04N/01131.00E\\088/036/010/729\r"),
        ),
    ];
    for (finder, line) in &lines {
        assert!(last_bearing(CONFIG, &format!("{fix}{line}")).is_ok());
        for (wanted, _) in &lines {
            let mut config = CONFIG;
            config.formats.finder = Some(*wanted);
            let heard = last_bearing(config, &format!("{fix}{line}"));
            let expected = if wanted == finder {
                Ok(())
            } else {
                Err(Rejected::OtherFinder)
            };
            assert_eq!(heard.map(|_| ()), expected);
        }
    }
}

#[test]
fn rejected_with_the_reason() {
    let fix = rmc("120000");
    let run = |text: String| last_bearing(CONFIG, &text);
    assert_eq!(run(format!("{fix}%010/3\r")), Err(Rejected::LowQuality));
    assert_eq!(run(format!("{fix}%361/9\r")), Err(Rejected::OutOfRange));
    assert_eq!(run(String::from("%010/9\r")), Err(Rejected::NoPosition));
    assert_eq!(run(format!("{fix}hello\r")), Err(Rejected::Unparsable));
    assert_eq!(
        run(format!("{fix}{}", rmc("115959"))),
        Err(Rejected::TimeBackwards)
    );
    let first = kraken(NOON, 10.0, NOWHERE);
    let second = kraken(NOON - 1, 10.0, NOWHERE);
    assert_eq!(
        run(format!("{fix}{first}{second}")),
        Err(Rejected::TimeBackwards)
    );
    // A thousand kilometres from the first bearing; and one that is first, but at the pole.
    let here = kraken(NOON, 10.0, "48.1, 11.5, 0, 0, GPS");
    let far = kraken(NOON, 10.0, "58.1, 11.5, 0, 0, GPS");
    assert_eq!(run(format!("{here}{far}")), Err(Rejected::OutOfRange));
    assert_eq!(
        run(kraken(NOON, 10.0, "89.9, 11.5, 0, 0, GPS")),
        Err(Rejected::OutOfRange)
    );
}

#[test]
fn reports_a_fix_and_its_status() {
    let mut gateway = gateway(CONFIG);
    push(&mut gateway, &drive(1));
    assert!(
        gateway
            .vehicle()
            .report()
            .starts_with("$PFOXN,120000.000,FEW,1,,*"),
        "{}",
        gateway.vehicle().report()
    );
    push(&mut gateway, &drive(10));
    let fix = String::from(gateway.vehicle().report());
    assert!(fix.starts_with("$PFOXF,120018.000,4807."), "{fix}");

    let queried = push(&mut gateway, "$PFOXQ*50\r\n");
    assert_eq!(queried, [Event::Queried]);
    let (again, status) = gateway.vehicle().report().split_at(fix.len());
    assert_eq!(again, fix);
    assert!(status.starts_with("$PFOXS,23,11,11,0,1,0,"), "{status}");

    // The next line takes the report away.
    push(&mut gateway, "\r\n%");
    assert!(!gateway.vehicle().report().is_empty());
    push(&mut gateway, "x\r\n");
    assert!(gateway.vehicle().report().is_empty());

    gateway.vehicle_mut().restart();
    push(&mut gateway, "$PFOXQ*50\r\n");
    assert!(
        gateway.vehicle().report().starts_with("$PFOXN,,FEW,0,,*"),
        "{}",
        gateway.vehicle().report()
    );
    push(&mut gateway, "%010/9\r");
    assert!(gateway.vehicle().report().contains(",FEW,1,,*"));
    assert_eq!(gateway.vehicle().counters().bearings, 12);

    let restarted = push(&mut gateway, "$PFOXR*53\r\n");
    assert_eq!(restarted, [Event::Restarted]);
    assert!(gateway.vehicle().report().starts_with("$PFOXN,,FEW,0,,*"));
    assert!(gateway.vehicle().plane().is_none());
}

#[test]
fn reports_are_rare() {
    let fix = rmc("120000");
    let mut gateway = gateway(CONFIG);
    push(&mut gateway, &fix);
    let mut reports = 0;
    for k in 0..20 {
        let time = NOON + i64::from(k) * 100;
        push(&mut gateway, &kraken(time, 10.0, NOWHERE));
        reports += usize::from(!gateway.vehicle().report().is_empty());
    }
    assert_eq!(reports, 2);
}

#[test]
fn a_heading_before_any_time_is_not_used() {
    let text = sentence("HEHDT,300.0,T") + &sentence("GPVTG,090.0,T,,M,050.0,N,92.6,K,A");
    let mut gateway = gateway(CONFIG);
    assert_eq!(
        push(&mut gateway, &text),
        [Event::Rejected(Rejected::NoFix); 2]
    );
    assert_eq!(gateway.vehicle().counters().sentences, 0);
    push(&mut gateway, &(rmc("120000") + &text));
    assert_eq!(gateway.vehicle().counters().sentences, 3);
}

#[test]
fn sentences_are_counted() {
    let config = CONFIG;
    let text = format!(
        "{}{}{}$GPHDT,1,T*00\r\n",
        rmc("120000"),
        sentence("GPGSV,1,1,00"),
        sentence("GPRMC,120001,A,0000.0,N,00000.0,E,0,,221126,,,A"),
    );
    let mut gateway = gateway(config);
    let events = push(&mut gateway, &text);
    let counters = gateway.vehicle().counters();
    assert_eq!(
        (counters.lines, counters.sentences, counters.ignored),
        (4, 1, 1)
    );
    assert_eq!(counters.rejected(Rejected::NullPosition), 1);
    assert_eq!(counters.rejected(Rejected::Checksum), 1);
    let kinds = [
        Event::Used,
        Event::Other,
        Event::Rejected(Rejected::NullPosition),
        Event::Rejected(Rejected::Checksum),
    ];
    assert_eq!(events, kinds);
}

#[test]
fn a_restored_gateway_goes_on() {
    use crate::snapshot::largest;
    let config = Config {
        report_interval_ms: 4_000,
        ..CONFIG
    };
    let lines = drive(12);
    // A sentence of the receiver and the bearing after it.
    let steps: Vec<&str> = lines.split_inclusive('\r').collect();
    let steps: Vec<String> = steps.chunks(2).map(|step| step.concat()).collect();
    assert_eq!(steps.len(), 12);
    let reports = |gateway: &mut Plain, steps: &[String]| -> Vec<String> {
        let report = |step: &String| {
            push(gateway, step);
            String::from(gateway.vehicle().report())
        };
        steps.iter().map(report).collect()
    };
    let mut buffer = [0; largest::<Vehicle<Clean<60, 16>>>()];
    let mut whole = gateway(config);
    let all = reports(&mut whole, &steps);
    push(&mut whole, "$PFOXQ*50\r\n");
    for step in 0..=steps.len() {
        let mut before = gateway(config);
        reports(&mut before, &steps[..step]);
        let before = before.vehicle();
        let bytes = before.snapshot(&mut buffer).unwrap();
        let mut after = gateway(Config { seed: 99, ..config });
        // What it hears before it is restored holds; what it is in the midst of, too.
        push(&mut after, &rmc("115959"));
        push(&mut after, "%0");
        after.vehicle_mut().restore(bytes).unwrap();
        let restored = after.vehicle();
        assert_eq!(restored.plane(), before.plane());
        assert_eq!(restored.observation(), before.observation());
        assert_eq!(restored.counters(), before.counters());
        assert_eq!(restored.locator().answer(), before.locator().answer());
        push(&mut after, "\r\n");
        after.vehicle_mut().restore(bytes).unwrap();
        if step == 0 {
            // Its generator had not been seeded yet.
            continue;
        }
        assert_eq!(reports(&mut after, &steps[step..]), all[step..], "{step}");
        push(&mut after, "$PFOXQ*50\r\n");
        assert_eq!(after.vehicle().report(), whole.vehicle().report());
    }
}

#[test]
fn sentences_of_others_are_left_to_them() {
    let mut gateway = gateway(CONFIG);
    let text = "PUBX,00,081350.00,4717.113210,N";
    let events = push(&mut gateway, &sentence(text));
    assert_eq!(events, [Event::Other]);
    let line = gateway.vehicle().line(0);
    assert!(line.starts_with(b"$PUBX,00,081350.00,4717.113210,N*"));
    assert!(gateway.vehicle().line(1).is_empty());
    assert_eq!(
        (
            gateway.vehicle().report(),
            gateway.vehicle().counters().ignored
        ),
        ("", 1)
    );
}

#[test]
fn ports_have_lines_of_their_own() {
    let mut gateway: Gateway<Clean<60, 16>, All, ShortReport, 2> = Gateway::new(CONFIG).unwrap();
    let (receiver, finder) = (rmc("120000"), "%010/9\r");
    let mut events = Vec::new();
    // Byte by byte in turns.
    let mut finder = finder.repeat(9).into_bytes().into_iter();
    for byte in receiver.bytes() {
        events.extend(gateway.push(0, byte));
        events.extend(finder.next().and_then(|byte| gateway.push(1, byte)));
    }
    let mut used = events.iter().filter(|event| **event == Event::Used);
    assert_eq!(used.by_ref().count(), 1);
    assert_eq!(gateway.vehicle().line(0), receiver.trim_end().as_bytes());
    for byte in finder.chain(*b"%020/9\r") {
        events.extend(gateway.push(1, byte));
    }
    let last = gateway.vehicle().observation().unwrap();
    assert_eq!(last.station(), 1);
    assert_eq!(events.len(), 11);
    // There is no third.
    assert_eq!(gateway.push(2, b'\n'), None);
    assert_eq!(gateway.vehicle().counters().lines, 11);
}

#[test]
fn a_record_is_as_good_as_a_line() {
    let mut vehicle: Vehicle<Clean<60, 16>> = Vehicle::EMPTY;
    let place = Geodetic::new(481_173_000, 115_166_667).unwrap();
    let record = |seconds: u32, degrees: f32| BearingRecord {
        time_ms: Some(43_200_000 + 1_000 * seconds),
        place: Some(place),
        sigma_rad: Some(0.05),
        ..BearingRecord::new(degrees)
    };
    let event = vehicle.push_record(0, &record(0, 30.0), &CONFIG);
    assert!(matches!(event, Event::NotObservable(_)), "{event:?}");
    let taken = vehicle.observation().unwrap();
    assert!((taken.bearing().compass_degrees() - 30.0).abs() < 1e-3);
    assert_eq!(taken.sigma_rad(), 0.05);
    for (record, reason) in [
        (record(0, 31.0), Rejected::Duplicate),
        (record(1, 361.0), Rejected::OutOfRange),
        (record(1, f32::NAN), Rejected::OutOfRange),
        (BearingRecord::new(0.0), Rejected::NoPosition),
    ] {
        let event = vehicle.push_record(0, &record, &CONFIG);
        assert_eq!(event, Event::Rejected(reason));
    }
    // From the bow, with a heading of its own.
    let relative = BearingRecord {
        reference: BearingReference::Relative,
        heading_deg: Some(350.0),
        ..record(2, 20.0)
    };
    vehicle.push_record(0, &relative, &CONFIG);
    let taken = vehicle.observation().unwrap();
    assert!((taken.bearing().compass_degrees() - 10.0).abs() < 1e-3);
    assert_eq!(
        (vehicle.counters().lines, vehicle.counters().bearings),
        (6, 2)
    );
}

#[test]
fn a_bearing_of_the_least_quality_is_used() {
    let mut gateway = gateway(CONFIG);
    push(&mut gateway, &rmc("120000"));
    for (quality, is_used) in [(39.9, false), (40.0, true)] {
        let record = BearingRecord {
            quality,
            ..BearingRecord::new(10.0)
        };
        let event = gateway.vehicle.push_record(0, &record, &CONFIG);
        let refused = Event::Rejected(Rejected::LowQuality);
        assert_eq!(event != refused, is_used, "{quality}: {event:?}");
    }
}
