//! A tournament file and all the files it names, checked.

use super::StrategyFiles;
use crate::diagnostics::Diagnostics;
use crate::read::Document;
use crate::sea::Sea;
use crate::{Scenario, Tournament};
use std::collections::BTreeSet;

/// Checks a tournament.
pub(crate) fn tournament(diagnostics: &mut Diagnostics, document: &Document<Tournament>) -> Option<Tournament> {
    let mut tournament = document.raw.clone();
    diagnostics.referenced::<Scenario, _>(document, "game", &tournament.game);
    tournament.game = diagnostics.resolve(document.at("game"), &tournament.game);
    if let Some(sea) = &mut tournament.sea {
        diagnostics.referenced::<Sea, _>(document, "sea", &*sea);
        *sea = diagnostics.resolve(document.at("sea"), &*sea);
    }
    let mut strategies = StrategyFiles::default();
    let mut names = BTreeSet::new();
    for (i, entry) in tournament.entries.iter_mut().enumerate() {
        let [name_path, path] = ["name", "strategy"].map(|key| format!("entry.{i}.{key}"));
        entry.strategy = strategies.read(diagnostics, document, &path, &entry.strategy);
        if document.is_sound(&name_path) && !names.insert(&entry.name) {
            let message = format!("name is {:?} again, expected a different one for each entry", entry.name);
            diagnostics.note(document.at(&name_path), message);
        }
    }
    if let Some(challenger) = tournament.challenger.as_ref().filter(|name| !names.contains(name)) {
        let listed: Vec<&str> = names.iter().map(|name| name.as_str()).collect();
        let message = format!("challenger is {challenger:?}, expected an entry: {}", listed.join(", "));
        diagnostics.note(document.at("challenger"), message);
    }
    document.is_faultless(diagnostics).then_some(tournament)
}
