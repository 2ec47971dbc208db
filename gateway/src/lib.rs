//! The door to real boats.
