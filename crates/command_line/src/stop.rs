//! The request to stop: Ctrl-C, SIGTERM, or the end of the process that started us.

use crate::clock;
use anyhow::Context;
use std::io::BufRead;
use std::process::ExitCode;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, channel};
use std::time::Duration;

/// What a shell says of a program that Ctrl-C ended.
pub fn interrupted() -> ExitCode {
    ExitCode::from(130)
}

/// A flag that Ctrl-C or SIGTERM sets; pressed a second time they end the process at once.
pub fn on_ctrl_c() -> anyhow::Result<Arc<AtomicBool>> {
    let stop = Arc::new(AtomicBool::new(false));
    let flag = Arc::clone(&stop);
    let pressed = move || {
        if flag.swap(true, Ordering::Relaxed) {
            std::process::exit(130);
        }
    };
    ctrlc::set_handler(pressed).context("cannot listen for Ctrl-C")?;
    Ok(stop)
}

/// The same flag; in a child, the end of standard input sets it too.
pub fn on_ctrl_c_or_parent(for_parent: bool) -> anyhow::Result<Arc<AtomicBool>> {
    let stop = on_ctrl_c()?;
    if for_parent {
        with_parent(&stop);
    }
    Ok(stop)
}

/// Sets the flag when standard input ends: a child whose parent has died, however it died, must not stay. Gives what the
/// parent sends before, line by line.
pub fn with_parent(stop: &Arc<AtomicBool>) -> Receiver<String> {
    let flag = Arc::clone(stop);
    let (sender, lines) = channel();
    std::thread::spawn(move || {
        for line in std::io::stdin().lock().split(b'\n').map_while(Result::ok) {
            // Not every child listens.
            drop(sender.send(String::from_utf8_lossy(&line).into_owned()));
        }
        flag.store(true, Ordering::Relaxed);
    });
    lines
}

/// Whether the flag is set, after a little while.
pub fn is_set_soon(stop: &AtomicBool) -> bool {
    clock::rest(Duration::from_millis(100));
    stop.load(Ordering::Relaxed)
}

/// Waits for the flag.
pub fn wait(stop: &AtomicBool) {
    while !is_set_soon(stop) {}
}
