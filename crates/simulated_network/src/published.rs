//! A published message as an observer of a simulated network sees it.

use std::time::Duration;

/// A message as the hub sees it: what it publishes, and what reaches it.
#[derive(Clone, Copy, Debug)]
pub struct Published<'a> {
    /// When.
    pub at: Duration,
    /// Who published it, or takes it.
    pub node: &'a str,
    /// On which key.
    pub key: &'a str,
    /// What.
    pub bytes: &'a [u8],
}
