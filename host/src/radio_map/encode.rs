//! The bytes of a radio map.

use std::{cell::LazyCell, collections::BTreeMap};

use anyhow::{Context, Result, ensure};
use foxhunt::fingerprint::{Encoding, Lattice, RadioMap};

use super::{
    field::{Field, Series, nearest, nearest_neighbour},
    site::SiteSurvey,
};

/// How a survey becomes a map.
#[derive(Debug, Clone, PartialEq)]
pub struct Options {
    /// Points further than this from any place of the survey, in metres, count as not surveyed. By default one
    /// and a half times the spacing of the lattice or the distance between the places, whichever is larger.
    pub reach: Option<f64>,
    /// Where beacons are, in metres, by identifier, as far as that is known: between the places of the survey and beyond
    /// them, the level of those is expected to fall with the logarithm of the distance.
    pub sources: BTreeMap<u32, [f64; 2]>,
    /// Width of the kernel of [`Encoding::Levels`], in dB: besides the noise it has to cover how a scan differs from
    /// a survey.
    pub bandwidth: f64,
    /// Rate of the readings that may have any strength, in [`Encoding::Levels`].
    pub outliers: f64,
    /// Levels of [`Encoding::Levels`], up to 255: half a byte for each of them, each point and each beacon.
    pub levels: u8,
}

impl Default for Options {
    /// A bandwidth of 4 dB, 32 levels, one outlier in a thousand; the places of the beacons are unknown.
    fn default() -> Self {
        Self {
            reach: None,
            sources: BTreeMap::new(),
            bandwidth: 4.0,
            outliers: 1e-3,
            levels: 32,
        }
    }
}

impl Options {
    /// Fails with the name of an option that is out of its range.
    fn check(&self) -> Result<()> {
        ensure!(
            self.bandwidth > 0.0 && self.bandwidth <= 50.0,
            "bandwidth must be from 0 to 50 dB"
        );
        ensure!(
            self.outliers > 0.0 && self.outliers < 0.5,
            "outliers must be from 0 to 0.5"
        );
        ensure!(
            self.reach.is_none_or(|reach| reach >= 0.0),
            "reach is negative"
        );
        ensure!(self.levels >= 2, "levels is below 2");
        Ok(())
    }
}

/// The fields of all beacons, when they are needed: levels, and logarithms of variances.
type Fields<F> = LazyCell<[Vec<Option<Field>>; 2], F>;

/// What there is to say about a beacon at a point of the lattice.
enum Heard<'a> {
    /// The readings of a place of the survey, which is the point.
    Samples(&'a [f64]),
    /// Between the places: the mean and the standard deviation that are expected.
    Expected(f64, f64),
    /// Not surveyed nearby, or surveyed and not heard.
    Nothing,
}

impl Heard<'_> {
    /// Mean and standard deviation.
    fn moments(&self) -> Option<[f64; 2]> {
        match self {
            Self::Samples(samples) => moments(samples),
            Self::Expected(mean, sigma) => Some([*mean, *sigma]),
            Self::Nothing => None,
        }
    }

    /// Mean of a function of a reading and of the width of the kernel around it.
    fn average(&self, bandwidth: f64, kernel: impl Fn(f64, f64) -> f64) -> Option<f64> {
        match self {
            Self::Samples(samples) => {
                let sum: f64 = samples
                    .iter()
                    .map(|sample| kernel(*sample, bandwidth))
                    .sum();
                Some(sum / samples.len() as f64)
            }
            Self::Expected(mean, sigma) => Some(kernel(*mean, sigma.hypot(bandwidth))),
            Self::Nothing => None,
        }
    }
}

fn moments(samples: &[f64]) -> Option<[f64; 2]> {
    let n = samples.len() as f64;
    let mean = samples.iter().sum::<f64>() / n;
    let squares: f64 = samples.iter().map(|sample| (sample - mean).powi(2)).sum();
    (n > 0.0).then(|| [mean, (squares / (n - 1.0).max(1.0)).sqrt()])
}

