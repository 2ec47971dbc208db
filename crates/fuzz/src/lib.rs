//! Arbitrary bytes for everything that takes bytes from outside: what each reader promises, checked on changed real inputs.
//!
//! A [`Target`] is a kind of input. `soak` runs one on stable, with changes that know what such an input looks like;
//! libFuzzer runs the same checks.

pub mod change;
mod dice;
pub mod played;
pub mod soak;
mod target;

pub use dice::Dice;
pub use target::{TARGETS, Target, named};
