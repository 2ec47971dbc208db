//! The helm's solver must find the best decision.

mod exact;
mod scene;
mod shape;
mod symmetry;
