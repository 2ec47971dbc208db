//! The web page on which people watch, steer and operate games, live or recorded.
//!
//! [`page::Page`] is the server. `PROTOCOL.md` describes how it talks to browsers.

pub mod page;
