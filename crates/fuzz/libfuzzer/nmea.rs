//! libFuzzer entry point for the target `nmea`.

#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| squall_fuzz::soak::check(
    &squall_fuzz::named("nmea").expect("a target"),
    bytes
));
