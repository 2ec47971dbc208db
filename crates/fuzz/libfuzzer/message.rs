//! libFuzzer entry point for the target `message`.

#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| squall_fuzz::soak::check(
    &squall_fuzz::named("message").expect("a target"),
    bytes
));
