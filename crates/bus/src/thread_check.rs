//! Whether a process has the zenoh threads required for a node with keys.

use crate::BusError;
use crate::zenoh_threads::{KEYS_RUNTIME, RUNTIME_VARIABLE};
use std::os::unix::process::CommandExt;
use std::process::Command;

/// Restarts this program in the same process, with the same arguments and the threads required for
/// a node with keys. Returns immediately if it has them. Call it first of all: the restart discards
/// all state of the process.
///
/// # Errors
/// [`BusError::Threads`] if the program cannot be restarted.
pub fn restart_for_keys() -> Result<(), BusError> {
    if has_threads_for_keys() {
        return Ok(());
    }
    let refused = |error| BusError::Threads(format!("this program cannot be started again with it: {error}"));
    let mut again = Command::new(std::env::current_exe().map_err(refused)?);
    Err(refused(again.args(std::env::args_os().skip(1)).env(RUNTIME_VARIABLE, KEYS_RUNTIME).exec()))
}

/// # Errors
/// [`BusError::Threads`] if this process may not open a session with keys.
pub(crate) fn check_threads_for_keys() -> Result<(), BusError> {
    if has_threads_for_keys() {
        return Ok(());
    }
    let found =
        std::env::var_os(RUNTIME_VARIABLE).map_or("it is not set".to_owned(), |it| format!("it is {}", it.display()));
    Err(BusError::Threads(format!("{found}: call bus::restart_for_keys() first in main")))
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
        make(folder.path(), &[Identity::Observer], &["localhost".to_owned()], Duration::from_secs(60)).expect("keys");
        let keys = Some(Arc::new(Bundle::load(&folder.path().join("observer")).expect("good keys")));
        let net = Net { connect: vec!["tcp/127.0.0.1:1".to_owned()], keys, ..Net::default() };
        let error = Bus::leaf(&net).err().expect("it is refused").to_string();
        assert!(error.contains("ZENOH_RUNTIME=(rx:") && error.contains("bus::restart_for_keys()"), "{error}");
    }
}
