//! Work without the interpreter's lock that Ctrl-C ends.

use pyo3::prelude::*;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::time::Duration;

/// How often Python is asked whether somebody has pressed Ctrl-C.
const EVERY: Duration = Duration::from_millis(100);

/// Does work on another thread than this one, which has Python look after its signals: one that raises sets the flag, and the work ends.
///
/// # Errors
/// What a signal's handler raises, such as `KeyboardInterrupt`.
pub(crate) fn heeded<T: Send>(work: impl FnOnce(&AtomicBool) -> T + Send) -> PyResult<T> {
    let stop = AtomicBool::new(false);
    std::thread::scope(|scope| {
        let (sender, receiver) = channel();
        let stop = &stop;
        // Nobody listens any more after a signal.
        scope.spawn(move || drop(sender.send(work(stop))));
        loop {
            match receiver.recv_timeout(EVERY) {
                Ok(done) => return Ok(done),
                Err(RecvTimeoutError::Timeout) => {
                    // Else the scope waits for work that nobody wants.
                    Python::attach(|py| py.check_signals()).inspect_err(|_| stop.store(true, Ordering::Relaxed))?;
                }
                Err(RecvTimeoutError::Disconnected) => unreachable!("the work panicked, and the scope with it"),
            }
        }
    })
}
