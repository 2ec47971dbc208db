//! The request to stop: Ctrl-C, SIGTERM, or the end of the parent process.

use crate::clock;
use anyhow::Context;
use std::io::BufRead;
use std::process::ExitCode;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, channel};
use std::time::Duration;

/// The exit code of a program ended by Ctrl-C, as shells report it.
pub fn interrupted() -> ExitCode {
    ExitCode::from(130)
}

/// A flag that Ctrl-C or SIGTERM sets; a second one ends the process at once.
pub fn on_ctrl_c() -> anyhow::Result<Arc<AtomicBool>> {
    let stop = Arc::new(AtomicBool::new(false));
    let flag = Arc::clone(&stop);
    let pressed = move || {
        if flag.swap(true, Ordering::Relaxed) {
            std::process::exit(130);
        }
    };
    ctrlc::set_handler(pressed).context("cannot handle Ctrl-C")?;
    Ok(stop)
}

/// Ends the process soon after the flag is set, even if it is still busy or waiting for the
/// network. Use it only in commands whose files are complete at any time.
pub fn exit_when_late(stop: &Arc<AtomicBool>) {
    when_late(stop, || std::process::exit(130));
}

/// Calls `act` if the command has not ended soon after the flag is set.
pub fn when_late(stop: &Arc<AtomicBool>, act: impl FnOnce() + Send + 'static) {
    const LATE: Duration = Duration::from_millis(1400);
    let flag = Arc::clone(stop);
    std::thread::spawn(move || {
        wait(&flag);
        clock::rest(LATE);
        act();
    });
}

/// Like [`on_ctrl_c`]; in a child process, the end of standard input sets the flag too.
pub fn on_ctrl_c_or_parent(for_parent: bool) -> anyhow::Result<Arc<AtomicBool>> {
    let stop = on_ctrl_c()?;
    if for_parent {
        with_parent(&stop);
    }
    Ok(stop)
}

/// Sets the flag when standard input ends, since a child must not outlive its parent. Returns the
/// lines that the parent sends until then.
pub fn with_parent(stop: &Arc<AtomicBool>) -> Receiver<String> {
    let flag = Arc::clone(stop);
    let (sender, lines) = channel();
    std::thread::spawn(move || {
        for line in std::io::stdin().lock().split(b'\n').map_while(Result::ok) {
            // Not every child reads the lines.
            drop(sender.send(String::from_utf8_lossy(&line).into_owned()));
        }
        flag.store(true, Ordering::Relaxed);
    });
    lines
}

/// Waits briefly, and returns whether the flag is set.
pub fn is_set_soon(stop: &AtomicBool) -> bool {
    clock::rest(Duration::from_millis(100));
    stop.load(Ordering::Relaxed)
}

/// Waits until the flag is set.
pub fn wait(stop: &AtomicBool) {
    while !is_set_soon(stop) {}
}
