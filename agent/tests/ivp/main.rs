//! The helm's solver: it must find the best decision.

mod exact;
mod scene;
mod shape;
mod symmetry;