impl SiteSurvey {
    /// The bytes of a map, see [`RadioMap`].
    ///
    /// Points of the lattice that are places of the survey, to a thousandth of the spacing, take exactly what was
    /// measured there. Between the places a Gaussian process fills in; its doubt about the mean adds to the sigma.
    ///
    /// The detection probability of a beacon is the rate of packets that were received of it, compared with the
    /// beacon that was received best at the same place; its sensitivity is the weakest of all readings.
    ///
    /// # Errors
    /// When an option is out of range, or there are no beacons or too many.
    pub fn radio_map(
        &self,
        lattice: &Lattice,
        encoding: Encoding,
        options: &Options,
    ) -> Result<Vec<u8>> {
        options.check()?;
        let beacons = u8::try_from(self.beacons().len())
            .ok()
            .filter(|beacons| *beacons > 0)
            .with_context(|| format!("{} beacons: not within 1 and 255", self.beacons().len()))?;

        let levels = match encoding {
            Encoding::Levels => Some(self.levels(options)),
            Encoding::Moments => None,
            _ => anyhow::bail!("unknown encoding"),
        };
        let mut bytes = header(lattice, beacons, levels.as_ref());
        let sensitivity = self.weakest().floor().max(-128.0);
        let detections: Vec<f64> = (0..self.beacons().len())
            .map(|b| self.detection(b))
            .collect();
        for (identifier, detection) in self.beacons().iter().zip(&detections) {
            bytes.extend(identifier.to_le_bytes());
            bytes.push((255.0 * detection).round() as u8);
            bytes.extend((sensitivity as i8).to_le_bytes());
        }
        let spacing = f64::from(lattice.spacing());
        let between = nearest_neighbour(&self.survey().places).unwrap_or(spacing);
        let reach = options.reach.unwrap_or(1.5 * spacing.max(between));
        let positions: Vec<[f64; 2]> = (0..lattice.points())
            .map(|point| lattice.position(point).map(f64::from))
            .collect();
        let near = |position: &[f64; 2]| {
            nearest(&self.survey().places, *position).filter(|(_, d)| *d <= reach)
        };
        bytes.extend(positions.chunks(8).map(|eight| {
            let bits = eight.iter().enumerate();
            bits.fold(0, |byte, (bit, position)| {
                byte | u8::from(near(position).is_some()) << bit
            })
        }));
        // A lattice that has all its points in the survey needs none.
        let fields = LazyCell::new(|| self.fields(options));
        for (beacon, detection) in detections.iter().enumerate() {
            let heard = self.heard(beacon, &positions, near, 1e-3 * spacing, &fields);
            match &levels {
                None => bytes.extend(moments_rows(&heard, &positions)),
                Some(levels) => levels.rows(&heard, *detection, sensitivity, options, &mut bytes),
            }
        }
        let mut checksum = crc32fast::Hasher::new();
        checksum.update(&bytes);
        bytes.extend(checksum.finalize().to_le_bytes());
        Ok(bytes)
    }

