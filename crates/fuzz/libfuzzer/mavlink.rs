//! libFuzzer entry point for the target `mavlink`.

#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| squall_fuzz::soak::check(
    &squall_fuzz::named("mavlink").expect("a target"),
    bytes
));
