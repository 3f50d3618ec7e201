//! Where bytes come from.

mod again;
mod demo;
mod feed;
mod file;
mod http;
mod mqtt;
mod post;
mod run;
mod serial;
mod stdin;
mod tcp;
mod udp;
mod websocket;

pub use demo::Demo;
pub use feed::Feed;
pub use run::run;
