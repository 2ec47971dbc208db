//! libFuzzer entry point for the target `model`.

#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| squall_fuzz::soak::check(
    &squall_fuzz::named("model").expect("a target"),
    bytes
));
