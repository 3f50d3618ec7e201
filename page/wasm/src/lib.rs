//! What the page computes in the browser.
//!
//! - [`Hunt`]: a simulated drive past sources, and a locator that is told of it bearing by bearing;
//! - [`Log`]: a log from the field through a vehicle's gateway, as `foxhunt replay` reads it;
//! - [`Walkers`]: eight people in a tunnel, through the gateway of the tunnel.
//!
//! All of them answer with the [`messages`] that the page draws. Here they are JSON, on a desk as in the browser: the same
//! text, to the last digit. [`exports`] are what the browser calls.

pub mod exports;
mod hunt;
mod known;
mod locators;
mod log;
pub mod messages;
mod walkers;

pub use hunt::{Hunt, Options as HuntOptions};
pub use locators::{Choice, Kind, PARTICLES, Refinement};
pub use log::{Log, Options as LogOptions};
pub use walkers::{Options as WalkersOptions, Walkers};
