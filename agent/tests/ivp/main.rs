//! Does the helm's solver find what there is to find?

mod exact;
mod pieces;
mod scene;
mod shape;
mod symmetry;
