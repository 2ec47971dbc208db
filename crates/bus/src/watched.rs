//! A value that callbacks change and that a node reads, or waits on until a condition holds.

use crate::clock;
use crate::runtime::runtime;
use parking_lot::{Condvar, Mutex};
use std::time::Duration;

/// A value that one thread changes and another waits for.
#[derive(Default)]
pub struct Watched<T> {
    state: Mutex<T>,
    changed: Condvar,
}

impl<T> Watched<T> {
    /// Starts with this value.
    pub fn new(state: T) -> Watched<T> {
        Watched {
            state: Mutex::new(state),
            changed: Condvar::new(),
        }
    }

    /// Reads or changes the value, and wakes waiting threads.
    pub fn visit<R>(&self, visit: impl FnOnce(&mut T) -> R) -> R {
        let result = visit(&mut self.state.lock());
        self.changed.notify_all();
        runtime().notify(self.address());
        result
    }

    /// Waits up to `limit` until `holds`; returns whether it does.
    pub fn wait(&self, limit: Duration, mut holds: impl FnMut(&T) -> bool) -> bool {
        let runtime = runtime();
        let deadline = clock::now().checked_add(limit);
        // The value stays unlocked while a runtime waits.
        while !holds(&self.state.lock()) {
            match runtime.wait(self.address(), deadline) {
                Some(true) => {}
                Some(false) => return holds(&self.state.lock()),
                None => {
                    let mut state = self.state.lock();
                    return !self
                        .changed
                        .wait_while_for(&mut state, |state| !holds(state), limit)
                        .timed_out();
                }
            }
        }
        true
    }

    /// The address by which a runtime identifies this value.
    fn address(&self) -> usize {
        std::ptr::from_ref(self).addr()
    }
}
