//! The page on which people ashore watch games, live or recorded.

pub mod page;
