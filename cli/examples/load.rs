//! Publishes the tags of many gateways, and prints what became of them as JSON: a part of `cargo xtask load`.

use anyhow::Result;
use clap::Parser;
use foxhunt_cli::load::{Load, publish};

#[derive(Parser)]
struct Options {
    /// The broker: host and port.
    #[arg(long)]
    broker: String,
    #[arg(long)]
    gateways: usize,
    /// Tags of each gateway; 0 if each is a station that takes bearings.
    #[arg(long)]
    tags: usize,
    /// Fixes a second of each tag, or bearings a second of each station.
    #[arg(long)]
    rate: f64,
    #[arg(long)]
    seconds: f64,
}

fn main() -> Result<()> {
    let options = Options::parse();
    let published = publish(&Load {
        broker: options.broker,
        gateways: options.gateways,
        tags: options.tags,
        rate: options.rate,
        seconds: options.seconds,
    })?;
    println!("{}", serde_json::to_string(&published)?);
    Ok(())
}
