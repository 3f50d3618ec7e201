//! Names.

use serde::{Deserialize, Serialize};

/// A name of 1 to 32 letters, digits and `-_.`, as topics and tables can hold it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "String", into = "String")]
pub struct Name(String);

impl Default for Name {
    fn default() -> Self {
        Self("vehicle".into())
    }
}

impl TryFrom<String> for Name {
    type Error = String;

    fn try_from(name: String) -> Result<Self, String> {
        let is_plain = |c: char| c.is_alphanumeric() || "-_.".contains(c);
        if (1..=32).contains(&name.chars().count()) && name.chars().all(is_plain) {
            Ok(Self(name))
        } else {
            Err("a name has 1 to 32 letters, digits, hyphens, underscores or points".into())
        }
    }
}

impl From<Name> for String {
    fn from(name: Name) -> Self {
        name.0
    }
}

impl std::ops::Deref for Name {
    type Target = str;

    fn deref(&self) -> &str {
        &self.0
    }
}
