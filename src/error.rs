//! What errors say.

/// The message of each variant of an error, which makes it a [`core::error::Error`].
macro_rules! messages {
    ($error:ident { $($variant:pat => $message:literal),+ $(,)? }) => {
        impl $error {
            /// What it says.
            pub const fn message(&self) -> &'static str {
                match self { $($variant => $message),+ }
            }
        }

        impl core::fmt::Display for $error {
            fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
                f.write_str(self.message())
            }
        }

        impl core::error::Error for $error {}
    };
}
pub(crate) use messages;
