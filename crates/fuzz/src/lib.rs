//! Fuzzes every reader of external data: checks its guarantees on mutated real inputs.
//!
//! A [`Target`] is a kind of input. `soak` fuzzes one on stable Rust, with mutations of words,
//! numbers and bytes. libFuzzer runs the same checks.

mod change;
mod dice;
pub mod played;
pub mod soak;
mod target;

pub use dice::Dice;
pub use target::{TARGETS, Target, named};
