//! A rewards file, checked.

use crate::rewards::Rewards;
use crate::scenario::diagnostics::Diagnostics;
use crate::scenario::read::Document;

/// Checks rewards.
pub(in crate::scenario) fn rewards(diagnostics: &mut Diagnostics, document: &Document<Rewards>) -> Option<Rewards> {
    let rewards = document.raw;
    if rewards == Rewards::default() && document.is_sound("") {
        let message = "everything is worth 0, expected a number for one thing at least".to_owned();
        diagnostics.note(document.at(""), message);
    }
    document.is_faultless(diagnostics).then_some(rewards)
}
