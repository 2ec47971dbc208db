//! A rewards file, checked.

use crate::diagnostics::Diagnostics;
use crate::read::Document;
use crate::rewards::Rewards;

/// Checks rewards.
pub(crate) fn rewards(diagnostics: &mut Diagnostics, document: &Document<Rewards>) -> Option<Rewards> {
    let rewards = document.raw;
    if rewards == Rewards::default() && document.is_sound("") {
        let message = "everything is worth 0, expected a number for one thing at least".to_owned();
        diagnostics.note(document.at(""), message);
    }
    document.is_faultless(diagnostics).then_some(rewards)
}
