//! Recordings of games.
