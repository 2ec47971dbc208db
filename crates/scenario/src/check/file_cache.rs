//! Files of one kind that a game refers to.

use crate::kind::ScenarioFile;
use crate::loader::{self, Key};
use crate::raw;
use crate::read::Document;
use crate::source::tidied;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// Files of one kind that a game refers to. Each is read once, or once per owner if it is a
/// strategy or has numbers to draw.
pub(super) struct FileCache<F> {
    pub(super) items: Vec<F>,
    path_of: BTreeMap<String, PathBuf>,
    /// The files without numbers to draw.
    index_of: BTreeMap<Key, Option<usize>>,
}

impl<F: ScenarioFile> FileCache<F> {
    pub(super) fn new() -> FileCache<F> {
        FileCache {
            items: vec![],
            path_of: BTreeMap::new(),
            index_of: BTreeMap::new(),
        }
    }

    /// The index of `owner`'s version of the file referenced by `given`, which is at `path` in the
    /// game file.
    pub(super) fn index(
        &mut self,
        game: &Document<raw::Game>,
        path: &str,
        given: &str,
        owner: &str,
    ) -> Option<usize> {
        let file = game.resolve(path, given);
        let is_new = !self.index_of.contains_key(&loader::key::<F>(&file, owner));
        let index = self.index_at(game, &file, Some(path), owner)?;
        let name = file.file_stem().unwrap_or_default();
        let name = name.to_string_lossy().into_owned();
        let named = self.path_of.entry(name.clone());
        if is_new && *named.or_insert_with(|| file.clone()) != file {
            let message =
                format!("{given} is the second file named {name:?}, expected different names");
            game.note(path, message);
        }
        Some(index)
    }

    /// Like `index`, but without the check for unique names: a strategy may have two versions.
    pub(super) fn index_at(
        &mut self,
        game: &Document<raw::Game>,
        file: &Path,
        path: Option<&str>,
        owner: &str,
    ) -> Option<usize> {
        let file = tidied(file);
        let key = loader::key::<F>(&file, owner);
        if let Some(index) = self.index_of.get(&key) {
            return *index;
        }
        let drawn = game.loader.drawn.borrow().len();
        let asked_at = path.map(|path| game.at(path));
        let item = game.loader.read(&file, asked_at, owner);
        let index = item.map(|item| {
            self.items.push(item);
            self.items.len() - 1
        });
        if game.loader.drawn.borrow().len() == drawn {
            self.index_of.insert(key, index);
        }
        index
    }
}
