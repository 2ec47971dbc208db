//! The public behaviour of the referee: scenes with a few boats, and long random walks.

mod mirror;
mod out_of_play;
mod power_play;
mod preset;
mod scene;
mod tag_probability;
mod told;
mod walk;
