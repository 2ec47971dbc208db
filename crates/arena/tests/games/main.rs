//! Whole games in one process, from the shipped files and from a test's own.

mod chance;
mod drift;
mod encounters;
mod files;
mod flag;
mod game;
mod shipped_strategies;
