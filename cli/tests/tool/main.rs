//! The program as its users run it.

mod broker;
mod live;
mod program;
mod replay;
mod web;
