//! Reads a file by path: its content, bases, merging, and validation by its schema.

use super::diagnostics::{NAME_EXPECTED, is_name};
use super::entry;
use super::kind::{Kind, ScenarioFile};
use super::loader::Loader;
use super::schema::declared;
use super::source::tidied;
use super::syntax;
use super::tree::{Node, Value};
use super::validate::validated;
use primitives::input_file;
use serde::de::DeserializeOwned;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use toml::de::DeTable;

/// A file merged with its bases and read by its schema. Its values are addressed by path, such as
/// `team.1.name`.
#[derive(Debug)]
pub struct Document<'a, T> {
    /// Its stem.
    pub name: String,
    /// Its content; `validate` provides the stand-ins for faulty values.
    pub raw: T,
    pub(super) loader: &'a Loader,
    /// The number of faults before this file was read.
    faults: usize,
    tree: Node,
    wrong: Vec<String>,
}

impl<T> Document<'_, T> {
    /// The offset of the value at `path`, or else of the innermost existing table.
    pub(super) fn at(&self, path: &str) -> usize {
        self.tree.find(path).0.at
    }

    /// The file, line and column (from 1) of the value at `path`.
    pub fn position(&self, path: &str) -> (PathBuf, usize, usize) {
        let sources = self.loader.diagnostics.sources.borrow();
        let place = sources.problem(self.at(path), String::new());
        (place.path, place.line, place.column)
    }

    /// Whether the file or one of its bases has a value at `path`.
    pub fn has(&self, path: &str) -> bool {
        self.tree.find(path).1
    }

    /// Whether the value at `path`, or its absence, satisfies the schema, including its parts and
    /// parents.
    pub fn is_sound(&self, path: &str) -> bool {
        let is_below = |long: &str, short: &str| {
            long.strip_prefix(short)
                .is_some_and(|rest| rest.is_empty() || short.is_empty() || rest.starts_with('.'))
        };
        let mut wrong = self.wrong.iter();
        !wrong.any(|wrong| is_below(wrong, path) || is_below(path, wrong))
    }

    /// Reports a fault in the value at `path`, or in the innermost existing table.
    pub fn note(&self, path: &str, message: impl Into<String>) {
        self.loader.diagnostics.note(self.at(path), message);
    }

    /// Reports a fault in the value at `path`, unless the file has a syntax error that may be its
    /// cause.
    pub(super) fn note_if_intact(&self, path: &str, message: impl Into<String>) {
        let at = self.at(path);
        self.loader.diagnostics.note_if_intact(at, message);
    }

    /// Reports a missing value at `path`, unless there is a value of a different type.
    pub(super) fn note_missing(&self, path: &str, expected: &str) {
        if self.is_sound(path) {
            let at = self.at(path);
            self.loader.diagnostics.note_missing(at, path, expected);
        }
    }

    /// Whether `name`, a `key` at `path`, is valid; reports it if not.
    pub(super) fn is_name(&self, path: &str, key: &str, name: &str) -> bool {
        let is_fit = is_name(name);
        if !is_fit {
            self.note(path, format!("{key} is {name:?}, expected {NAME_EXPECTED}"));
        }
        is_fit
    }

    /// The path of the file to which `reference`, at `path`, refers.
    pub fn resolve(&self, path: &str, reference: impl AsRef<Path>) -> PathBuf {
        let sources = self.loader.diagnostics.sources.borrow();
        sources.resolve(self.at(path), reference)
    }

    /// Reads and checks the file of a different kind to which `reference`, at `path`, refers.
    pub fn referenced<F: ScenarioFile>(
        &self,
        path: &str,
        reference: impl AsRef<Path>,
    ) -> Option<F> {
        self.is_sound(path).then_some(())?;
        let file = self.resolve(path, reference);
        self.loader.read(&file, Some(self.at(path)), F::NAME)
    }

    /// Like [`Document::referenced`], but also replaces `reference` with the path it refers to. A
    /// strategy may also be a trained model, `FILE.onnx`, or a competition entry, `host:FOLDER`.
    pub fn resolved<F: ScenarioFile>(&self, path: &str, reference: &mut PathBuf) -> Option<F> {
        let given = reference.to_string_lossy().into_owned();
        let host = given.strip_prefix("host:");
        *reference = self.resolve(path, host.unwrap_or(&given));
        self.is_sound(path).then_some(())?;
        if F::NAME == Kind::STRATEGY.name() {
            match entry::strategy_file(reference, host.is_some()) {
                Ok(file) => *reference = file,
                Err(why) => {
                    self.note(path, why);
                    return None;
                }
            }
        }
        self.loader.read(reference, Some(self.at(path)), F::NAME)
    }

    /// Whether no fault was found in the file, or in anything checked since it was read.
    pub fn is_faultless(&self) -> bool {
        self.loader.diagnostics.faults() == self.faults
    }
}

