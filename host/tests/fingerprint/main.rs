//! Radio maps and matching, from the survey to the posterior, held against the same in f64.

mod maps;
mod matching;
mod missing;
mod site;
