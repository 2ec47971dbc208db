//! libFuzzer entry point for the target `exo2`.

#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| squall_fuzz::soak::check(
    &squall_fuzz::named("exo2").expect("a target"),
    bytes
));
