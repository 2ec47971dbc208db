//! Types of keys that several kinds of files have.

pub use crate::raw::{FilePath, Name};
