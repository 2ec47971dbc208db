//! Small neural networks: dense layers, their gradients, and Adam.
//!
//! Single precision, with the same bits on any number of threads: rows are processed in shards of a
//! fixed size, whose results are summed in order. nalgebra multiplies the matrices.

mod adam;
mod model;
mod perceptron;

pub use adam::{Adam, AdamSettings};
pub use perceptron::{Perceptron, Trace};

/// Rows per shard.
pub const SHARD: usize = 256;
