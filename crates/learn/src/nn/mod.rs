//! Small neural networks: plain layers, their gradients, and Adam.
//!
//! Everything is single precision with the same bits for any number of threads: rows are processed
//! in shards of a fixed size, and the shards' results are summed in order. Matrices are multiplied
//! by nalgebra.

mod adam;
mod model;
mod perceptron;

pub use adam::{Adam, AdamSettings};
pub use perceptron::{Perceptron, Trace};

/// Rows per shard.
pub const SHARD: usize = 256;
