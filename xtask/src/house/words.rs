//! Words that mean something else here, or nothing: one thing has one word.

use std::{collections::BTreeMap, path::Path};

use super::sources::{Sources, has_extension};

/// A word that must not be used.
struct Word {
    /// Its forms. With a capital it is a part of a type's name; without, a word in any case.
    forms: &'static [&'static str],
    /// What to say.
    instead: &'static str,
    /// Where.
    places: &'static [&'static str],
}

/// The library, and what its users read.
const ALL: &[&str] = &["src", "README.md", "docs"];

const WORDS: &[Word] = &[
    word(&["wild"], "outlier"),
    word(
        &["nursery", "nurseries", "bear", "bears", "plant", "plants"],
        "candidate, track initiation",
    ),
    word(&["bury", "buries", "buried"], "track deletion"),
    word(&["pursuit", "pursuits", "pursue", "pursues"], "manoeuvring"),
    word(&["parked", "park", "parks", "parking"], "stationary"),
    word(&["deviation", "deviations"], "sigma, standard deviation"),
    word(&["share", "shares"], "weight, probability, fraction, rate"),
    word(&["dear", "dearer"], "expensive"),
    word(&["Settings"], "Config"),
    Word {
        forms: &["Seed", "Seeds"],
        instead: "candidate",
        places: &["src/aoa"],
    },
    Word {
        forms: &["agree", "agrees"],
        instead: "gate",
        places: &["src/aoa"],
    },
];

/// Pairs of words of which the one is right beside the other.
const EXCEPTIONS: &[[&str; 2]] = &[
    ["standard", "deviation"],
    ["standard", "deviations"],
    // The verb.
    ["share", "a"],
    ["share", "an"],
    ["share", "one"],
    ["share", "the"],
    ["share", "their"],
    ["shares", "a"],
    ["shares", "its"],
    ["shares", "one"],
    ["shares", "the"],
];

const fn word(forms: &'static [&'static str], instead: &'static str) -> Word {
    Word {
        forms,
        instead,
        places: ALL,
    }
}

/// Every file that uses such a word, with its lines.
pub fn find(sources: &Sources) -> Vec<String> {
    let mut found = Vec::new();
    for (path, text) in &sources.texts {
        if !has_extension(path, &["rs", "md"]) {
            continue;
        }
        let words = split(text);
        for forbidden in WORDS {
            if !forbidden.places.iter().any(|place| path.starts_with(place)) {
                continue;
            }
            let mut lines: BTreeMap<&str, Vec<String>> = BTreeMap::new();
            if let Some(word) = forbidden.in_name(path) {
                lines.entry(word).or_default().push("its name".into());
            }
            for (i, (line, word)) in words.iter().enumerate() {
                let before = i.checked_sub(1).map_or("", |i| words[i].1);
                let after = words.get(i + 1).map_or("", |(_, word)| word);
                if forbidden.is(word) && !excepted(before, word) && !excepted(word, after) {
                    lines.entry(word).or_default().push(line.to_string());
                }
            }
            for (word, mut lines) in lines {
                lines.dedup();
                found.push(format!(
                    "{}: `{word}` (say: {}), lines {}",
                    path.display(),
                    forbidden.instead,
                    lines.join(", ")
                ));
            }
        }
    }
    found
}

impl Word {
    fn is(&self, word: &str) -> bool {
        self.forms.iter().any(|form| {
            let part = form.starts_with(char::is_uppercase);
            *form == word || !part && word.eq_ignore_ascii_case(form)
        })
    }

    fn in_name<'a>(&self, path: &'a Path) -> Option<&'a str> {
        let names = path.iter().filter_map(|name| name.to_str());
        names
            .flat_map(split)
            .map(|(_, word)| word)
            .find(|word| self.is(word))
    }
}

fn excepted(first: &str, second: &str) -> bool {
    EXCEPTIONS
        .iter()
        .any(|[a, b]| first.eq_ignore_ascii_case(a) && second.eq_ignore_ascii_case(b))
}

/// The words of a text with their lines. `TrackShare`, `track_share` and `track share` are two words each.
fn split(text: &str) -> Vec<(usize, &str)> {
    let mut words = Vec::new();
    for (line, text) in text.lines().enumerate() {
        let mut rest = text;
        while let Some(start) = rest.find(|c: char| c.is_ascii_alphabetic()) {
            rest = &rest[start..];
            let length = word_length(rest);
            words.push((line + 1, &rest[..length]));
            rest = &rest[length..];
        }
    }
    words
}

/// A word ends before what is no letter, and before a capital after a small letter.
fn word_length(text: &str) -> usize {
    let bytes = text.as_bytes();
    let end = (1..bytes.len()).find(|&i| {
        !bytes[i].is_ascii_alphabetic()
            || bytes[i].is_ascii_uppercase() && bytes[i - 1].is_ascii_lowercase()
    });
    end.unwrap_or(bytes.len())
}
