use foxhunt::gateway::BearingReference;
use proptest::prelude::*;

use super::*;

fn lines(text: &str) -> String {
    match message(text.as_bytes()) {
        Ok(Decoded::Lines(lines)) => String::from_utf8(lines).unwrap(),
        other => panic!("{other:?}"),
    }
}

fn bearing_of(text: &str) -> Bearing {
    match message(text.as_bytes()) {
        Ok(Decoded::Bearing(bearing)) => bearing,
        other => panic!("{other:?}"),
    }
}

#[test]
fn gpsd_becomes_sentences() {
    let text = r#"{"class":"TPV","device":"/dev/pts/1","mode":3,"time":"2026-11-28T09:30:04.500Z","lat":-48.117300017,
        "lon":11.516666700,"track":90.25,"speed":10.0}"#;
    assert_eq!(
        lines(text),
        "$GPRMC,093004.50,A,4807.0380010,S,01131.0000020,E,19.438,90.250,281126,,,A*4E\r\n"
    );
    for nothing in [
        r#"{"class":"TPV","mode":1}"#,
        r#"{"class":"SKY"}"#,
        r#"{"class":"VERSION","release":"3.25"}"#,
        "",
        "  \r\n",
    ] {
        assert_eq!(message(nothing.as_bytes()), Ok(Decoded::Nothing));
    }
}

#[test]
fn chasemapper_bearings() {
    let one = bearing_of(
        r#"{"type": "BEARING", "bearing_type": "absolute", "source": "yagi", "latitude": 48.1, "longitude": 11.5,
            "bearing": 370.5, "confidence": 60, "timestamp": 1795339800.25}"#,
    );
    assert_eq!(one.time_ms, Some(1_795_339_800_250));
    assert_eq!(one.key.station, "yagi");
    assert_eq!((one.record.degrees, one.record.quality), (10.5, 60.0));
    let two = bearing_of(
        r#"{"type":"BEARING","bearing_type":"relative","source":"krakensdr_doa","bearing":90}"#,
    );
    assert_eq!(two.record.degrees, 270.0);
    assert_eq!(two.record.reference, BearingReference::Relative);
    assert_eq!((two.record.place, two.time_ms), (None, None));
    let delete = r#"{"type":"BEARING","delete":true,"source":"yagi","timestamp":1795339800.25}"#;
    assert_eq!(message(delete.as_bytes()), Ok(Decoded::Delete(one.key)));
    let absolute = r#"{"type":"BEARING","bearing_type":"absolute","bearing":1}"#;
    assert_eq!(
        message(absolute.as_bytes()),
        Err(Refusal::Field("latitude"))
    );
}

#[test]
fn a_kraken_by_json_is_its_line() {
    let text = r#"{"station_id":"a,b","tStamp":1756823719250,"latitude":"52.2","longitude":"21.0","gpsBearing":"12.5",
        "radioBearing":"297","conf":"7.35","power":"-32.5","freq":433920000.0,"antType":"UCA","latency":437,
        "doaArray":"0.00,1.50,2.25,"}"#;
    assert_eq!(
        lines(text),
        "1756823719250, 297, 7.35, -32.5, 433920000, UCA, 437, ab, 52.2, 21, 12.5, 12.5, GPS, R, R, R, R, 0.00, 1.50, 2.25 \n"
    );
}

#[test]
fn doa_xml_runs_counter_clockwise() {
    let one = bearing_of(
        "<DATA><STATION_ID>x</STATION_ID><TIME>1756823719250</TIME><FREQUENCY>433.92</FREQUENCY><LOCATION>\
         <LATITUDE>52.2</LATITUDE><LONGITUDE>21.0</LONGITUDE><HEADING>12.5</HEADING></LOCATION><DOA>63</DOA>\
         <PWR>67.5</PWR><CONF>735</CONF><LATENCY>100</LATENCY></DATA>",
    );
    assert_eq!(one.record.degrees, 297.0);
    assert_eq!(one.record.heading_deg, Some(12.5));
    assert!((one.record.quality - 81.6).abs() < 0.1);
    assert_eq!(one.time_ms, Some(1_756_823_719_200));
}

#[test]
fn bearings_of_others() {
    let text = r#"{"type":"Feature","geometry":{"type":"Point","coordinates":[11.5,48.1]},
        "properties":{"station":"north","id":7,"time_ms":1795339800250,"bearing_deg":45,"sigma_deg":3}}"#;
    let one = bearing_of(text);
    assert_eq!(one.key.id.as_deref(), Some("7"));
    assert!((one.record.sigma_rad.unwrap() - 0.0524).abs() < 1e-3);
    let fix = r#"{"type":"Feature","geometry":null,"properties":{"source":1}}"#;
    assert_eq!(message(fix.as_bytes()), Ok(Decoded::Nothing));
}

fn parted(pieces: &[&[u8]]) -> (Vec<u8>, Vec<String>) {
    let (mut stream, mut bytes, mut objects) = (Stream::default(), Vec::new(), Vec::new());
    let mut take = |part: Part<'_>| match part {
        Part::Bytes(more) => bytes.extend_from_slice(more),
        Part::Object(object) => objects.push(String::from_utf8_lossy(object).into_owned()),
    };
    for piece in pieces {
        stream.push(piece, &mut take);
    }
    stream.end(&mut take);
    (bytes, objects)
}

#[test]
fn objects_stand_in_lines_of_their_own() {
    let (bytes, objects) = parted(&[b"$GP", b"RMC{\"\r\n{\"a\":", b" 1}\r\n%045/7\n{\xb5b{\n{}"]);
    assert_eq!(bytes, b"$GPRMC{\"\r\n\n%045/7\n{\xb5b{\n");
    assert_eq!(objects, [r#"{"a": 1}"#, "{}"]);
}

proptest! {
    #[test]
    fn whatever_comes_is_read_or_refused(bytes in proptest::collection::vec(any::<u8>(), 0..300)) {
        let _ = message(&bytes);
        let _ = message(&[b"{".as_slice(), &bytes].concat());
        let _ = message(&[b"<".as_slice(), &bytes].concat());
        let (kept, objects) = parted(&[&bytes]);
        let length: usize = objects.iter().map(|object| object.len().min(1)).sum();
        prop_assert!(kept.len() <= bytes.len() && length <= bytes.len());
    }

    #[test]
    fn whatever_a_field_holds(name in 0usize..12, value in "[-0-9.e\"a-z\\[\\]]{0,12}") {
        const NAMES: [&str; 12] = [
            "bearing", "latitude", "longitude", "timestamp", "confidence", "tStamp", "conf", "freq", "doaArray", "mode",
            "time", "lat",
        ];
        let mut fields = serde_json::json!({
            "type": "BEARING", "bearing_type": "absolute", "bearing": 1, "latitude": 1, "longitude": 1,
        });
        let value = serde_json::from_str(&value).unwrap_or(Value::String(value));
        fields[NAMES[name]] = value.clone();
        let _ = message(fields.to_string().as_bytes());
        let mut fields = serde_json::json!({
            "tStamp": 1_756_823_719_250_i64, "radioBearing": 1, "conf": 2, "freq": 3,
        });
        fields[NAMES[name]] = value.clone();
        let _ = message(fields.to_string().as_bytes());
        let mut fields = serde_json::json!({"class": "TPV", "mode": 2, "lat": 1, "lon": 1, "time": "2026-11-28T09:30:04Z"});
        fields[NAMES[name]] = value;
        let _ = message(fields.to_string().as_bytes());
    }
}
