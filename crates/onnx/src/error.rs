//! Errors in reading and writing networks.

use thiserror::Error;

/// Maximum length of a name in a message (characters), because names in files can be of any length.
const NAME_MAX: usize = 80;

/// Why a network cannot be read or written.
#[derive(Clone, Debug, Error, PartialEq, Eq)]
pub enum NetworkError {
    /// The bytes are not an ONNX file, or the file is truncated or damaged.
    #[error("not an ONNX file, or corrupted ({found} at byte {byte})")]
    NotOnnx {
        /// Offset of the fault.
        byte: usize,
        /// The fault.
        found: String,
    },
    /// The bytes are a Git LFS pointer.
    #[error("a Git LFS pointer, expected the ONNX file that it points to: run `git lfs pull`")]
    LfsPointer,
    /// A part of the file cannot be used.
    #[error("{place}: found {found}, expected {expected}")]
    Refused {
        /// The part: the model, a tensor, a node, or a limited quantity.
        place: String,
        /// The value found.
        found: String,
        /// The values allowed.
        expected: String,
    },
}

impl NetworkError {
    pub(super) fn at(
        place: impl Into<String>,
        found: impl Into<String>,
        expected: impl Into<String>,
    ) -> NetworkError {
        NetworkError::Refused {
            place: place.into(),
            found: found.into(),
            expected: expected.into(),
        }
    }

    pub(super) fn model(found: impl Into<String>, expected: impl Into<String>) -> NetworkError {
        NetworkError::at("the model", found, expected)
    }

    pub(super) fn tensor(
        tensor: &str,
        found: impl Into<String>,
        expected: impl Into<String>,
    ) -> NetworkError {
        NetworkError::at(format!("tensor `{}`", shown(tensor)), found, expected)
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
    format!(
        "the shape {}{}",
        head.join(" x "),
        if shape.len() > head.len() {
            " x …"
        } else {
            ""
        }
    )
}
