use std::fs;

use foxhunt::{
    aoa::{Answer, Locate, Manoeuvring, MultiTarget, Robust, manoeuvring, multi, robust},
    gateway::Config,
};
use geojson::{FeatureCollection, GeoJson, GeometryValue};

use super::*;
use crate::{drive, replay::FullReplay, scripts::Script};

type Locator = Robust<256, 64>;

const CONFIG: Config<robust::Config> = Config::new(robust::Config::DEFAULT);

fn recorder(bytes: &[u8]) -> Recorder<Locator> {
    recorder_with(CONFIG, bytes)
}

fn recorder_with<L: Locate>(config: Config<L::Config>, bytes: &[u8]) -> Recorder<L> {
    let mut recorder = Recorder::new(config).unwrap();
    recorder.push(bytes);
    recorder
}

fn collection(archive: &Archive) -> FeatureCollection {
    let text = archive.geojson().unwrap().to_string();
    let GeoJson::FeatureCollection(collection) = text.parse().unwrap() else {
        panic!("not a collection");
    };
    collection
}

fn layer<'a>(
    collection: &'a FeatureCollection,
    name: &str,
) -> Vec<(&'a GeometryValue, &'a geojson::JsonObject)> {
    (collection.features.iter())
        .map(|feature| {
            let geometry = feature.geometry.as_ref().unwrap();
            (&geometry.value, feature.properties.as_ref().unwrap())
        })
        .filter(|(_, properties)| properties["layer"] == name)
        .collect()
}

#[test]
fn the_recorder_says_what_the_gateway_says() {
    let drive = drive::example(1);
    let recorder = recorder(drive.bytes());
    let mut replay = FullReplay::<Locator>::new(CONFIG).unwrap();
    replay.push(drive.bytes());
    assert_eq!(recorder.replay().output(), replay.output());

    let archive = recorder.archive().unwrap();
    let last = archive.last();
    assert_eq!(Some(last.sources[0].fix), replay.fix());
    assert_eq!(archive.bearings.len(), replay.sights().len());
    // The last row of the table is the gateway's last sentence, to the last digit of its place.
    let row = archive.fix_rows().pop().unwrap();
    let sentence = String::from_utf8_lossy(replay.output()).into_owned();
    let fields: Vec<&str> = (sentence.lines().rev())
        .find(|line| line.starts_with("$PFOXF"))
        .unwrap()
        .split(',')
        .collect();
    let place = Place::from_nmea(&fields[2..6].join(",")).unwrap();
    assert!((place.latitude - row.latitude.unwrap()).abs() < 1e-9);
    assert!((place.longitude - row.longitude.unwrap()).abs() < 1e-9);
    assert_eq!(row.time.replace(':', ""), fields[1]);
    let major: f64 = fields[6].parse().unwrap();
    assert!((row.semi_major_m.unwrap() - 2.4477 * major).abs() < 0.01);
    // Of a line: 0 and 180 degrees are the same.
    let orientation: f64 = fields[8].parse().unwrap();
    let turn = (row.orientation_degrees.unwrap() - orientation).rem_euclid(180.0);
    assert!(turn.min(180.0 - turn) < 0.1);
    assert_eq!(row.bearings.to_string(), fields[9]);
}

#[test]
fn tables_are_read_back() {
    let archive = recorder(drive::example(1).bytes()).archive().unwrap();
    let fixes = tables::csv(&archive.fix_rows()).unwrap();
    let read: Vec<FixRow> = (csv::Reader::from_reader(fixes.as_slice()).deserialize())
        .collect::<Result<_, _>>()
        .unwrap();
    assert_eq!(read, archive.fix_rows());
    assert_eq!(read.len(), archive.answers.len());
    let reasons: Vec<&str> = read
        .iter()
        .filter_map(|row| row.reason.as_deref())
        .collect();
    assert!(reasons.starts_with(&["few", "angle"]), "{reasons:?}");

    let bearings = tables::csv(&archive.bearing_rows()).unwrap();
    let read: Vec<BearingRow> = (csv::Reader::from_reader(bearings.as_slice()).deserialize())
        .collect::<Result<_, _>>()
        .unwrap();
    assert_eq!(read, archive.bearing_rows());
    for row in &read {
        let sum = row.direct_probability.unwrap()
            + row.mirrored_probability.unwrap()
            + row.outlier_probability.unwrap();
        assert!((sum - 1.0).abs() < 3e-4);
        // Five sigmas, and what the fix and its place are off.
        let off = row.residual_degrees.unwrap().abs();
        assert!(
            row.kind != Some(Kind::Direct) || off < 6.0 * row.sigma_degrees,
            "{row:?}"
        );
    }
}

