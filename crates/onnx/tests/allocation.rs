//! Networks allocate no memory in an evaluation, and little while a file is read.
//!
//! `stats_alloc` counts (see `sim/tests/allocation.rs`). There is a single test because the count
//! covers the whole process.

use onnx::Network;
use stats_alloc::{INSTRUMENTED_SYSTEM, Region, StatsAlloc};
use std::alloc::System;

#[global_allocator]
static HEAP: &StatsAlloc<System> = &INSTRUMENTED_SYSTEM;

/// Maximum memory to read any file of 1 MiB, bytes.
const FILE_COST_MAX: usize = 50 << 20;

fn field(number: u8, content: &[u8]) -> Vec<u8> {
    let mut length = content.len();
    let mut bytes = vec![number << 3 | 2];
    while length > 0x7f {
        bytes.push(length as u8 | 0x80);
        length >>= 7;
    }
    bytes.push(length as u8);
    bytes.extend(content);
    bytes
}

#[test]
fn an_evaluation_takes_nothing_from_the_heap_and_a_hostile_file_little() {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/network/operators.onnx");
    let mut network = Network::read(&std::fs::read(path).expect("the model can be read"))
        .expect("a valid network");
    // The test harness must have started this thread completely.
    (0..1_000).for_each(|i| network.evaluate(&[i as f32; 6]));
    let heap = Region::new(HEAP);
    (0..1_000).for_each(|i| network.evaluate(&[i as f32; 6]));
    let used = heap.change();
    assert_eq!(used.allocations + used.reallocations, 0, "{used:?}");

    // A megabyte of empty messages: nodes, tensors, or attributes of one node.
    for file in [[0x0a, 0x00], [0x2a, 0x00], [0x2a, 0x00]]
        .map(|pair| pair.repeat(1 << 19))
        .into_iter()
        .enumerate()
    {
        let (i, messages) = file;
        let graph = if i == 2 {
            field(1, &messages)
        } else {
            messages
        };
        let bytes = field(7, &graph);
        let heap = Region::new(HEAP);
        let error = Network::read(&bytes)
            .expect_err("too many fields")
            .to_string();
        let used = heap.change().bytes_allocated;
        assert!(error.starts_with("fields of the file"), "{error}");
        assert!(used < FILE_COST_MAX, "file {i}: {used} bytes");
    }
}
