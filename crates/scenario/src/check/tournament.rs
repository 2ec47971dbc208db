//! A tournament file and all the files it names, checked.

use super::file_cache::FileCache;
use super::game::referenced;
use crate::diagnostics::Diagnostics;
use crate::read::Document;
use crate::{Kind, Tournament};
use std::collections::BTreeSet;

/// Checks a tournament.
pub(crate) fn tournament(diagnostics: &mut Diagnostics, document: &Document<Tournament>) -> Option<Tournament> {
    let mut tournament = document.raw.clone();
    referenced(diagnostics, document, Kind::Game, &tournament.game, super::game);
    tournament.game = diagnostics.sources.resolve(document.at("game"), &tournament.game);
    if let Some(sea) = &mut tournament.sea {
        referenced(diagnostics, document, Kind::Sea, &*sea, super::sea);
        *sea = diagnostics.sources.resolve(document.at("sea"), &*sea);
    }
    let mut strategies = FileCache::new(super::strategy_file);
    let mut names = BTreeSet::new();
    for (i, entry) in tournament.entries.iter_mut().enumerate() {
        let [name_path, path] = ["name", "strategy"].map(|key| format!("entry.{i}.{key}"));
        let place = document.at(&path);
        entry.strategy = diagnostics.sources.resolve(place, &entry.strategy);
        if document.is_sound(&path) {
            strategies.index_at(diagnostics, &entry.strategy, Some(place), "");
        }
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
