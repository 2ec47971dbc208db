//! Threads of a node in addition to its main thread.

use crate::Watched;
use crate::runtime::runtime;
use std::sync::Arc;
use std::thread::JoinHandle;
use std::time::Duration;

/// Starts a detached thread.
///
/// # Errors
/// If the system cannot start a thread.
pub fn start_thread(name: &str, body: impl FnOnce() + Send + 'static) -> std::io::Result<()> {
    runtime().spawn(name, Box::new(body)).map(drop)
}

/// How long a node waits for a thread that should end; the network may block the thread for 10 s.
const END_MAX: Duration = Duration::from_millis(1200);

/// A thread that is joined on drop, provided that it ends soon. Its work must be done by then.
pub struct NodeThread {
    is_done: Arc<Watched<bool>>,
    handle: Option<JoinHandle<()>>,
}

/// Signals the end of a thread, even after a panic.
struct Done(Arc<Watched<bool>>);

impl Drop for Done {
    fn drop(&mut self) {
        self.0.visit(|is_done| *is_done = true);
    }
}

impl NodeThread {
    /// Starts a thread.
    ///
    /// # Errors
    /// If the system cannot start a thread.
    pub fn start(body: impl FnOnce() + Send + 'static) -> std::io::Result<NodeThread> {
        let is_done = Arc::new(Watched::new(false));
        let done = Done(Arc::clone(&is_done));
        let body = move || {
            let _done = done;
            body();
        };
        let handle = runtime().spawn("node", Box::new(body))?;
        Ok(NodeThread { is_done, handle })
    }
}

impl Drop for NodeThread {
    fn drop(&mut self) {
        // Wait before `join`: not every runtime returns a handle.
        if self.is_done.wait(END_MAX, |is_done| *is_done) {
            // A panicked thread has no result.
            self.handle
                .take()
                .map(JoinHandle::join)
                .into_iter()
                .for_each(drop);
        }
    }
}
