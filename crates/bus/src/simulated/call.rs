//! A callback that is due.

/// What is called when an event happens, with no lock held.
pub(super) type Call = Box<dyn FnOnce() + Send>;
