//! Whole games in one process: of the shipped files, and of a test's own.

mod chance;
mod drift;
mod encounters;
mod files;
mod game;
mod shipped_strategies;
