//! Files of one kind that a file refers to, each read once.

use crate::diagnostics::Diagnostics;
use crate::source::tidied;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// Reads and checks the file at a path, with the place of the reference, for an owner that draws
/// its numbers.
type LoadFile<T> = fn(&mut Diagnostics, &Path, Option<usize>, &str) -> Option<T>;

/// Files of one kind that a game refers to. Each is read once; once per owner if it has numbers to
/// draw, or always.
pub(super) struct FileCache<T> {
    pub(super) items: Vec<T>,
    path_of: BTreeMap<String, PathBuf>,
    /// Files without numbers to draw, by path and owner ("" if owners share them).
    index_of: BTreeMap<(PathBuf, String), Option<usize>>,
    is_by_owner: bool,
    load: LoadFile<T>,
}

impl<T> FileCache<T> {
    pub(super) fn new(load: LoadFile<T>) -> FileCache<T> {
        FileCache {
            items: vec![],
            path_of: BTreeMap::new(),
            index_of: BTreeMap::new(),
            is_by_owner: false,
            load,
        }
    }

    /// Files with a separate version for each owner.
    pub(super) fn by_owner(load: LoadFile<T>) -> FileCache<T> {
        FileCache {
            is_by_owner: true,
            ..FileCache::new(load)
        }
    }

    fn key(&self, path: PathBuf, owner: &str) -> (PathBuf, String) {
        (
            path,
            if self.is_by_owner {
                owner.to_owned()
            } else {
                String::new()
            },
        )
    }

    /// The index of `owner`'s version of the file that `given`, at `place`, refers to.
    pub(super) fn index(
        &mut self,
        diagnostics: &mut Diagnostics,
        given: &str,
        place: usize,
        owner: &str,
    ) -> Option<usize> {
        let path = diagnostics.resolve(place, given);
        let is_new = !self.index_of.contains_key(&self.key(path.clone(), owner));
        let index = self.index_at(diagnostics, &path, Some(place), owner)?;
        let name = path
            .file_stem()
            .unwrap_or_default()
            .to_string_lossy()
            .into_owned();
        if is_new
            && *self
                .path_of
                .entry(name.clone())
                .or_insert_with(|| path.clone())
                != path
        {
            let message =
                format!("{given} is the second file named {name:?}, expected different names");
            diagnostics.note(place, message);
        }
        Some(index)
    }

    /// The index of the file at `path`, regardless of its name: two versions of one strategy may
    /// meet.
    pub(super) fn index_at(
        &mut self,
        diagnostics: &mut Diagnostics,
        path: &Path,
        place: Option<usize>,
        owner: &str,
    ) -> Option<usize> {
        let key = self.key(tidied(path), owner);
        if let Some(index) = self.index_of.get(&key) {
            return *index;
        }
        let drawn = diagnostics.drawn.len();
        let item = (self.load)(diagnostics, &key.0, place, owner);
        let index = item.map(|item| {
            self.items.push(item);
            self.items.len() - 1
        });
        if diagnostics.drawn.len() == drawn {
            self.index_of.insert(key, index);
        }
        index
    }
}
