//! A page that is fetched again and again, as a KrakenSDR shows its last reading.

use std::time::Duration;

use axum::body::Body;
use http_body_util::{BodyExt, Limited};
use hyper_util::{
    client::legacy::{Client, connect::HttpConnector},
    rt::TokioExecutor,
};
use tokio::time::{MissedTickBehavior, interval, timeout};

use super::{
    again::{Failure, Never, again},
    feed::Feed,
};

/// The most bytes of a page.
const LARGEST: usize = 1 << 20;
/// How long a page may take.
const PATIENCE: Duration = Duration::from_secs(5);

type Browser = Client<HttpConnector, Body>;

/// Fetches it; a page that is the same as before says nothing new.
pub async fn run(url: String, every_ms: u64, feed: Feed) {
    let browser: Browser = Client::builder(TokioExecutor::new()).build_http();
    again(&feed.status, || fetch(&browser, &url, every_ms, &feed)).await;
}

async fn fetch(browser: &Browser, url: &str, every_ms: u64, feed: &Feed) -> Result<Never, Failure> {
    let address = url
        .parse()
        .map_err(|error| Failure::closed(format!("{url}: {error}")))?;
    let address: axum::http::Uri = address;
    let mut every = interval(Duration::from_millis(every_ms));
    every.set_missed_tick_behavior(MissedTickBehavior::Delay);
    let mut last = Vec::new();
    let mut was_open = false;
    loop {
        every.tick().await;
        let page = timeout(PATIENCE, page(browser, address.clone())).await;
        let page = page.unwrap_or_else(|_| Err("no answer".into()));
        match page {
            Ok(page) => {
                if !was_open {
                    feed.status.opened();
                }
                was_open = true;
                if page != last && !page.trim_ascii().is_empty() {
                    feed.message(&page).await;
                    last = page;
                }
            }
            Err(error) if was_open => return Err(Failure::open(format!("{url}: {error}"))),
            Err(error) => return Err(Failure::closed(format!("{url}: {error}"))),
        }
    }
}

async fn page(browser: &Browser, address: axum::http::Uri) -> Result<Vec<u8>, String> {
    let answer = browser.get(address).await;
    let answer = answer.map_err(|error| error.to_string())?;
    if !answer.status().is_success() {
        return Err(answer.status().to_string());
    }
    let body = Limited::new(answer.into_body(), LARGEST).collect().await;
    Ok(body.map_err(|error| error.to_string())?.to_bytes().to_vec())
}
