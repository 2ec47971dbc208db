//! Modes that can never be.

use crate::scenario::ledger::Ledger;
use crate::strategy::Program;

/// Notes every mode whose conditions can never choose it.
pub(super) fn check_reached(_: &mut Ledger, _: &Program, _: &[usize]) {}
