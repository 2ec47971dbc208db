//! Errors of reading and writing networks.

use thiserror::Error;

/// Maximum length of a name in a message, characters: names in files can be of any length.
const NAME_MAX: usize = 80;

/// Why a network cannot be read or written. Each message gives the place, the value found and the
/// values allowed.
#[derive(Clone, Debug, Error, PartialEq, Eq)]
pub enum NetworkError {
    /// A quantity exceeds its limit.
    #[error("{what}: found {found}, expected at most {max}")]
    TooLarge {
        /// The quantity.
        what: String,
        /// Its value.
        found: usize,
        /// Its limit.
        max: usize,
    },
    /// The bytes are not an ONNX file, or the file is truncated or damaged.
    #[error("not an ONNX file, or a damaged one: byte {byte}: {found}")]
    NotOnnx {
        /// Offset of the fault.
        byte: usize,
        /// The fault.
        found: String,
    },
    /// The bytes are a Git LFS pointer.
    #[error("a Git LFS pointer, expected the ONNX file that it stands for: run `git lfs pull`")]
    LfsPointer,
    /// The model as a whole cannot be evaluated.
    #[error("the model: found {found}, expected {expected}")]
    Model {
        /// The value found.
        found: String,
        /// The values allowed.
        expected: String,
    },
    /// A tensor cannot be used.
    #[error("tensor `{tensor}`: found {found}, expected {expected}")]
    Tensor {
        /// Its name.
        tensor: String,
        /// The value found.
        found: String,
        /// The values allowed.
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
    #[error("node `{node}`: found the operator {operator}, expected one of {allowed}: export the model without it")]
    Operator {
        /// The node's name.
        node: String,
        /// Its operator.
        operator: String,
        /// The supported operators.
        allowed: String,
    },
    /// An unsupported form of a supported operator.
    #[error("node `{node}` ({operator}): found {found}, expected {expected}")]
    Node {
        /// The node's name.
        node: String,
        /// Its operator.
        operator: &'static str,
        /// The value found.
        found: String,
        /// The values allowed.
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

/// A shape in a message: `1 x 45`.
pub(super) fn shape_text(shape: &[usize]) -> String {
    if shape.is_empty() {
        return "a single number".to_owned();
    }
    let head: Vec<String> = shape.iter().take(16).map(usize::to_string).collect();
    format!("the shape {}{}", head.join(" x "), if shape.len() > head.len() { " x …" } else { "" })
}
