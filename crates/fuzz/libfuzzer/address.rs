//! libFuzzer entry point for the target `address`.

#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| squall_fuzz::soak::check(
    &squall_fuzz::named("address").expect("a target"),
    bytes
));
