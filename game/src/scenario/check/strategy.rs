//! A strategy file, checked.

use crate::field::Field;
use crate::scenario::explain::nearest;
use crate::scenario::ledger::Ledger;
use crate::scenario::raw::RawStrategy;
use crate::scenario::read::Document;
use crate::scenario::{Assignment, EasyAttacker, EasyDefender, Strategy};

/// Checks a strategy.
pub(in crate::scenario) fn strategy(ledger: &mut Ledger, document: &Document<RawStrategy>) -> Option<Strategy> {
    let faults = ledger.faults();
    let raw = &document.raw;
    let attacker = raw.easy_attacker.clone().unwrap_or_default();
    let defender = raw.easy_defender.clone().unwrap_or_default();
    match &raw.roles {
        None => ledger.note_missing(document.start, "roles", "a list of 1 to 1000 roles"),
        Some(roles) if !(1..=1000).contains(&roles.value.len()) => {
            ledger.note(roles.at, format!("roles has {} entries, expected 1 to 1000", roles.value.len()));
        }
        Some(_) => {}
    }
    if let Some(centre) = &defender.centre {
        is_point(ledger, centre.at, "centre", &centre.value);
    }
    let attacker_speed = ledger.number("easy_attacker.speed_m_s", attacker.speed_m_s.as_ref(), 0.1..=60.0);
    let defender_speed = ledger.number("easy_defender.speed_m_s", defender.speed_m_s.as_ref(), 0.1..=60.0);
    let along = ledger.number("easy_defender.along_m", defender.along_m.as_ref(), 1.0..=1e4);
    let across = ledger.number("easy_defender.across_m", defender.across_m.as_ref(), 1.0..=1e4);
    let strategy = Strategy {
        name: document.name.clone(),
        roles: raw.roles.as_ref().map(|roles| roles.value.clone()).unwrap_or_default(),
        assignment: raw.assignment.unwrap_or(Assignment::Fixed),
        easy_attacker: EasyAttacker { speed_m_s: attacker_speed.unwrap_or(5.0) },
        easy_defender: EasyDefender {
            speed_m_s: defender_speed.unwrap_or(1.4),
            centre: defender.centre.map_or("CH".into(), |centre| centre.value),
            along_m: along.unwrap_or(15.0),
            across_m: across.unwrap_or(50.0),
        },
    };
    (ledger.faults() == faults).then_some(strategy)
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