    /// A beacon at every point.
    fn heard(
        &self,
        beacon: usize,
        positions: &[[f64; 2]],
        near: impl Fn(&[f64; 2]) -> Option<(usize, f64)>,
        same: f64,
        fields: &Fields<impl FnOnce() -> [Vec<Option<Field>>; 2]>,
    ) -> Vec<Heard<'_>> {
        let survey = self.survey();
        let samples = |place: usize| survey.samples[place][beacon].as_slice();
        let at = |position: &[f64; 2]| {
            let Some((place, distance)) = near(position) else {
                return Heard::Nothing;
            };
            if samples(place).is_empty() {
                return Heard::Nothing;
            }
            if distance <= same {
                return Heard::Samples(samples(place));
            }
            let [levels, spreads] = &**fields;
            match (&levels[beacon], &spreads[beacon]) {
                (Some(level), Some(spread)) => {
                    let (mean, doubt) = level.at(*position);
                    Heard::Expected(mean, (spread.at(*position).0.exp() + doubt).sqrt())
                }
                _ => Heard::Nothing,
            }
        };
        positions.iter().map(at).collect()
    }

    /// The means of the beacons anywhere, and the logarithms of their variances.
    fn fields(&self, options: &Options) -> [Vec<Option<Field>>; 2] {
        // Of the variances, the logarithm: it is never negative.
        let logarithm = |sigma: f64| sigma.powi(2).max(0.0625).ln();
        [
            Field::fit(&self.series(|[mean, _]| mean, &options.sources)),
            Field::fit(&self.series(|[_, sigma]| logarithm(sigma), &BTreeMap::new())),
        ]
    }

    /// A function of mean and sigma, by beacon, where it was heard.
    fn series(
        &self,
        of: impl Fn([f64; 2]) -> f64,
        sources: &BTreeMap<u32, [f64; 2]>,
    ) -> Vec<Series> {
        let survey = self.survey();
        let one = |(beacon, identifier): (usize, &u32)| {
            let each = survey.places.iter().zip(&survey.samples);
            let heard =
                each.filter_map(|(place, samples)| Some((*place, of(moments(&samples[beacon])?))));
            let (places, values) = heard.unzip();
            Series {
                places,
                values,
                source: sources.get(identifier).copied(),
            }
        };
        self.beacons().iter().enumerate().map(one).collect()
    }

    /// How well the map is known between the places: the root mean square, in dB, of how far the mean level at each place
    /// is from what all other places predict for it. Of all beacons; not a number without any.
    pub fn left_out(&self, options: &Options) -> f64 {
        let [levels, _] = self.fields(options);
        let errors = levels.iter().flatten().flat_map(Field::left_out);
        let (count, sum) =
            errors.fold((0.0, 0.0), |(n, sum), error| (n + 1.0, sum + error * error));
        (sum / count).sqrt()
    }

    fn readings(&self) -> impl Iterator<Item = f64> {
        self.survey().samples.iter().flatten().flatten().copied()
    }

    fn weakest(&self) -> f64 {
        self.readings().fold(f64::INFINITY, f64::min)
    }

    /// Rate of the packets of a beacon that were received where it was heard at all.
    fn detection(&self, beacon: usize) -> f64 {
        let rates = self.survey().samples.iter().filter_map(|place| {
            let most = place.iter().map(Vec::len).max()?;
            let received = place[beacon].len();
            (received > 0).then(|| received as f64 / most as f64)
        });
        let (count, sum) = rates.fold((0.0, 0.0), |(n, sum), rate| (n + 1.0, sum + rate));
        if count > 0.0 { sum / count } else { 0.0 }
    }

    /// The scale of the levels: they reach a kernel's width beyond all readings.
    fn levels(&self, options: &Options) -> Levels {
        let strongest = self.readings().fold(f64::NEG_INFINITY, f64::max);
        let lowest = (self.weakest() - options.bandwidth).floor().max(-128.0);
        let range = strongest + options.bandwidth - lowest;
        let spacing = (range / f64::from(options.levels - 1)).ceil().max(1.0);
        let floor = (options.outliers / RANGE_DB).ln();
        // The density of the kernel alone: no other is higher.
        let top = log_mixture(normal_density(0.0, options.bandwidth), options.outliers);
        Levels {
            lowest: lowest as i8,
            spacing: spacing as u8,
            count: options.levels,
            top,
            step: (top - floor) / 15.0,
        }
    }
}

const RANGE_DB: f64 = SiteSurvey::RANGE_DBM[1] - SiteSurvey::RANGE_DBM[0];

/// All that comes before the beacons.
fn header(lattice: &Lattice, beacons: u8, levels: Option<&Levels>) -> Vec<u8> {
    let mut bytes = b"FXRM".to_vec();
    bytes.push(RadioMap::VERSION);
    bytes.push(if levels.is_some() { 2 } else { 1 });
    bytes.push(beacons);
    bytes.push(levels.map_or(0, |levels| levels.count));
    bytes.extend((lattice.columns() as u16).to_le_bytes());
    bytes.extend((lattice.rows() as u16).to_le_bytes());
    for number in [lattice.origin()[0], lattice.origin()[1], lattice.spacing()] {
        bytes.extend(number.to_le_bytes());
    }
    match levels {
        Some(levels) => {
            bytes.extend(levels.lowest.to_le_bytes());
            bytes.push(levels.spacing);
            bytes.extend((levels.top as f32).to_le_bytes());
            bytes.extend((levels.step as f32).to_le_bytes());
        }
        None => bytes.extend([0; 10]),
    }
    bytes
}

