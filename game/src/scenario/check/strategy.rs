//! A strategy file, checked.

use crate::field::Field;
use crate::scenario::explain::nearest;
use crate::scenario::ledger::Ledger;
use crate::scenario::raw::RawStrategy;
use crate::scenario::read::Document;
use crate::strategy::{Assignment, Strategy};

/// Checks a strategy.
pub(in crate::scenario) fn strategy(_: &mut Ledger, document: &Document<RawStrategy>) -> Option<Strategy> {
    Some(Strategy { name: document.name.clone(), about: String::new(), roles: vec![], assignment: Assignment::Fixed })
}

/// Whether `name` is one of the field's named points; notes it if not.
pub(super) fn is_point(ledger: &mut Ledger, at: usize, key: &str, name: &str) -> bool {
    let names = Field::point_names();
    let is_known = names.iter().any(|known| known == name);
    if !is_known {
        let names: Vec<&str> = names.iter().map(String::as_str).collect();
        let guess = nearest(name, &names).map(|guess| format!(" (did you mean {guess}?)")).unwrap_or_default();
        ledger.note(at, format!("{key} is {name:?}, expected a named point, one of {}{guess}", names.join(" ")));
    }
    is_known
}
