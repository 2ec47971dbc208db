//! Work that runs without the interpreter's lock and can be interrupted by Ctrl-C.

use pyo3::prelude::*;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::time::Duration;

/// Interval at which Python checks for Ctrl-C.
const EVERY: Duration = Duration::from_millis(100);

/// Runs work on another thread, while this one lets Python handle signals. A handler that raises an
/// exception sets the flag, which ends the work.
///
/// # Errors
/// The exception that the signal handler raises, such as `KeyboardInterrupt`.
pub(crate) fn heeded<T: Send>(work: impl FnOnce(&AtomicBool) -> T + Send) -> PyResult<T> {
    let stop = AtomicBool::new(false);
    std::thread::scope(|scope| {
        let (sender, receiver) = channel();
        let stop = &stop;
        // After a signal the receiver no longer exists.
        scope.spawn(move || drop(sender.send(work(stop))));
        loop {
            match receiver.recv_timeout(EVERY) {
                Ok(done) => return Ok(done),
                Err(RecvTimeoutError::Timeout) => {
                    // Otherwise the scope would wait for work whose result is not needed.
                    Python::attach(|py| py.check_signals())
                        .inspect_err(|_| stop.store(true, Ordering::Relaxed))?;
                }
                Err(RecvTimeoutError::Disconnected) => {
                    unreachable!("the work panicked, and the scope with it")
                }
            }
        }
    })
}
