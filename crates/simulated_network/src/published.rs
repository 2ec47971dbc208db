//! A published message as an observer of a simulated network sees it.

use std::time::Duration;

/// A published message at the hub: sent by it, or received.
#[derive(Clone, Copy, Debug)]
pub struct Published<'a> {
    /// Virtual time since the start.
    pub at: Duration,
    /// The node that publishes it, or receives it.
    pub node: &'a str,
    /// Its key.
    pub key: &'a str,
    /// Its content.
    pub bytes: &'a [u8],
}
