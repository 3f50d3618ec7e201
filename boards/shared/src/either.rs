//! Lines of two kinds as one.

use embedded_io_async::{Error, ErrorKind, ErrorType, Read, Write};

/// One of two readers or writers.
#[derive(Debug)]
pub enum Either<A, B> {
    /// The one.
    One(A),
    /// The other.
    Other(B),
}

impl<A: ErrorType, B: ErrorType> ErrorType for Either<A, B> {
    type Error = ErrorKind;
}

impl<A: Read, B: Read> Read for Either<A, B> {
    async fn read(&mut self, buffer: &mut [u8]) -> Result<usize, Self::Error> {
        match self {
            Self::One(line) => line.read(buffer).await.map_err(|error| error.kind()),
            Self::Other(line) => line.read(buffer).await.map_err(|error| error.kind()),
        }
    }
}

impl<A: Write, B: Write> Write for Either<A, B> {
    async fn write(&mut self, bytes: &[u8]) -> Result<usize, Self::Error> {
        match self {
            Self::One(line) => line.write(bytes).await.map_err(|error| error.kind()),
            Self::Other(line) => line.write(bytes).await.map_err(|error| error.kind()),
        }
    }

    async fn flush(&mut self) -> Result<(), Self::Error> {
        match self {
            Self::One(line) => line.flush().await.map_err(|error| error.kind()),
            Self::Other(line) => line.flush().await.map_err(|error| error.kind()),
        }
    }
}