#[test]
fn a_map_has_all_parts_and_its_polygons_are_wound_right() {
    let drive = drive::example(1);
    let archive = recorder(drive.bytes()).archive().unwrap();
    let collection = collection(&archive);
    let count = |name| layer(&collection, name).len();
    assert_eq!(count("density"), PROBABILITIES.len());
    assert_eq!(count("bearing"), archive.bearings.len());
    assert_eq!(count("ellipse"), 1);
    assert_eq!(count("track"), 1);
    assert_eq!(count("last fix"), 1);
    assert!(count("hypothesis") >= 1);
    let fixed = archive
        .answers
        .iter()
        .filter(|known| !known.sources.is_empty());
    assert_eq!(count("fix"), fixed.count());

    let GeometryValue::Point { coordinates: point } = layer(&collection, "last fix")[0].0 else {
        panic!("a fix is a point");
    };
    let last = archive.last();
    let [longitude, latitude] = coordinates(&last.plane, last.sources[0].fix.position).unwrap();
    assert_eq!(point.as_slice(), [longitude, latitude]);

    let mut rings = 0;
    for (geometry, _) in ["density", "ellipse", "hypothesis"]
        .map(|l| layer(&collection, l))
        .concat()
    {
        let polygons = match geometry {
            GeometryValue::Polygon { coordinates } => vec![coordinates.clone()],
            GeometryValue::MultiPolygon { coordinates } => coordinates.clone(),
            _ => panic!("not a polygon"),
        };
        for ring in polygons.iter().map(|polygon| &polygon[0]) {
            assert!(ring.len() >= 4 && ring.first() == ring.last());
            let doubled: f64 = (ring.windows(2))
                .map(|pair| {
                    (pair[1][0] - pair[0][0]) * (pair[1][1] + pair[0][1] - 2.0 * ring[0][1])
                })
                .sum();
            assert!(doubled < 0.0, "clockwise");
            rings += 1;
        }
    }
    assert!(rings >= 6);
}

/// Two sources, and some outliers: the truth of each bearing is known by when it was taken.
#[test]
fn each_of_two_sources_has_its_parts() {
    let scene = Script::TwoSources.scene(1);
    let config = Config::new(multi::Config::DEFAULT);
    let recorder = recorder_with::<MultiTarget<3, Locator>>(config, scene.drive.bytes());
    let archive = recorder.archive().unwrap();
    let found = &archive.last().sources;
    assert_eq!(found.len(), 2);
    assert_eq!(archive.densities.len(), 2);
    assert_eq!(archive.map("").ellipses.len(), 2);
    let collection = collection(&archive);
    assert_eq!(layer(&collection, "ellipse").len(), 2);
    assert_eq!(layer(&collection, "density").len(), 2 * PROBABILITIES.len());

    assert_eq!(archive.map("").truths.len(), 2);
    for source in found {
        let held = |truth: &[f64; 2]| source.fix.ellipse(0.9999).contains(truth.map(|v| v as f32));
        assert_eq!(archive.map("").truths.iter().filter(|t| held(t)).count(), 1);
    }

    // Most bearings are said to be of the source that spoke.
    let truths = scene.sources.iter().map(|path| path.corners()[0].1);
    let truths: Vec<[f64; 2]> = truths.collect();
    let of = |place: [f64; 2], origin: Place| {
        let local = |truth: &[f64; 2]| origin.local(scene.origin.offset(*truth));
        let off = |truth: &[f64; 2]| {
            let [x, y] = local(truth);
            (x - place[0]).hypot(y - place[1])
        };
        usize::from(off(&truths[1]) < off(&truths[0]))
    };
    let mut right = 0;
    let mut direct = 0;
    for taken in archive
        .bearings
        .iter()
        .filter(|t| t.kind() == Some(Kind::Direct))
    {
        let [longitude, latitude] = coordinates::degrees(taken.plane.origin());
        let origin = Place {
            latitude,
            longitude,
        };
        let (source, _) = taken.fits.unwrap();
        let second = (f64::from(taken.time_ms) * 1e-3 - scene.departure).round() as usize;
        let spoke = second / 3 % 2;
        right += usize::from(of(source.fix.position.map(f64::from), origin) == spoke);
        direct += 1;
    }
    assert!(
        direct > 200 && 20 * right > 19 * direct,
        "{right} of {direct}"
    );
}

