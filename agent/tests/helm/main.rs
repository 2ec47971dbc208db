//! Helm decisions: programs applied to pictures.

mod behaviour;
mod knowledge;
mod mode;
mod place;
mod scene;
mod symmetry;
