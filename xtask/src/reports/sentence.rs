//! A sentence of a gateway.

/// The fields of a sentence whose checksum is right.
pub fn fields(line: &str) -> Option<Vec<&str>> {
    let (payload, checksum) = line.strip_prefix('$')?.split_once('*')?;
    let sum = payload.bytes().fold(0, |sum, byte| sum ^ byte);
    (u8::from_str_radix(checksum, 16) == Ok(sum)).then(|| payload.split(',').collect())
}
