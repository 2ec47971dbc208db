//! Errors of reading and writing networks.

use thiserror::Error;

/// Longest name in a message, characters: files may have names of any length.
const NAME_MAX: usize = 80;

/// Why a file cannot be read as a network, or a network cannot be written. Each message gives the
/// place, the value found and the allowed values.
#[derive(Clone, Debug, Error, PartialEq, Eq)]
pub enum NetworkError {
    /// A quantity exceeds its limit.
    #[error("{what}: found {found}, allowed are at most {max}")]
    TooLarge {
        /// The quantity.
        what: String,
        /// Its value.
        found: usize,
        /// Its limit.
        max: usize,
    },
    /// The bytes are not an ONNX file, or are truncated or damaged.
    #[error("not an ONNX file, or a damaged one: byte {byte}: {found}")]
    NotOnnx {
        /// Offset of the fault, from 0.
        byte: usize,
        /// The fault.
        found: String,
    },
    /// The model as a whole cannot be evaluated.
    #[error("the model: found {found}, expected {expected}")]
    Model {
        /// What was found.
        found: String,
        /// What is allowed.
        expected: String,
    },
    /// A tensor cannot be used.
    #[error("tensor `{tensor}`: found {found}, expected {expected}")]
    Tensor {
        /// Its name.
        tensor: String,
        /// What was found.
        found: String,
        /// What is allowed.
        expected: String,
    },
    /// A tensor's numbers are in a second file.
    #[error(
        "tensor `{tensor}`: found a reference to another file, expected its numbers: export the model with \
         external_data=False"
    )]
    ExternalData {
        /// Its name.
        tensor: String,
    },
    /// An unsupported operator.
    #[error("node `{node}`: found the operator {operator}, expected one of {allowed}")]
    Operator {
        /// The node's name.
        node: String,
        /// Its operator.
        operator: String,
        /// The supported operators.
        allowed: String,
    },
    /// A supported operator in an unsupported form.
    #[error("node `{node}` ({operator}): found {found}, expected {expected}")]
    Node {
        /// The node's name.
        node: String,
        /// Its operator.
        operator: &'static str,
        /// What was found.
        found: String,
        /// What is allowed.
        expected: String,
    },
}

impl NetworkError {
    pub(super) fn model(found: impl Into<String>, expected: impl Into<String>) -> NetworkError {
        NetworkError::Model { found: found.into(), expected: expected.into() }
    }

    pub(super) fn tensor(tensor: &str, found: impl Into<String>, expected: impl Into<String>) -> NetworkError {
        NetworkError::Tensor { tensor: shown(tensor), found: found.into(), expected: expected.into() }
    }
}

/// A name from a file, shortened for a message.
pub(super) fn shown(name: &str) -> String {
    let head: String = name.chars().take(NAME_MAX).collect();
    head.escape_debug().to_string() + if head.len() < name.len() { "…" } else { "" }
}

/// A shape for a message: `1 x 45`.
pub(super) fn shape_text(shape: &[usize]) -> String {
    if shape.is_empty() {
        return "a single number".to_owned();
    }
    let head: Vec<String> = shape.iter().take(16).map(usize::to_string).collect();
    format!("the shape {}{}", head.join(" x "), if shape.len() > head.len() { " x …" } else { "" })
}
