//! Messages that are no lines, and what becomes of them in a gateway.

use foxhunt::{
    aoa::{Clean, clean},
    gateway::{Config, Event, FullReport, Gateway, formats::All},
};
use foxhunt_decode::{
    Decoded, Part, Refusal, Stream, form, message, report, time_and_date, time_of_day,
};

type Told = Gateway<Clean<24, 8>, All, FullReport>;

/// Reads `data` as a message, as a form, and as a stream in two pieces, and gives a gateway what comes of it.
pub fn check(data: &[u8]) {
    for line in data.split(|byte| *byte == b'\n') {
        report(line);
        for (time, most) in [
            (time_of_day(line), 86_400_000),
            (time_and_date(line), i64::MAX),
        ] {
            assert!(time.is_none_or(|time| (i64::MIN / 2..most).contains(&time)));
        }
    }
    let config = Config::new(clean::Config::DEFAULT);
    let mut gateway: Box<Told> = Box::new(Gateway::new(config).expect("it is right"));
    take(message(data), &mut gateway);
    if let Some(json) = form(data) {
        // The fields of a form are a message, whatever they hold.
        assert_ne!(message(json.as_bytes()), Err(Refusal::Malformed));
        take(message(json.as_bytes()), &mut gateway);
    }
    let whole = parted(&[data]);
    let (first, second) = data.split_at(data.len() / 2);
    assert_eq!(
        parted(&[first, second]),
        whole,
        "where a stream is cut matters"
    );
    for object in whole.1 {
        take(message(&object), &mut gateway);
    }
}

/// Bytes for the gateway, and objects, of pieces of a stream.
fn parted(pieces: &[&[u8]]) -> (Vec<u8>, Vec<Vec<u8>>) {
    let (mut stream, mut bytes, mut objects) = (Stream::default(), Vec::new(), Vec::new());
    let mut take = |part: Part<'_>| match part {
        Part::Bytes(more) => bytes.extend_from_slice(more),
        Part::Object(object) => objects.push(object.to_vec()),
    };
    for piece in pieces {
        stream.push(piece, &mut take);
    }
    stream.end(&mut take);
    (bytes, objects)
}

fn take(decoded: Result<Decoded, Refusal>, gateway: &mut Told) {
    match decoded {
        Ok(Decoded::Lines(lines)) => {
            for byte in lines {
                gateway.push(0, byte);
            }
        }
        Ok(Decoded::Bearing(bearing)) => {
            let config = *gateway.config();
            let before: Vec<_> = (gateway.vehicle().locator().observations().copied()).collect();
            let event = (gateway.vehicle_mut()).push_record(0, &bearing.record, &config);
            if matches!(event, Event::Rejected(_)) {
                let after = gateway.vehicle().locator().observations().copied();
                assert!(after.eq(before), "{event:?}");
            }
        }
        Ok(Decoded::Delete(_) | Decoded::Nothing) | Err(_) => {}
    }
}
