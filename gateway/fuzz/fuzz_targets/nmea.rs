//! libFuzzer's way into the target that it shares with the soak.

#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| squall_gateway_fuzz::target(bytes));
