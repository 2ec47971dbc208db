//! Gateway and boat in one pool: both cores joined in memory, with time in the test's hands and faults at will.

mod emulated;
mod faults;
mod missions;
mod oracle;
mod pool;
mod recording;
mod sailing;
mod storms;
