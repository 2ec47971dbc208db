//! zenoh's threads in a process. zenoh reads their number from the environment, once, before the
//! first session is opened.

use crate::BusError;
use std::os::unix::process::CommandExt;
use std::process::Command;

/// The environment variable that configures zenoh's threads.
pub const RUNTIME_VARIABLE: &str = "ZENOH_RUNTIME";

/// A value of [`RUNTIME_VARIABLE`] for a process that is one node: few threads in place of zenoh's
/// pools, which shortens a lockstep round trip by a quarter to a half. Reception has its own
/// thread: a hub that forwards a large message waits in that thread for a free slot in the sending
/// queue, which another thread must empty. Accepting links also has its own thread: a link that is
/// never completed is closed with its linger time enabled, which may block the thread.
pub const RUNTIME: &str =
    // One pool of two threads was tried for everything. When a hub forwarded an answer of half a
    // megabyte, both threads waited for a free slot in the sender's queue, the sender had no thread
    // left, and all agents were lost for three seconds.
    "(rx:(worker_threads:1),acc:(worker_threads:1),tx:(handover:app),net:(handover:app),app:(worker_threads:1))";

/// Like [`RUNTIME`], for the hub of a game paced by the clock: such a game may include real boats,
/// which people must be able to stop. A receiving thread serves no other link while its current
/// link has data: each peer that sends without pause occupies one thread, and an E-stop needs a
/// free one. In lockstep, where a second thread costs time, all boats are simulated.
pub const HUB_RUNTIME: &str =
    // Measured with 250 E-stops, during 400,000 garbage messages a second: 12.4 ms (median) to 124
    // ms with one receiving thread, less than 0.1 ms to 6.6 ms with two.
    "(rx:(worker_threads:4),acc:(worker_threads:1),tx:(handover:app),net:(handover:app),app:(worker_threads:1))";

/// Like [`RUNTIME`], for a process with keys. zenoh (1.10, `zenoh-link-tls`) reads and writes a TLS
/// link at once through one object that is not thread-safe: with two threads, rustls' state is
/// overwritten and the process dies. Therefore a single thread does everything.
pub(crate) const KEYS_RUNTIME: &str =
    // With two threads and sixteen agents in lockstep the sim died within a minute. Upstream should
    // split the stream, or use one lock for both halves; the alternative is QUIC, which has one
    // object per direction.
    "(rx:(handover:app),acc:(handover:app),tx:(handover:app),net:(handover:app),app:(worker_threads:1))";

/// Restarts this program in the same process, with the same arguments and the threads required for
/// a node with keys. Returns immediately if the process already has them. Call it before anything
/// else: the restart discards all state of the process.
///
/// # Errors
/// [`BusError::Threads`] if the program cannot be restarted.
pub fn restart_for_keys() -> Result<(), BusError> {
    if has_threads_for_keys() {
        return Ok(());
    }
    let refused =
        |error| BusError::Threads(format!("this program cannot be restarted with it: {error}"));
    let mut again = Command::new(std::env::current_exe().map_err(refused)?);
    Err(refused(
        again
            .args(std::env::args_os().skip(1))
            .env(RUNTIME_VARIABLE, KEYS_RUNTIME)
            .exec(),
    ))
}

/// Checks that this process has the threads that a session with keys requires.
///
/// # Errors
/// [`BusError::Threads`] if this process may not open a session with keys.
pub(crate) fn check_threads_for_keys() -> Result<(), BusError> {
    if has_threads_for_keys() {
        return Ok(());
    }
    let found = std::env::var_os(RUNTIME_VARIABLE).map_or("it is not set".to_owned(), |it| {
        format!("it is {}", it.display())
    });
    Err(BusError::Threads(format!(
        "{found}: call bus::restart_for_keys() first in main"
    )))
}

fn has_threads_for_keys() -> bool {
    std::env::var(RUNTIME_VARIABLE).is_ok_and(|it| it == KEYS_RUNTIME)
}

#[cfg(test)]
mod tests {
    use crate::keys::{Bundle, Identity, make};
    use crate::{Bus, Net};
    use std::sync::Arc;
    use std::time::Duration;

    #[test]
    fn a_process_with_other_threads_opens_no_session_with_keys() {
        let folder = tempfile::tempdir().expect("a folder");
        make(
            folder.path(),
            &[Identity::Observer],
            &["localhost".to_owned()],
            Duration::from_secs(60),
        )
        .expect("keys");
        let keys = Some(Arc::new(
            Bundle::load(&folder.path().join("observer")).expect("good keys"),
        ));
        let net = Net {
            connect: vec!["tcp/127.0.0.1:1".to_owned()],
            keys,
            ..Net::default()
        };
        let error = Bus::leaf(&net).err().expect("it is refused").to_string();
        assert!(
            error.contains("ZENOH_RUNTIME=(rx:") && error.contains("bus::restart_for_keys()"),
            "{error}"
        );
    }
}
