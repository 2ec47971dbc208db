//! libFuzzer entry point for the target `recording`.

#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| squall_fuzz::soak::check(
    &squall_fuzz::named("recording").expect("a target"),
    bytes
));
