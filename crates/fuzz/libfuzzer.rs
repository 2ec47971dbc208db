//! libFuzzer entry point for the target that the environment variable `SQUALL_FUZZ` names.
//!
//! Needs a nightly compiler and cargo-fuzz. To fuzz `nmea`, starting from real inputs:
//!
//! ```text
//! cargo run --release --manifest-path crates/fuzz/Cargo.toml --target-dir target -- \
//!     seeds crates/fuzz/corpus
//! SQUALL_FUZZ=nmea cargo +nightly fuzz run --fuzz-dir crates/fuzz --features libfuzzer \
//!     libfuzzer crates/fuzz/corpus/nmea
//! ```

#![no_main]

use squall_fuzz::{Target, named, soak};
use std::sync::LazyLock;

static TARGET: LazyLock<Target> = LazyLock::new(|| {
    let name = std::env::var("SQUALL_FUZZ").expect("SQUALL_FUZZ is the name of a target");
    named(&name).unwrap_or_else(|| panic!("unknown target {name}"))
});

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| soak::check(&TARGET, bytes));
