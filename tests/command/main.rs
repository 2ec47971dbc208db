//! Tests the program's commands from outside: output, files and error messages.
#![expect(clippy::unwrap_used, reason = "a test that cannot continue has failed")]

mod full_disk;
mod import;
mod league;
mod log;
mod memory;
mod names;
mod policy;
mod program;
mod refusals;
mod sea;
mod strategy;
mod tournament;
mod train;
mod trial;
