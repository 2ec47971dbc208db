//! libFuzzer entry point for the target `sheet`.

#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| squall_fuzz::soak::check(
    &squall_fuzz::named("sheet").expect("a target"),
    bytes
));
