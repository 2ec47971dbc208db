//! The file contents of a repository.

use crate::rule::Breaches;
use crate::text::code_of;
use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

/// The files that rules check: path from the root (with `/`), and content.
pub(crate) struct Tree {
    pub(crate) root: PathBuf,
    pub(crate) files: BTreeMap<String, String>,
}

impl Tree {
    pub(crate) fn of(root: &Path) -> Tree {
        let mut tree = Tree {
            root: root.to_owned(),
            files: BTreeMap::new(),
        };
        tree.add(root, "");
        tree
    }

    fn add(&mut self, folder: &Path, path: &str) {
        // Cargo marks the output folders that it creates; `target` may be older than its first
        // build.
        let is_output = folder.join("CACHEDIR.TAG").exists() || path == "target";
        if is_output || folder.ends_with("node_modules") {
            return;
        }
        let entries = fs::read_dir(folder).unwrap_or_else(|e| panic!("{}: {e}", folder.display()));
        for entry in entries.map(|entry| entry.expect("a folder can be read to its end")) {
            let name = entry.file_name().to_string_lossy().into_owned();
            let at = entry.path();
            let path = if path.is_empty() {
                name.clone()
            } else {
                format!("{path}/{name}")
            };
            let is_text = [".rs", ".toml", ".md"]
                .iter()
                .any(|end| name.ends_with(end));
            if at.is_dir() && !at.is_symlink() && !name.starts_with('.') && path != "runs" {
                self.add(&at, &path);
            } else if at.is_file() && is_text {
                let text = fs::read_to_string(&at).unwrap_or_else(|e| panic!("{path}: {e}"));
                self.files.insert(path, text);
            }
        }
    }

    pub(crate) fn sources(&self) -> impl Iterator<Item = (&String, &String)> {
        self.files.iter().filter(|(path, _)| path.ends_with(".rs"))
    }

    pub(crate) fn manifests(&self) -> impl Iterator<Item = (&String, &String)> {
        self.files
            .iter()
            .filter(|(path, _)| *path == "Cargo.toml" || path.ends_with("/Cargo.toml"))
    }

    /// Whether a path exists as a file, a folder, or a module named without its extension.
    pub(crate) fn has(&self, path: &str) -> bool {
        let path = path.trim_end_matches('/');
        let known = |path: &str| {
            self.files.contains_key(path)
                || (!self.root.as_os_str().is_empty() && self.root.join(path).exists())
        };
        known(path) || known(&format!("{path}.rs"))
    }

    /// The content of a file, including files that no other rule checks.
    pub(crate) fn text(&self, path: &str) -> Option<String> {
        let read = || {
            (!self.root.as_os_str().is_empty())
                .then(|| fs::read_to_string(self.root.join(path)).ok())?
        };
        self.files.get(path).cloned().or_else(read)
    }

    /// The lines of code, without tests, in which `wrong` finds something.
    pub(crate) fn find(
        &self,
        look: impl Fn(&str) -> bool,
        wrong: impl Fn(&str) -> bool,
        said: &str,
    ) -> Breaches {
        let mut breaches = Breaches::new();
        for (path, text) in self.sources().filter(|(path, _)| look(path)) {
            let breach =
                |(number, line): (usize, &str)| format!("{path}:{number}: {said}: {}", line.trim());
            breaches.extend(code_of(text).filter(|(_, line)| wrong(line)).map(breach));
        }
        breaches
    }
}
