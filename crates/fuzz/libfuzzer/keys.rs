//! libFuzzer entry point for the target `keys`.

#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| squall_fuzz::soak::check(
    &squall_fuzz::named("keys").expect("a target"),
    bytes
));
