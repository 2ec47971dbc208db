//! Helms at the wheel: what programs make of pictures.

mod behaviour;
mod knowledge;
mod mode;
mod place;
mod scene;
mod symmetry;
