//! libFuzzer entry point for the target that the environment variable `SQUALL_FUZZ` names.

#![no_main]

use squall_fuzz::{Target, named, soak};
use std::sync::LazyLock;

static TARGET: LazyLock<Target> = LazyLock::new(|| {
    let name = std::env::var("SQUALL_FUZZ").expect("SQUALL_FUZZ is the name of a target");
    named(&name).unwrap_or_else(|| panic!("unknown target {name}"))
});

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| soak::check(&TARGET, bytes));
