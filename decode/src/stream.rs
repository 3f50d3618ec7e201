//! JSON objects in lines of their own, among lines for the gateway.

/// The most bytes of an object.
const MOST: usize = 1 << 16;

/// Parts a stream of bytes: a line that begins like a JSON object is one if all of it is text; everything else is for the gateway,
/// to the last byte and in its order.
#[derive(Debug, Default)]
pub struct Stream {
    kept: Vec<u8>,
    /// A byte of the line has come that is no object's.
    is_within: bool,
}

/// What has come.
#[derive(Debug, PartialEq)]
pub enum Part<'a> {
    /// Bytes for the gateway.
    Bytes(&'a [u8]),
    /// A line that may be an object.
    Object(&'a [u8]),
}

impl Stream {
    /// Takes bytes.
    pub fn push(&mut self, bytes: &[u8], take: &mut dyn FnMut(Part<'_>)) {
        let mut rest = bytes;
        while let Some((first, after)) = rest.split_first() {
            if self.is_within || (self.kept.is_empty() && *first != b'{') {
                let end = rest.iter().position(|byte| is_end(*byte));
                let (line, next) = rest.split_at(end.map_or(rest.len(), |end| end + 1));
                self.is_within = end.is_none();
                take(Part::Bytes(line));
                rest = next;
            } else {
                self.keep(*first, take);
                rest = after;
            }
        }
    }

    /// A byte of a line that may be an object.
    fn keep(&mut self, byte: u8, take: &mut dyn FnMut(Part<'_>)) {
        if is_end(byte) {
            take(Part::Object(&self.kept));
            self.kept.clear();
            return;
        }
        self.kept.push(byte);
        let is_text = byte >= b' ' || byte == b'\t';
        let begins = (self.kept.get(1)).is_none_or(|second| b"\" \t}".contains(second));
        if !is_text || !begins || self.kept.len() > MOST {
            take(Part::Bytes(&self.kept));
            self.kept.clear();
            self.is_within = true;
        }
    }

    /// The stream has ended: what is left of it.
    pub fn end(&mut self, take: &mut dyn FnMut(Part<'_>)) {
        if !self.kept.is_empty() {
            take(Part::Object(&self.kept));
        }
        self.kept.clear();
        self.is_within = false;
    }
}

fn is_end(byte: u8) -> bool {
    matches!(byte, b'\r' | b'\n')
}
