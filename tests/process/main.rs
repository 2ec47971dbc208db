//! The program as people use it: whole games across processes, and what happens when parts of them fail.

mod faults;
mod games;
mod hosts;
mod refusals;
mod support;
