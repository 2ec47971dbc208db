//! libFuzzer entry point for the target `scenario`.

#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| squall_fuzz::soak::check(
    &squall_fuzz::named("scenario").expect("a target"),
    bytes
));
