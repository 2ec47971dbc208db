//! Does the helm's solver find what there is to find?

mod exact;
mod scene;
mod shape;
mod symmetry;
