//! Scenario files of every kind: those that are shipped, broken ones, noise, and the pages that describe them.

#![expect(clippy::unwrap_used, reason = "a test that cannot go on has failed")]

mod broken;
mod hostile;
#[path = "../../src/kinds.rs"]
mod kinds;
mod recognised;
mod reference;
mod shipped;