fn normal_density(distance: f64, sigma: f64) -> f64 {
    let z = distance / sigma;
    (-0.5 * z * z).exp() / (sigma * std::f64::consts::TAU.sqrt())
}

/// Logarithm of a density of which a part is uniform.
fn log_mixture(density: f64, outliers: f64) -> f64 {
    ((1.0 - outliers) * density + outliers / RANGE_DB).ln()
}

/// Sigma and mean of every point. Where there is none, the sigma is 0 and the mean that of the nearest point,
/// so that one can interpolate up to there.
fn moments_rows(heard: &[Heard<'_>], positions: &[[f64; 2]]) -> Vec<u8> {
    let known = heard.iter().zip(positions);
    let (known, places): (Vec<[f64; 2]>, Vec<[f64; 2]>) = known
        .filter_map(|(heard, position)| Some((heard.moments()?, *position)))
        .unzip();
    let two_bytes = |(heard, position): (&Heard<'_>, &[f64; 2])| {
        let (mean, sigma) = match heard.moments() {
            Some([mean, sigma]) => (mean, (4.0 * sigma).round().clamp(1.0, 63.0)),
            None => (
                nearest(&places, *position).map_or(-128.0, |(n, _)| known[n][0]),
                0.0,
            ),
        };
        [
            sigma as u8,
            (2.0 * (mean + 128.0)).round().clamp(0.0, 255.0) as u8,
        ]
    };
    heard.iter().zip(positions).flat_map(two_bytes).collect()
}

struct Levels {
    lowest: i8,
    spacing: u8,
    count: u8,
    top: f64,
    step: f64,
}

impl Levels {
    /// Appends the rows of a beacon.
    fn rows(
        &self,
        heard: &[Heard<'_>],
        detection: f64,
        sensitivity: f64,
        options: &Options,
        bytes: &mut Vec<u8>,
    ) {
        for level in 0..self.count {
            let rssi = f64::from(self.lowest) + f64::from(self.spacing) * f64::from(level);
            self.row(heard, bytes, |heard| {
                let density = heard.average(options.bandwidth, |reading, width| {
                    normal_density(rssi - reading, width)
                });
                self.top - log_mixture(density.unwrap_or(0.0), options.outliers)
            });
        }
        self.row(heard, bytes, |heard| {
            let audible = heard.average(options.bandwidth, |reading, width| {
                // Very nearly the normal distribution.
                1.0 / (1.0 + (-1.702 * (reading - sensitivity) / width).exp())
            });
            let missing = 1.0 - detection * audible.unwrap_or(0.0);
            -missing.max(options.outliers).ln()
        });
    }

    /// Appends a row of codes, of eight points in four bytes.
    fn row(&self, heard: &[Heard<'_>], bytes: &mut Vec<u8>, cost: impl Fn(&Heard<'_>) -> f64) {
        let code = |heard| (cost(heard) / self.step).round().clamp(0.0, 15.0) as u8;
        for eight in heard.chunks(8) {
            let mut word = [0; 4];
            for (i, heard) in eight.iter().enumerate() {
                word[i % 4] |= code(heard) << (4 * (i / 4));
            }
            bytes.extend(word);
        }
    }
}

/// The source text of a constant of the map's bytes.
pub fn rust_constant(name: &str, map: &[u8]) -> String {
    let lines = map.chunks(16).map(|line| {
        let numbers: Vec<String> = line.iter().map(|byte| format!("{byte:#04x}")).collect();
        format!("    {},\n", numbers.join(", "))
    });
    format!(
        "/// A radio map.\n#[rustfmt::skip]\npub const {name}: [u8; {}] = [\n{}];\n",
        map.len(),
        lines.collect::<String>()
    )
}
