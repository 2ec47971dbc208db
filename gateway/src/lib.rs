//! The door to real boats.

pub mod link;
