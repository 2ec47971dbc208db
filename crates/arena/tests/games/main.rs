//! Whole games in one process, from shipped files and from files that a test writes.

mod chance;
mod drift;
mod encounters;
mod files;
mod flag;
mod game;
mod shipped_strategies;
