//! Values that users tell and that cannot be.

use std::{error::Error, fmt};

/// A value that cannot be.
#[derive(Debug, Clone, PartialEq)]
pub struct Wrong {
    /// What users call it: the name of the option, and of the field in the settings. Empty if it is not one field.
    pub field: &'static str,
    /// What is wrong with it, as a verb phrase.
    pub what: String,
}

impl Wrong {
    /// Of a field.
    pub fn new(field: &'static str, what: impl Into<String>) -> Self {
        let what = what.into();
        Self { field, what }
    }
}

/// As an option.
impl fmt::Display for Wrong {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "--{} {}", self.field, self.what)
    }
}

impl Error for Wrong {}

/// Fails unless a text is a host and a port.
///
/// # Errors
/// Says what it lacks.
pub fn address(field: &'static str, text: &str) -> Result<(), Wrong> {
    let wrong = |what: String| Err(Wrong::new(field, what));
    let Some((host, port)) = text.rsplit_once(':') else {
        return wrong(format!("needs a host and a port: {text} has no port"));
    };
    // The colons of an address of version 6 stand in brackets.
    if host.is_empty() || (host.contains(':') && !host.ends_with(']')) {
        return wrong(format!("needs a host and a port: {text} has no host"));
    }
    if port.parse::<u16>().is_err() {
        return wrong(format!("needs a host and a port: {port} is no port"));
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_address_has_a_host_and_a_port() {
        for right in ["127.0.0.1:0", "localhost:10110", "[::1]:8073"] {
            assert_eq!(address("tcp", right), Ok(()), "{right}");
        }
        for (wrong, why) in [
            ("127.0.0.1", "127.0.0.1 has no port"),
            ("10110", "10110 has no port"),
            (":10110", ":10110 has no host"),
            ("::1:5", "::1:5 has no host"),
            ("localhost:http", "http is no port"),
            ("localhost:65536", "65536 is no port"),
            ("localhost:", " is no port"),
        ] {
            let error = address("tcp", wrong).unwrap_err().to_string();
            assert!(
                error.starts_with("--tcp needs") && error.ends_with(why),
                "{error}"
            );
        }
    }
}
