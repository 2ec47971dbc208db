//! Small neural networks: plain layers, their gradients, and Adam.
//!
//! Everything is single precision and the same to the bit on any number of threads: rows are worked on in shards of a fixed size, and
//! what shards add up to is summed in their order. Matrices are multiplied by nalgebra.

mod adam;
mod model;
mod perceptron;

pub use adam::{Adam, AdamSettings};
pub use perceptron::{Perceptron, Trace};

/// Rows of a shard.
pub const SHARD: usize = 256;
