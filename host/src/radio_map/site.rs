//! The survey of a site.

use std::{collections::BTreeMap, fs::File, io::Read, path::Path};

use anyhow::{Context, Result, ensure};
use foxhunt::fingerprint::Lattice;

use super::reading;
pub use super::reading::Reading;
use foxhunt_simulation::survey::Survey;

/// A survey, and which beacons it is of.
#[derive(Debug, Clone, Default)]
pub struct SiteSurvey {
    survey: Survey,
    beacons: Vec<u32>,
    gated: usize,
}

impl SiteSurvey {
    /// What a reading may be, in dBm: receivers are known to report others, such as +42.
    pub const RANGE_DBM: [f64; 2] = [-120.0, 0.0];

    /// Sorts readings by place and beacon. Those out of [`SiteSurvey::RANGE_DBM`] are left out and counted.
    pub fn new(readings: impl IntoIterator<Item = Reading>) -> Self {
        let all: Vec<Reading> = readings.into_iter().collect();
        let of_range = |r: &Reading| (Self::RANGE_DBM[0]..=Self::RANGE_DBM[1]).contains(&r.rssi);
        let kept: Vec<Reading> = all.iter().copied().filter(of_range).collect();
        let mut beacons: Vec<u32> = kept.iter().map(|reading| reading.beacon).collect();
        beacons.sort_unstable();
        beacons.dedup();
        let mut numbers = BTreeMap::new();
        let mut survey = Survey::default();
        for reading in &kept {
            // Of -0 and 0, which are the same place, adding 0 makes 0.
            let place = [reading.x, reading.y].map(|c| c + 0.0);
            let number = *numbers.entry(place.map(f64::to_bits)).or_insert_with(|| {
                survey.places.push(place);
                survey.samples.push(vec![Vec::new(); beacons.len()]);
                survey.places.len() - 1
            });
            let beacon = beacons.partition_point(|known| *known < reading.beacon);
            survey.samples[number][beacon].push(reading.rssi);
        }
        Self {
            survey,
            beacons,
            gated: all.len() - kept.len(),
        }
    }

    /// A survey whose beacon number `n` has the identifier `beacons[n]`. Readings out of [`SiteSurvey::RANGE_DBM`] are
    /// left out and counted; a beacon without an identifier is left out.
    pub fn of(survey: &Survey, beacons: &[u32]) -> Self {
        let places = survey.places.iter().zip(&survey.samples);
        let readings = places.flat_map(|(&[x, y], samples)| {
            beacons
                .iter()
                .zip(samples)
                .flat_map(move |(&beacon, levels)| {
                    let reading = move |&rssi: &f64| Reading { x, y, beacon, rssi };
                    levels.iter().map(reading)
                })
        });
        Self::new(readings)
    }

    /// The same survey, with these beacons beside its own, which were heard at none of its places: the maps of all floors of
    /// a building have the beacons of all.
    pub fn among(mut self, beacons: &[u32]) -> Self {
        for beacon in beacons {
            if let Err(number) = self.beacons.binary_search(beacon) {
                self.beacons.insert(number, *beacon);
                for samples in &mut self.survey.samples {
                    samples.insert(number, Vec::new());
                }
            }
        }
        self
    }

    /// Reads CSV, of points or of poses.
    ///
    /// A row of points is one reading, with the columns `x`, `y` (metres), `beacon` (a number) and `rssi` (dBm). A row of poses
    /// is a place and the strength of every beacon there, in columns `rssi_1`, `rssi_2` and so on by identifier; a field is
    /// empty where the beacon was not heard. The columns may be in any order, others are left out; `x_m`, `y_m`, `sensor`,
    /// `rssi_dbm` and `rssi_1_dbm` are understood, too. Where there is a column `floor`, all must be of one.
    ///
    /// Or reads the log of a tunnel's gateway by which a survey was recorded: its sentences `$PFOXV,x,y,floor,radio,rssi*hh`.
    ///
    /// # Errors
    /// When a column is missing, a value is no number, or there are several floors; the error names the line.
    pub fn read(csv: impl Read) -> Result<Self> {
        let mut floors = Self::floors(csv)?;
        ensure!(
            floors.len() == 1,
            "there are {} floors: each needs a map of its own",
            floors.len()
        );
        Ok(floors
            .pop_first()
            .map(|(_, survey)| survey)
            .unwrap_or_default())
    }

    /// The same, by floor, each among the beacons of all; 0 where there is no such column.
    ///
    /// # Errors
    /// As [`SiteSurvey::read`].
    pub fn floors(csv: impl Read) -> Result<BTreeMap<i32, Self>> {
        let mut floors = BTreeMap::new();
        for (floor, readings) in reading::read(csv)? {
            let site = Self::new(readings);
            ensure!(
                !site.survey.places.is_empty(),
                "there is no reading within {} and {} dBm",
                Self::RANGE_DBM[0],
                Self::RANGE_DBM[1]
            );
            floors.insert(floor, site);
        }
        let beacons: Vec<u32> = floors
            .values()
            .flat_map(|site| site.beacons.clone())
            .collect();
        let among = floors
            .into_iter()
            .map(|(floor, site)| (floor, site.among(&beacons)));
        Ok(among.collect())
    }