/// Maximum size of a file, bytes. Files are written by hand, so they are small.
const LARGEST_BYTES: u64 = 4 << 20;
const LONGEST_CHAIN: usize = 16;
/// Keys that are ignored in the bases of a strategy file.
const OWN: &[&str] = &["unsafe_i_know", "unsafe_because"];

/// Reads the file of the given kind at `path` with its bases, and draws its numbers for `owner`. If
/// it cannot be read, the problem is reported at the reference, `asked_at`.
pub(super) fn document<'a, T: DeserializeOwned>(
    loader: &'a Loader,
    kind: Kind,
    path: &Path,
    asked_at: Option<usize>,
    owner: &str,
) -> Option<Document<'a, T>> {
    let faults = loader.diagnostics.faults();
    let own = if kind == Kind::STRATEGY { OWN } else { &[] };
    // Each boat of a fleet draws its own numbers from the same file.
    let known = loader.trees.borrow().get(path).cloned();
    let tree = known.or_else(|| tree(loader, path, asked_at, own))?;
    if loader.diagnostics.faults() == faults {
        let mut trees = loader.trees.borrow_mut();
        trees.entry(path.to_owned()).or_insert_with(|| tree.clone());
    }
    document_of_tree(loader, kind, path, tree, (owner, faults))
}

/// The document of a file of the given kind with this content.
pub(super) fn document_of_text<'a, T: DeserializeOwned>(
    loader: &'a Loader,
    kind: Kind,
    path: &Path,
    text: &str,
) -> Option<Document<'a, T>> {
    let faults = loader.diagnostics.faults();
    let tree = parsed(loader, path, text);
    document_of_tree(loader, kind, path, tree, (kind.name(), faults))
}

/// The document of a tree with the settings for its kind, read by the schema; `faults` is the
/// number of faults before it.
fn document_of_tree<'a, T: DeserializeOwned>(
    loader: &'a Loader,
    kind: Kind,
    path: &Path,
    mut tree: Node,
    (owner, faults): (&str, usize),
) -> Option<Document<'a, T>> {
    put_settings(loader, (kind, owner), &mut tree);
    let stem = path.file_stem().unwrap_or_default();
    let name = stem.to_string_lossy().into_owned();
    if !is_name(&name) {
        let lower = name.to_lowercase();
        let next = if is_name(&lower) {
            format!("; rename it to {lower}.toml")
        } else {
            String::new()
        };
        let why = format!("the file's name is {name:?}, expected {NAME_EXPECTED}{next}");
        loader.diagnostics.note_file(path.to_owned(), why);
    }
    let (mut value, wrong) = validated(loader, &tree, declared(kind), owner);
    value["name"] = name.clone().into();
    match serde_json::from_value(value) {
        Ok(raw) => Some(Document {
            name,
            raw,
            loader,
            faults,
            tree,
            wrong,
        }),
        Err(error) => {
            let message = format!("the file does not match its own schema: {error}");
            loader.diagnostics.note(tree.at, message);
            None
        }
    }
}

