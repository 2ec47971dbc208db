//! Key types shared by several kinds of files.

pub use crate::raw::{FilePath, Name};
