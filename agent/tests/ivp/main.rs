//! The helm's solver: whether it finds the best decision there is.

mod exact;
mod scene;
mod shape;
mod symmetry;