/// Inserts the settings for a file of this kind into its tree; for a strategy, those of its team.
fn put_settings(loader: &Loader, (kind, owner): (Kind, &str), tree: &mut Node) {
    for setting in &loader.overrides.settings {
        let Some((_, key)) = setting.target().filter(|(target, _)| *target == kind) else {
            continue;
        };
        if setting.team().is_none_or(|team| team == owner) {
            tree.put(parsed(loader, &setting.path, &setting.as_file(key)));
        }
    }
}

/// Reads a file, merges it with its bases, and reports their syntax errors; ignores the keys in
/// `own` in bases.
pub(super) fn tree(
    loader: &Loader,
    path: &Path,
    mut asked_at: Option<usize>,
    own: &[&str],
) -> Option<Node> {
    let mut path = tidied(path);
    let mut paths = Vec::<PathBuf>::new();
    let mut tree: Option<Node> = None;
    loop {
        if let Some(at) = asked_at
            && (paths.contains(&path) || paths.len() == LONGEST_CHAIN)
        {
            let through: Vec<_> = paths.iter().map(|p| p.display().to_string()).collect();
            let why = if paths.contains(&path) {
                "circular base"
            } else {
                "too many levels of bases"
            };
            let message = format!("{why}: {} -> {}", through.join(" -> "), path.display());
            loader.diagnostics.note(at, message);
            return None;
        }
        let text = text_of(loader, &path, asked_at)?;
        let mut layer = parsed(loader, &path, &text);
        let base = match layer.find("base") {
            (
                Node {
                    value: Value::Text(base),
                    at,
                    ..
                },
                true,
            ) => Some((named(base), *at)),
            _ => None,
        };
        paths.push(path);
        match &mut tree {
            None => tree = Some(layer),
            Some(over) => {
                layer.remove(own);
                over.lay_over(layer);
            }
        }
        let Some((base, at)) = base else { return tree };
        path = loader.diagnostics.sources.borrow().resolve(at, &base);
        asked_at = Some(at);
    }
}

/// The path of a base: a name without an extension means a file in the same folder.
fn named(base: &str) -> String {
    let is_name = !base.is_empty() && base.chars().all(|c| c.is_ascii_alphanumeric() || c == '_');
    if is_name {
        format!("{base}.toml")
    } else {
        base.to_owned()
    }
}

/// Reads one file.
fn text_of(loader: &Loader, path: &Path, asked_at: Option<usize>) -> Option<Arc<str>> {
    let diagnostics = &loader.diagnostics;
    let bytes = match loader.files.read(path, LARGEST_BYTES) {
        Ok(bytes) => input_file::utf_8(bytes.to_vec()).unwrap_or_else(|_| bytes.to_vec()),
        Err(why) => {
            match asked_at {
                Some(at) => diagnostics.note(at, format!("cannot read {}: {why}", path.display())),
                None => {
                    diagnostics.note_file(path.to_owned(), format!("cannot read this file: {why}"));
                }
            }
            return None;
        }
    };
    match String::from_utf8(bytes) {
        Ok(text) => Some(text.into()),
        Err(error) => {
            let good = error.utf8_error().valid_up_to();
            let text = String::from_utf8_lossy(&error.as_bytes()[..good]);
            let start = diagnostics.add(path.to_owned(), text.into());
            diagnostics.note_syntax(start + good, "found invalid UTF-8, expected text");
            None
        }
    }
}

/// Adds a file to the virtual text. Returns its tree, as far as the syntax is valid; reports syntax
/// errors.
fn parsed(loader: &Loader, path: &Path, text: &str) -> Node {
    let diagnostics = &loader.diagnostics;
    let start = diagnostics.add(path.to_owned(), text.into());
    let (table, errors) = DeTable::parse_recoverable(text);
    for error in &errors {
        let at = start + error.span().map_or(0, |span| span.start);
        diagnostics.sources.borrow_mut().mark_broken(at);
    }
    if !errors.is_empty() {
        for (at, message) in syntax::mistakes(text) {
            diagnostics.note_syntax(start + at, &message);
        }
    }
    Node::root(table.into_inner(), start)
}
