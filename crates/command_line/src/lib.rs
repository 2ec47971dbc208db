//! Code shared by the command-line programs: arguments, terminal text, full errors, the request to
//! stop.

pub mod clock;
pub mod explain;
#[cfg(feature = "network")]
pub mod leaf_args;
pub mod number;
#[cfg(feature = "network")]
pub mod observer;
pub mod output_file;
pub mod printer;
pub mod program;
pub mod recording_file;
pub mod scenario_files;
pub mod stop;
pub mod style;
pub mod terminal;
