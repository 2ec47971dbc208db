//! A gateway file, checked.

use super::boat::check_thrust_map;
use crate::gateway::Gateway;
use crate::scenario::diagnostics::Diagnostics;
use crate::scenario::read::Document;

/// Checks a gateway.
pub(in crate::scenario) fn gateway(diagnostics: &mut Diagnostics, document: &Document<Gateway>) -> Option<Gateway> {
    check_thrust_map(diagnostics, document, "loops.thrust_map", &document.raw.loops.thrust_map);
    document.is_faultless(diagnostics).then(|| document.raw.clone())
}
