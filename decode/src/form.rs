//! The fields of a form, as a KrakenSDR posts them.

use serde_json::{Map, Value};

/// The fields of a form as JSON; `None` if it has none, as JSON that was posted without its type.
pub fn form(body: &[u8]) -> Option<String> {
    let text = std::str::from_utf8(body).ok()?;
    let mut fields = Map::new();
    for pair in text.split('&') {
        let (name, value) = pair.split_once('=')?;
        fields.insert(decoded(name)?, Value::String(decoded(value)?));
    }
    Some(Value::Object(fields).to_string())
}

/// Text of a form: a plus is a blank, a percent begins the two digits of a byte.
fn decoded(text: &str) -> Option<String> {
    let mut bytes = Vec::with_capacity(text.len());
    let mut rest = text.bytes();
    while let Some(byte) = rest.next() {
        bytes.push(match byte {
            b'+' => b' ',
            b'%' => {
                let digit = |byte: u8| char::from(byte).to_digit(16);
                let value = 16 * digit(rest.next()?)? + digit(rest.next()?)?;
                u8::try_from(value).ok()?
            }
            byte => byte,
        });
    }
    String::from_utf8(bytes).ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn forms() {
        let fields = form(b"radiobearing=297&id=fox+1&doaarray=%2C+0.00%2C+1.50").unwrap();
        let fields: Value = serde_json::from_str(&fields).unwrap();
        assert_eq!(fields["id"], "fox 1");
        assert_eq!(fields["doaarray"], ", 0.00, 1.50");
        for none in ["{\"a\":1}", "a=%", "a=%zz", "a"] {
            assert_eq!(form(none.as_bytes()), None);
        }
    }
}
