//! A callback that is due.

/// What is called when an event happens, with no lock held.
pub(crate) type Call = Box<dyn FnOnce() + Send>;
