//! Helms at the wheel: what programs make of pictures.

mod behaviour;
mod knowledge;
mod mode;
mod scene;
mod symmetry;
