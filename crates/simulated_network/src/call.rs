//! A callback that is due.

/// A callback for an event, called with no lock held.
pub(crate) type Call = Box<dyn FnOnce() + Send>;