    /// Reads a CSV file, see [`SiteSurvey::read`].
    ///
    /// # Errors
    /// When it cannot be read.
    pub fn open(file: &Path) -> Result<Self> {
        File::open(file)
            .map_err(anyhow::Error::new)
            .and_then(Self::read)
            .with_context(|| format!("cannot read the survey {}", file.display()))
    }

    /// The readings that were kept.
    pub fn survey(&self) -> &Survey {
        &self.survey
    }

    /// Identifiers of the beacons, in ascending order.
    pub fn beacons(&self) -> &[u32] {
        &self.beacons
    }

    /// How many readings were left out, because no receiver hears such strengths.
    pub fn gated(&self) -> usize {
        self.gated
    }

    /// Whether a map can be made of it.
    ///
    /// # Errors
    /// If there are no beacons or too many, or if all readings are of one place.
    pub fn check(&self) -> Result<()> {
        let beacons = self.beacons.len();
        ensure!(
            (1..=255).contains(&beacons),
            "{beacons} beacons: not within 1 and 255"
        );
        let first = self.survey.places.first();
        ensure!(
            self.survey.places.iter().any(|place| Some(place) != first),
            "all readings are of one place: a map needs two at the least"
        );
        Ok(())
    }

    /// The lattice of a spacing, in metres, that begins at the lowest coordinates of the places and reaches to the
    /// highest: one row or column, in their middle, where they are less than a spacing apart across it.
    ///
    /// # Errors
    /// When that is no lattice, or there is no place.
    pub fn lattice(&self, spacing: f64) -> Result<Lattice> {
        Self::lattice_of([self], spacing)
    }

