//! Begins and ends everything.

use std::{sync::Arc, time::Duration};

use anyhow::{Context, Result};
use tokio::task::JoinHandle;

use super::{
    clock::now_ms,
    core::{Ask, Core, Search},
    hub::Hub,
    status::Status,
};
use crate::{
    engine::Engine,
    input::{self, Demo, Feed},
    log::Writer,
    output,
    settings::Settings,
    web,
};

/// What is run beside the settings.
#[derive(Default)]
pub struct Extra {
    /// Simulated inputs, in the place of the settings' own.
    pub demo: Option<Demo>,
    /// Ends when all inputs have ended, as of the standard input or a demo.
    pub until_end: bool,
}

/// Runs until Ctrl-C, or the end of all inputs; gives the search.
///
/// # Errors
/// If something cannot be begun, or the log not be written.
pub fn run(settings: &Settings, extra: Extra) -> Result<Engine> {
    // An error means that it is installed already.
    let _ = rustls::crypto::ring::default_provider().install_default();
    let runtime = tokio::runtime::Builder::new_multi_thread()
        .worker_threads(2)
        .enable_all()
        .build()
        .context("cannot begin")?;
    let done = runtime.block_on(serve(settings, extra));
    // A thread may wait for a serial port or the standard input.
    runtime.shutdown_timeout(Duration::from_millis(200));
    done
}

/// Looks whether a search could begin.
///
/// # Errors
/// Says what is wrong.
pub fn check(settings: &Settings) -> Result<()> {
    Engine::new(&settings.into()).map(drop)
}

async fn serve(settings: &Settings, extra: Extra) -> Result<Engine> {
    let engine = Engine::new(&settings.into())?;
    let log = match &settings.log {
        Some(log) => Some(Writer::new(log, settings)?),
        None => None,
    };
    let hub = Arc::new(Hub::new(now_ms() as u64));
    let status = |name: &str, silent_s| Arc::new(Status::new(name, silent_s));
    let inputs: Vec<Arc<Status>> = (settings.input.iter())
        .map(|input| status(&input.name, input.silent_s.unwrap_or(10)))
        .collect();
    let outputs: Vec<Arc<Status>> = (settings.output.iter())
        .map(|output| status(&output.name, 0))
        .collect();
    let (search, asks) = Search::new();
    let mut senders = Vec::with_capacity(outputs.len());
    for (output, status) in settings.output.iter().zip(&outputs) {
        let reader = hub.reader(hub.seq());
        senders.push(output::start(settings, output, reader, status.clone()).await?);
    }
    if settings.web.enabled {
        web::start(&settings.web, hub.clone(), search.clone()).await?;
    }
    let core = Core {
        engine,
        log,
        hub: hub.clone(),
        inputs: inputs.clone(),
        outputs: outputs.clone(),
    };
    let (over, is_over) = tokio::sync::oneshot::channel();
    std::thread::Builder::new()
        .name("search".into())
        .stack_size(64 << 20)
        .spawn(move || {
            let _ = over.send(core.run(asks));
        })
        .context("cannot begin the search")?;
    let mut tasks = tokio::task::JoinSet::new();
    let feeds = inputs.iter().enumerate();
    let mut feeds: Vec<Feed> = feeds
        .map(|(input, status)| Feed::new(input, search.clone(), status.clone()))
        .collect();
    if let Some(demo) = extra.demo {
        tasks.spawn(demo.run(feeds));
    } else {
        for (input, feed) in settings.input.iter().zip(feeds.drain(..)) {
            tasks.spawn(input::run(input.source()?, feed, settings.name.to_string()));
        }
    }
    let ended = async {
        while tasks.join_next().await.is_some() {}
        if !extra.until_end {
            std::future::pending::<()>().await;
        }
    };
    let ticks = async {
        let mut every = tokio::time::interval(Duration::from_secs(1));
        loop {
            every.tick().await;
            search.send(Ask::Tick).await;
        }
    };
    tokio::pin!(is_over);
    tokio::select! {
        () = ended => {}
        () = ticks => {}
        () = stopped() => {}
        // The log could not be written.
        over = &mut is_over => return over.context("the search has failed")?,
    }
    search.send(Ask::Stop).await;
    let engine = is_over.await.context("the search has failed")??;
    end(&hub, senders).await;
    Ok(engine)
}

/// Lets outputs send what there is.
async fn end(hub: &Hub, senders: Vec<JoinHandle<()>>) {
    hub.end();
    tokio::select! {
        () = output::settled(senders) => {}
        // Who asks twice does not want to wait.
        () = stopped() => {}
    }
}

/// Waits for Ctrl-C, or until the system ends the program.
async fn stopped() {
    #[cfg(unix)]
    {
        use tokio::signal::unix::{SignalKind, signal};
        if let Ok(mut terminated) = signal(SignalKind::terminate()) {
            tokio::select! {
                _ = tokio::signal::ctrl_c() => {}
                _ = terminated.recv() => {}
            }
            return;
        }
    }
    let _ = tokio::signal::ctrl_c().await;
}
