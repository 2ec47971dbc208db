//! libFuzzer entry point for the target `request`.

#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| squall_fuzz::soak::check(
    &squall_fuzz::named("request").expect("a target"),
    bytes
));
