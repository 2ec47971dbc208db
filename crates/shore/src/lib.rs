//! The page on which people ashore watch games, as they are played and from recordings.

pub mod page;