/// A source that drives off: what it was heard at before is no outlier.
#[test]
fn bearings_of_the_past_are_not_rejected() {
    let scene = Script::Departure.scene(1);
    let config = Config::new(manoeuvring::Config::DEFAULT);
    let recorder = recorder_with::<Manoeuvring<Locator>>(config, scene.drive.bytes());
    let archive = recorder.archive().unwrap();
    let count = |kind| {
        archive
            .bearings
            .iter()
            .filter(|t| t.kind() == Some(kind))
            .count()
    };
    // One bearing in twenty is an outlier.
    assert!(count(Kind::Past) > 60, "{}", count(Kind::Past));
    assert!(count(Kind::Outlier) < 80, "{}", count(Kind::Outlier));
    let collection = collection(&archive);
    assert_eq!(layer(&collection, "source track").len(), 1);
    let row = archive.fix_rows().pop().unwrap();
    assert!(row.moving_probability.is_some() && row.speed_m_s.is_some());
    // The cross is where the source ended.
    let [truth] = archive.map("").truths[..] else {
        panic!("there is one source");
    };
    let ellipse = archive.last().sources[0].fix.ellipse(0.9999);
    assert!(ellipse.contains(truth.map(|v| v as f32)), "{truth:?}");
}

#[test]
fn a_log_without_a_fix_keeps_its_bearings() {
    let drive = drive::example(1);
    let lines = drive.bytes().split_inclusive(|byte| *byte == b'\n');
    let mut recorder = Recorder::<Locator>::new(CONFIG).unwrap();
    for line in lines {
        recorder.push(line);
        if recorder.answers().len() == 2 {
            break;
        }
    }
    let archive = recorder.archive().unwrap();
    assert!(matches!(archive.last().answer, Answer::NotObservable(_)));
    let collection = collection(&archive);
    assert_eq!(layer(&collection, "bearing").len(), 2);
    assert!(layer(&collection, "ellipse").is_empty() && layer(&collection, "density").is_empty());
    assert!(archive.map("").svg().unwrap().contains("no fix"));
    assert!(
        archive
            .bearing_rows()
            .iter()
            .all(|row| row.kind.is_none() && row.source.is_none())
    );
}

#[test]
fn a_log_without_bearings_is_no_archive() {
    for log in ["", "$GPRMC,", "\r\n\r\nnothing\r\n%045/7\r\n"] {
        let error = recorder(log.as_bytes()).archive().unwrap_err();
        assert_eq!(error.to_string(), "no bearing was used");
    }
}

#[test]
fn a_restart_begins_another_search() {
    let drive = drive::example(1);
    let mut recorder = recorder(drive.bytes());
    let first = recorder.answers().len();
    recorder.push(b"$PFOXR*53\r\n%010/9\r%020/9\r");
    let archive = recorder.archive().unwrap();
    assert_eq!(archive.last_bearings().count(), 2);
    assert_eq!((archive.last().search, archive.last().bearings), (2, 2));
    assert_eq!(archive.bearings.len(), first + 2);
    assert_eq!(archive.map("").sights.len(), 2);
}

#[test]
fn files_are_written() {
    let directory = std::env::temp_dir().join(format!("foxhunt-archive-{}", std::process::id()));
    let archive = recorder(drive::example(1).bytes()).archive().unwrap();
    let files = archive.write(&directory, "a log").unwrap();
    let names: Vec<_> = (files.iter())
        .map(|file| file.file_name().unwrap().to_str().unwrap())
        .collect();
    assert_eq!(
        names,
        [
            "fixes.csv",
            "bearings.csv",
            "archive.geojson",
            "picture.svg",
            "picture.png",
            "archive.kml",
            "archive.gpx"
        ]
    );
    for file in &files {
        let size = fs::metadata(file).unwrap().len();
        assert!(
            size > 500 && size < 1_000_000,
            "{}: {size} bytes",
            file.display()
        );
    }
    fs::remove_dir_all(directory).unwrap();
}

#[test]
fn a_long_list_is_thinned_to_its_end() {
    let all: Vec<usize> = (0..1001).collect();
    let some: Vec<&usize> = thinned(&all, 100).collect();
    assert_eq!(some.last(), Some(&&1000));
    assert_eq!(some.len(), 91);
    assert_eq!(thinned(&all, 1001).count(), 1001);
    assert_eq!(thinned(&all[..0], 5).count(), 0);
    assert_eq!(thinned(&all[..1], 5).count(), 1);
}
