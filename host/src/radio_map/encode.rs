//! The bytes of a radio map.

use foxhunt::fingerprint::{Encoding, RadioMap};

use super::{
    cells::nearest,
    content::Content,
    recipe::{Choices, Recipe},
    site::SiteSurvey,
};

/// The bytes of a map, see [`RadioMap`].
///
/// The detection probability of a beacon is the rate of packets that were received of it, compared with the
/// beacon that was received best at the same place; its sensitivity is the weakest of all readings.
pub(super) fn bytes(
    survey: &SiteSurvey,
    content: &Content,
    choices: &Choices,
    rest_m: f64,
    recipe: &Recipe,
) -> Vec<u8> {
    let levels = match recipe.encoding {
        Encoding::Levels => Some(survey.levels(recipe)),
        _ => None,
    };
    let mut bytes = header(survey, content, rest_m, levels.as_ref());
    bytes.extend((choices.length_m as f32).to_le_bytes());
    bytes.extend(recipe.days.unwrap_or(0).to_le_bytes());
    bytes.push((4.0 * choices.packet_sigma_db).round().clamp(1.0, 255.0) as u8);
    bytes.push(recipe.by_hand());
    let sensitivity = survey.weakest().floor().max(-128.0);
    let detections: Vec<f64> = (0..survey.beacons().len())
        .map(|beacon| survey.detection(beacon))
        .collect();
    for (identifier, detection) in survey.beacons().iter().zip(&detections) {
        bytes.extend(identifier.to_le_bytes());
        bytes.push((255.0 * detection).round() as u8);
        bytes.extend((sensitivity as i8).to_le_bytes());
    }
    bytes.extend(content.possible.chunks(8).map(|eight| {
        let bits = eight.iter().enumerate();
        bits.fold(0, |byte, (bit, possible)| byte | u8::from(*possible) << bit)
    }));
    for (beacon, detection) in detections.iter().enumerate() {
        match &levels {
            None => {
                let points = content.points.iter().zip(&content.heard);
                bytes.extend(points.flat_map(|((means, sigma), heard)| {
                    let mean = 2.0 * (means[beacon] + 128.0);
                    let sigma = (4.0 * sigma).round().clamp(1.0, 63.0);
                    [
                        if heard[beacon] { sigma as u8 } else { 0 },
                        mean.round().clamp(0.0, 255.0) as u8,
                    ]
                }));
            }
            Some(levels) => {
                let heard = survey.heard(beacon, content, choices);
                levels.rows(&heard, *detection, sensitivity, recipe, &mut bytes);
            }
        }
    }
    let mut checksum = crc32fast::Hasher::new();
    checksum.update(&bytes);
    bytes.extend(checksum.finalize().to_le_bytes());
    bytes
}

/// What there is to say about a beacon at a point of the lattice, for a kernel density.
enum Heard<'a> {
    /// The readings of a place of the survey, which is the point.
    Samples(&'a [f64]),
    /// Between the places: the mean and the standard deviation that are expected.
    Expected(f64, f64),
    /// Impossible, or surveyed and not heard.
    Nothing,
}

impl Heard<'_> {
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

impl SiteSurvey {
    /// A beacon at every point.
    fn heard(&self, beacon: usize, content: &Content, choices: &Choices) -> Vec<Heard<'_>> {
        let survey = self.survey();
        let same = 1e-3 * f64::from(content.lattice.spacing());
        let at = |(point, ((means, sigma), possible)): (usize, (&(Vec<f64>, f64), &bool))| {
            if !possible {
                return Heard::Nothing;
            }
            match nearest(&survey.places, content.place(point)) {
                Some((place, distance)) if distance <= same => {
                    let samples = survey.samples[place][beacon].as_slice();
                    if samples.is_empty() {
                        Heard::Nothing
                    } else {
                        Heard::Samples(samples)
                    }
                }
                _ => Heard::Expected(means[beacon], sigma.hypot(choices.packet_sigma_db)),
            }
        };
        let points = content.points.iter().zip(&content.possible);
        points.enumerate().map(at).collect()
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
    fn levels(&self, recipe: &Recipe) -> Levels {
        let strongest = self.readings().fold(f64::NEG_INFINITY, f64::max);
        let lowest = (self.weakest() - recipe.bandwidth_db).floor().max(-128.0);
        let range = strongest + recipe.bandwidth_db - lowest;
        let spacing = (range / f64::from(recipe.levels - 1)).ceil().max(1.0);
        let floor = (recipe.outliers / RANGE_DB).ln();
        // The density of the kernel alone: no other is higher.
        let top = log_mixture(normal_density(0.0, recipe.bandwidth_db), recipe.outliers);
        Levels {
            lowest: lowest as i8,
            spacing: spacing as u8,
            count: recipe.levels,
            top,
            step: (top - floor) / 15.0,
        }
    }
}

const RANGE_DB: f64 = SiteSurvey::RANGE_DBM[1] - SiteSurvey::RANGE_DBM[0];

/// All that comes before what is said of the survey.
fn header(survey: &SiteSurvey, content: &Content, rest_m: f64, levels: Option<&Levels>) -> Vec<u8> {
    let lattice = &content.lattice;
    let mut bytes = b"FXRM".to_vec();
    bytes.push(RadioMap::VERSION);
    bytes.push(if levels.is_some() { 2 } else { 1 });
    bytes.push(survey.beacons().len() as u8);
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
        None => {
            // Saturates.
            bytes.extend(((100.0 * rest_m).round() as u16).to_le_bytes());
            bytes.extend([0; 8]);
        }
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
        recipe: &Recipe,
        bytes: &mut Vec<u8>,
    ) {
        for level in 0..self.count {
            let rssi = f64::from(self.lowest) + f64::from(self.spacing) * f64::from(level);
            self.row(heard, bytes, |heard| {
                let density = heard.average(recipe.bandwidth_db, |reading, width| {
                    normal_density(rssi - reading, width)
                });
                self.top - log_mixture(density.unwrap_or(0.0), recipe.outliers)
            });
        }
        self.row(heard, bytes, |heard| {
            let audible = heard.average(recipe.bandwidth_db, |reading, width| {
                // Very nearly the normal distribution.
                1.0 / (1.0 + (-1.702 * (reading - sensitivity) / width).exp())
            });
            let missing = 1.0 - detection * audible.unwrap_or(0.0);
            -missing.max(recipe.outliers).ln()
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
