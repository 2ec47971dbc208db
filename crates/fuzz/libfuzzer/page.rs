//! libFuzzer entry point for the target `page`.

#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| squall_fuzz::soak::check(
    &squall_fuzz::named("page").expect("a target"),
    bytes
));
