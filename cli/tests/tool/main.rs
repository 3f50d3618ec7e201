//! The program as its users run it.

mod board;
mod broker;
mod chapters;
mod damage;
mod floors;
mod gateway;
mod live;
mod program;
mod replay;
#[cfg(target_os = "linux")]
mod restarts;
mod survey;
mod told;
mod web;
