//! Scenario files of every kind: shipped files, broken files, noise, and the reference pages.

#![expect(clippy::unwrap_used, reason = "a test that cannot go on has failed")]

mod broken;
mod hostile;
#[path = "../../src/kinds.rs"]
mod kinds;
mod recognised;
mod reference;
mod shipped;
