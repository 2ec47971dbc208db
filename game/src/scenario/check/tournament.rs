//! A tournament file and all the files it names, checked.

use super::game::{FileCache, referenced};
use crate::scenario::diagnostics::Diagnostics;
use crate::scenario::raw;
use crate::scenario::read::Document;
use crate::scenario::{Entrant, Tournament};
use std::collections::BTreeSet;

/// Checks a tournament.
pub(in crate::scenario) fn tournament(
    diagnostics: &mut Diagnostics,
    document: &Document<raw::Tournament>,
) -> Option<Tournament> {
    let raw = &document.raw;
    referenced(diagnostics, document, "game", &raw.game, super::game);
    if let Some(sea) = &raw.sea {
        referenced(diagnostics, document, "sea", sea, super::sea);
    }
    let mut strategies = FileCache::new(super::strategy_file);
    let mut names = BTreeSet::new();
    let mut entries = vec![];
    for (i, raw::Entry { name, strategy }) in raw.entry.iter().enumerate() {
        let place = document.at(&format!("entry.{i}.strategy"));
        let strategy = diagnostics.sources.resolve(place, &strategy.0);
        if document.is_sound(&format!("entry.{i}.strategy")) {
            strategies.index_at(diagnostics, &strategy, Some(place), "");
        }
        let name_path = format!("entry.{i}.name");
        if document.is_sound(&name_path) && !names.insert(&name.0) {
            let message = format!("name is {:?} again, expected a different one for each entry", name.0);
            diagnostics.note(document.at(&name_path), message);
        }
        entries.push(Entrant { name: name.0.clone(), strategy });
    }
    let path = |key: &str, given: &raw::FilePath| diagnostics.sources.resolve(document.at(key), &given.0);
    let tournament = Tournament {
        name: document.name.clone(),
        game: path("game", &raw.game),
        sea: raw.sea.as_ref().map(|sea| path("sea", sea)),
        entries,
        games: raw.games,
        seed: raw.seed,
        self_play: raw.self_play,
    };
    document.is_faultless(diagnostics).then_some(tournament)
}
