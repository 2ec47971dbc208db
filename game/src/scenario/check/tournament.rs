//! A tournament file and all the files it names, checked.

use super::game::{Shelf, referenced};
use super::missing_path;
use crate::scenario::diagnostics::Diagnostics;
use crate::scenario::raw::{At, RawEntry, RawStrategy, RawTournament};
use crate::scenario::read::{Document, Typed};
use crate::scenario::{Entrant, Strategy, Tournament};

/// The most entries: ten thousand pairings.
const MOST_ENTRIES: usize = 100;

/// Checks a tournament.
pub(in crate::scenario) fn tournament(
    diagnostics: &mut Diagnostics,
    document: &Document<RawTournament>,
) -> Option<Tournament> {
    let faults = diagnostics.faults();
    let (raw, start) = (&document.raw, document.start);
    referenced(diagnostics, start, "game", raw.game.as_ref(), super::game);
    if raw.sea.is_some() {
        referenced(diagnostics, start, "sea", raw.sea.as_ref(), super::sea);
    }
    let games = diagnostics.whole("games", raw.games.as_ref(), 2..=1_000_000, 200);
    let seed = diagnostics.whole("seed", raw.seed.as_ref(), 0..=i64::MAX, 1);
    let entries = entries(diagnostics, document);
    if diagnostics.faults() != faults {
        return None;
    }
    let path = |given: &At<String>| diagnostics.sources.resolve(given.at, &given.value);
    Some(Tournament {
        name: document.name.clone(),
        game: raw.game.as_ref().map(path)?,
        sea: raw.sea.as_ref().map(path),
        entries,
        games: u32::try_from(games).ok()?,
        seed: seed as u64,
        self_play: raw.self_play.unwrap_or(false),
    })
}

fn entries(diagnostics: &mut Diagnostics, document: &Document<RawTournament>) -> Vec<Entrant> {
    let given = document.raw.entry.as_deref().unwrap_or_default();
    if !(2..=MOST_ENTRIES).contains(&given.len()) {
        let message = format!("entry has {} entries, expected 2 to {MOST_ENTRIES} [[entry]]", given.len());
        match given.last() {
            Some(last) => diagnostics.note(last.at, message),
            None => diagnostics.note_if_intact(document.start, message),
        }
    }
    let mut strategies: Shelf<RawStrategy, Strategy> = Shelf::new(super::strategy);
    let mut entries: Vec<Entrant> = vec![];
    for entry in given {
        let Some(entrant) = entrant(diagnostics, entry, &mut strategies) else { continue };
        if entries.iter().any(|other| other.name == entrant.name) {
            let at = entry.value.name.as_ref().map_or(entry.at, |name| name.at);
            diagnostics.note(at, format!("name is {:?} again, expected a different one for each entry", entrant.name));
        }
        entries.push(entrant);
    }
    entries
}

fn entrant(
    diagnostics: &mut Diagnostics,
    entry: &At<RawEntry>,
    strategies: &mut Shelf<RawStrategy, Strategy>,
) -> Option<Entrant> {
    let RawEntry { name, strategy } = &entry.value;
    match name {
        None => diagnostics.note_missing(entry.at, "entry.name", "1 to 40 of a-z, 0-9 and _"),
        Some(name) => drop(diagnostics.is_name(name.at, "name", &name.value)),
    }
    match strategy {
        None => missing_path(diagnostics, entry.at, "entry.strategy"),
        Some(given) => {
            let path = diagnostics.sources.resolve(given.at, &given.value);
            strategies.index_at(diagnostics, &path, Some(given.at), RawStrategy::OWNER);
        }
    }
    let (name, strategy) = (name.as_ref()?, strategy.as_ref()?);
    Some(Entrant { name: name.value.clone(), strategy: diagnostics.sources.resolve(strategy.at, &strategy.value) })
}
