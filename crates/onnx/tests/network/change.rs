//! Truncated and modified files are rejected or evaluated, without panics and with little memory.

use crate::{MODELS, file};
use onnx::Network;
use proptest::prelude::*;

/// Reads a file, and evaluates it if it is valid.
fn try_file(bytes: &[u8]) {
    match Network::read(bytes) {
        Ok(mut network) => network.evaluate(&vec![0.5; network.input_size()]),
        Err(error) => {
            let text = error.to_string();
            assert!(
                text.len() < 2_000 && !text.chars().any(char::is_control),
                "{text:?}"
            );
        }
    }
}

#[test]
fn a_file_cut_anywhere_is_refused() {
    for model in ["operators", "old_operators", "two_inputs"] {
        let bytes = file(model);
        for length in 0..bytes.len() {
            // A file truncated before optional fields is still valid.
            if let Ok(network) = Network::read(&bytes[..length]) {
                assert!(network.metadata().len() < 2, "{model} of {length} bytes");
            }
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 3_000, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn a_changed_file_does_not_panic(
        model in 0..MODELS.len(),
        changes in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 1..8),
    ) {
        let mut bytes = file(MODELS[model]);
        for (at, byte) in changes {
            let at = at.index(bytes.len());
            bytes[at] = byte;
        }
        try_file(&bytes);
    }

    #[test]
    fn a_file_with_bytes_taken_out_or_twice_does_not_panic(
        model in 0..MODELS.len(),
        from in any::<prop::sample::Index>(),
        to in any::<prop::sample::Index>(),
        at in any::<prop::sample::Index>(),
    ) {
        let bytes = file(MODELS[model]);
        let from = from.index(bytes.len());
        let to = to.index(bytes.len());
        let at = at.index(bytes.len());
        let part = &bytes[from.min(to)..from.max(to)];
        try_file(&[&bytes[..at], part, &bytes[at..]].concat());
        try_file(&[&bytes[..from.min(to)], &bytes[from.max(to)..]].concat());
    }

    #[test]
    fn any_bytes_do_not_panic(bytes in prop::collection::vec(any::<u8>(), 0..200)) {
        try_file(&bytes);
    }
}