    /// The lattice over the places of several surveys: the maps of the floors of a building have one in common.
    ///
    /// # Errors
    /// When that is no lattice, or there is no place.
    pub fn lattice_of<'a>(
        surveys: impl IntoIterator<Item = &'a Self>,
        spacing: f64,
    ) -> Result<Lattice> {
        let places: Vec<[f64; 2]> = surveys
            .into_iter()
            .flat_map(|site| site.survey.places.iter().copied())
            .collect();
        ensure!(!places.is_empty(), "the survey is empty");
        ensure!(spacing > 0.0, "spacing is not positive");
        let extent = |axis: usize| {
            let coordinates = places.iter().map(|place| place[axis]);
            let lowest = coordinates.clone().fold(f64::INFINITY, f64::min);
            let highest = coordinates.fold(f64::NEG_INFINITY, f64::max);
            [lowest, highest]
        };
        let along = |[lowest, highest]: [f64; 2], other: [f64; 2]| {
            let length = highest - lowest;
            // A tunnel is a line, though its places are not quite on one.
            if length < spacing && length < other[1] - other[0] {
                return (0.5 * (lowest + highest), 1.0);
            }
            // Where rounding has made the last step a little longer, there is no point beyond it.
            (lowest, (length / spacing - 1e-6).ceil().max(0.0) + 1.0)
        };
        let (x, y) = (extent(0), extent(1));
        let ((x, columns), (y, rows)) = (along(x, y), along(y, x));
        ensure!(
            columns * rows <= Lattice::MAX_POINTS as f64 && columns.max(rows) < 65_536.0,
            "{columns} x {rows} points are more than a map can hold"
        );
        let origin = [x as f32, y as f32];
        Lattice::new(origin, spacing as f32, columns as u16, rows as u16)
            .with_context(|| format!("{columns} x {rows} points"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn refusal(csv: &str) -> String {
        format!("{:#}", SiteSurvey::read(csv.as_bytes()).unwrap_err())
    }

    #[test]
    fn a_survey_that_is_narrower_than_a_step_makes_a_line() {
        for (places, columns, rows, origin) in [
            ([[0.0, 1.0], [5.0, 1.25], [9.5, 1.5]], 11, 1, [0.0, 1.25]),
            ([[1.0, 0.0], [1.25, 5.0], [1.5, 9.5]], 1, 11, [1.25, 0.0]),
            ([[0.0, 0.0], [5.0, 1.0], [9.5, 0.5]], 11, 2, [0.0, 0.0]),
            ([[0.0, 0.0], [0.25, 0.5], [0.0, 0.0]], 1, 2, [0.125, 0.0]),
        ] {
            let readings = places.map(|[x, y]| Reading {
                x,
                y,
                beacon: 1,
                rssi: -60.0,
            });
            let lattice = SiteSurvey::new(readings).lattice(1.0).unwrap();
            assert_eq!((lattice.columns(), lattice.rows()), (columns, rows));
            assert_eq!(lattice.origin(), origin, "{places:?}");
        }
    }

    #[test]
    fn the_log_of_a_gateway_is_a_survey() {
        let mut log = String::from("gateway 1.0\r\n");
        for payload in [
            "PFOXV,1.000,2.500,0,7,-60",
            "PFOXT,1,2,3",
            "PFOXV,1.000,2.500,0,9,-71",
            "PFOXV,4.000,2.500,1,7,-80",
        ] {
            let sum = payload.bytes().fold(0, |sum, byte| sum ^ byte);
            log += &format!("12:00:01 INFO ${payload}*{sum:02X}\r\n");
        }
        log += "$PFOXV,4.000,2.500,1,7,-20*00\r\n";
        let floors = SiteSurvey::floors(log.as_bytes()).unwrap();
        assert_eq!(floors.keys().collect::<Vec<_>>(), [&0, &1]);
        for floor in floors.values() {
            // What one floor has not heard is among its beacons, too.
            assert_eq!(floor.beacons(), [7, 9]);
        }
        assert_eq!(floors[&0].survey().places, [[1.0, 2.5]]);
        assert_eq!(floors[&0].survey().samples, [[[-60.0], [-71.0]]]);
        assert_eq!(floors[&1].survey().samples, [[vec![-80.0], vec![]]]);
        assert!(SiteSurvey::read(log.as_bytes()).is_err());
    }

    #[test]
    fn errors_name_the_line_and_the_column() {
        for (csv, expected) in [
            (
                "x,y,beacon,rssi\n0,0,1,-50\n0,abc,1,-50\n",
                ["line 3", "y: "],
            ),
            (
                "x,y,beacon,rssi\n0,0,1,-50\n\n0,1,-7,-50\n",
                ["line 4", "beacon: "],
            ),
            (
                "x,y,beacon,rssi\n0,NaN,1,-50\n",
                ["line 2", "y is not finite"],
            ),
            (
                "x,y,beacon,rssi\n0,0,1,inf\n",
                ["line 2", "rssi is not finite"],
            ),
            ("x,y,beacon,rssi\n3e7,0,1,-50\n", ["line 2", "x is more"]),
            ("x,y,beacon,rssi\n0,0,1\n", ["line: 2", "3 fields"]),
            ("x,y,rssi\n0,0,-50\n", ["line 2", "missing field `beacon`"]),
            ("x,y,beacon,rssi\n", ["no row", "the names"]),
            ("x,y,beacon,rssi\n0,0,1,42\n", ["no reading", "0 dBm"]),
        ] {
            let error = refusal(csv);
            assert!(
                expected.iter().all(|part| error.contains(part)),
                "{csv}: {error}"
            );
        }
        let error = format!(
            "{:#}",
            SiteSurvey::open(Path::new("/nowhere.csv")).unwrap_err()
        );
        assert!(error.contains("/nowhere.csv"), "{error}");
    }

    #[test]
    fn readings_are_sorted_by_place_and_beacon() {
        let csv =
            "sensor, rssi_dbm, x_m, y_m\n7,-50,0,1\n3,-60,0,1\n7,-54,-0,1\n3,42,0,1\n3,-70,2,1\n";
        let site = SiteSurvey::read(csv.as_bytes()).unwrap();
        assert_eq!(site.beacons(), [3, 7]);
        assert_eq!(site.gated(), 1);
        assert_eq!(site.survey().places, [[0.0, 1.0], [2.0, 1.0]]);
        assert_eq!(
            site.survey().samples,
            [[vec![-60.0], vec![-50.0, -54.0]], [vec![-70.0], vec![]]]
        );
    }

    #[test]
    fn a_lattice_holds_the_places() {
        let site = |places: &[[f64; 2]]| {
            SiteSurvey::new(places.iter().map(|&[x, y]| Reading {
                x,
                y,
                beacon: 1,
                rssi: -50.0,
            }))
        };
        let lattice = site(&[[0.1, 2.0], [0.7, 2.0]]).lattice(0.2).unwrap();
        assert_eq!((lattice.columns(), lattice.rows()), (4, 1));
        let lattice = site(&[[0.0, 2.0], [1.0, 4.1]]).lattice(1.0).unwrap();
        assert_eq!((lattice.columns(), lattice.rows()), (2, 4));
        assert!(site(&[[0.0, 2.0]]).lattice(1.0).is_err());
        assert!(site(&[[0.0, 2.0], [1e5, 1e5]]).lattice(1.0).is_err());
        assert!(site(&[[0.0, 2.0], [1.0, 1.0]]).lattice(0.0).is_err());
    }
}
