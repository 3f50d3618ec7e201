//! The library's names of what users tell.

use anyhow::Error;
use foxhunt::ConfigError;

use crate::wrong::Wrong;

/// A field of the library.
struct Field {
    library: &'static str,
    /// What users call it.
    users: &'static str,
    /// Radians in the library, degrees for users.
    is_angle: bool,
}

const fn field(library: &'static str, users: &'static str) -> Field {
    Field {
        library,
        users,
        is_angle: false,
    }
}

const fn angle(library: &'static str, users: &'static str) -> Field {
    Field {
        is_angle: true,
        ..field(library, users)
    }
}

const FIELDS: [Field; 12] = [
    field("min_quality", "minimum-quality"),
    angle("best_sigma_rad", "best-sigma"),
    angle("worst_sigma_rad", "worst-sigma"),
    field("max_age_ms", "maximum-age"),
    field("min_speed_m_s", "minimum-speed"),
    field("max_speed_m_s", "maximum-speed"),
    field("variation_deg", "variation"),
    field("mirrored", "mirrored"),
    field("outlier", "outliers"),
    angle("bias_sigma_rad", "bias-sigma"),
    field("position_sigma_m", "position-sigma"),
    field("distance_m", "correlation-distance"),
];

/// The same error with the names and the units of users; as it is, if users cannot tell this field.
pub fn named(error: ConfigError) -> Error {
    let known = |word: &str| FIELDS.iter().find(|field| field.library == word);
    let Some(field) = known(error.field()) else {
        return error.into();
    };
    let words: Vec<&str> = error.message().split(' ').skip(1).collect();
    let number = |word: &str| word.trim_end_matches(',').parse::<f32>().ok();
    let last = words.iter().rposition(|word| number(word).is_some());
    let words = words.iter().enumerate().map(|(place, word)| {
        let comma = if word.ends_with(',') { "," } else { "" };
        match (number(word), known(word)) {
            (Some(radians), _) if field.is_angle => {
                let unit = if last == Some(place) { " degrees" } else { "" };
                format!("{}{unit}{comma}", short(radians.to_degrees()))
            }
            (Some(number), _) => format!("{number}{comma}"),
            (None, Some(other)) => other.users.to_owned(),
            (None, None) => (*word).to_owned(),
        }
    });
    let what = words.collect::<Vec<_>>().join(" ");
    Wrong::new(field.users, what).into()
}

/// With three digits that count.
fn short(value: f32) -> String {
    let magnitude = value.abs().max(f32::MIN_POSITIVE).log10().floor();
    let decimals = if value == 0.0 {
        0.0
    } else {
        (2.0 - magnitude).max(0.0)
    };
    format!("{value:.0$}", decimals as usize)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn angles_are_degrees_and_names_are_those_of_users() {
        for (library, users) in [
            (
                "min_quality must be from 0.0 to 100.0",
                "--minimum-quality must be from 0 to 100",
            ),
            (
                "bias_sigma_rad must be from 0 to 0.5",
                "--bias-sigma must be from 0 to 28.6 degrees",
            ),
            (
                "best_sigma_rad must be at least 0.001, as of an observation",
                "--best-sigma must be at least 0.0573 degrees, as of an observation",
            ),
            (
                "worst_sigma_rad must be from best_sigma_rad to 3.2, as of an observation",
                "--worst-sigma must be from best-sigma to 183 degrees, as of an observation",
            ),
            ("moves must be from 1 to 16", "moves must be from 1 to 16"),
        ] {
            assert_eq!(named(ConfigError::new(library)).to_string(), users);
        }
    }
}
