//! Reads a file by path: text, bases, merging, and validation by its schema.

use super::diagnostics::{Diagnostics, NAME_EXPECTED, is_name};
use super::kept::{self, KeptDocument};
use super::kind::Kind;
use super::schema::declared;
use super::source::tidied;
use super::syntax;
use super::tree::{Node, Value};
use super::validate::validated;
use crate::policy::{self, PartialSpec, PolicyModel};
use primitives::input_file;
use serde::de::DeserializeOwned;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use toml::de::DeTable;

/// A file merged with its bases and read by its schema.
#[derive(Debug)]
pub struct Document<T> {
    /// Its stem.
    pub name: String,
    /// Its content; `validate` defines the stand-ins for faulty values.
    pub raw: T,
    /// The number of faults before this file was read.
    faults: usize,
    tree: Arc<Node>,
    wrong: Vec<String>,
}

impl<T> Document<T> {
    /// The offset of the value at `path`, for example `team.1.name`, or else of the innermost
    /// existing table.
    pub fn at(&self, path: &str) -> usize {
        self.tree.find(path).0.at
    }

    /// Whether the file or one of its bases has a value there.
    pub fn has(&self, path: &str) -> bool {
        self.tree.find(path).1
    }

    /// Whether the value there, or its absence, satisfies the schema, including its parts and
    /// parents.
    pub fn is_sound(&self, path: &str) -> bool {
        let is_below = |long: &str, short: &str| {
            long.strip_prefix(short)
                .is_some_and(|rest| rest.is_empty() || short.is_empty() || rest.starts_with('.'))
        };
        !self
            .wrong
            .iter()
            .any(|wrong| is_below(wrong, path) || is_below(path, wrong))
    }

    /// Reports a missing value at `path`, unless a value of another type is there.
    pub(super) fn note_missing(&self, diagnostics: &mut Diagnostics, path: &str, expected: &str) {
        if self.is_sound(path) {
            diagnostics.note_missing(self.at(path), path, expected);
        }
    }

    /// Whether no fault was found in it, or in anything checked since it was read.
    pub fn is_faultless(&self, diagnostics: &Diagnostics) -> bool {
        diagnostics.faults() == self.faults
    }
}

/// Maximum size of a file, bytes: files are written by people.
const LARGEST_BYTES: u64 = 4 << 20;
const LONGEST_CHAIN: usize = 16;
/// Keys that count only in a strategy file itself, not in its bases.
const OWN: &[&str] = &["unsafe_i_know", "unsafe_because"];

/// Reads the file of a kind at `path` with its bases, and draws its numbers for `owner`. If it
/// cannot be read, the problem is at `asked_at`, the reference.
pub(super) fn document<T: DeserializeOwned>(
    diagnostics: &mut Diagnostics,
    kind: Kind,
    path: &Path,
    asked_at: Option<usize>,
    owner: &str,
) -> Option<Document<T>> {
    let faults = diagnostics.faults();
    if let Some(kept) = diagnostics
        .kept
        .documents
        .get(&kept::key(kind, path, owner))
        .cloned()
    {
        return document_of_tree(diagnostics, kind, path, kept, (owner, faults));
    }
    let own = if kind == Kind::STRATEGY { OWN } else { &[] };
    let mut tree = tree(diagnostics, path, asked_at, own)?;
    put_settings(diagnostics, (kind, owner), &mut tree);
    let document = KeptDocument {
        tree: Arc::new(tree),
        value: None,
    };
    document_of_tree(diagnostics, kind, path, document, (owner, faults))
}

/// The document of a file of a kind with this text.
pub(super) fn document_of_text<T: DeserializeOwned>(
    diagnostics: &mut Diagnostics,
    kind: Kind,
    path: &Path,
    text: &str,
) -> Option<Document<T>> {
    let faults = diagnostics.faults();
    let start = diagnostics.sources.add(path.to_owned(), text.into());
    let mut tree = parsed(diagnostics, start, text);
    put_settings(diagnostics, (kind, kind.name()), &mut tree);
    let document = KeptDocument {
        tree: Arc::new(tree),
        value: None,
    };
    document_of_tree(diagnostics, kind, path, document, (kind.name(), faults))
}

/// A tree read by the schema of its kind, unless cached; `faults` is the number of faults before
/// it.
fn document_of_tree<T: DeserializeOwned>(
    diagnostics: &mut Diagnostics,
    kind: Kind,
    path: &Path,
    KeptDocument { tree, value }: KeptDocument,
    (owner, faults): (&str, usize),
) -> Option<Document<T>> {
    let start = tree.at;
    let name = path
        .file_stem()
        .unwrap_or_default()
        .to_string_lossy()
        .into_owned();
    let (value, wrong) = if let Some(value) = value {
        (value, vec![])
    } else {
        if !is_name(&name) {
            let lower = name.to_lowercase();
            let next = if is_name(&lower) {
                format!("; rename it to {lower}.toml")
            } else {
                String::new()
            };
            let why = format!("the file's name is {name:?}, expected {NAME_EXPECTED}{next}");
            diagnostics.note_file(path.to_owned(), why);
        }
        let drawn = diagnostics.drawn.len();
        let (mut value, wrong) = validated(diagnostics, &tree, declared(kind), owner);
        value["name"] = name.clone().into();
        let key = kept::key(kind, path, owner);
        if !diagnostics.kept.documents.contains_key(&key) && diagnostics.faults() == faults {
            let value = (diagnostics.drawn.len() == drawn).then(|| value.clone());
            let document = KeptDocument {
                tree: Arc::clone(&tree),
                value,
            };
            Arc::make_mut(&mut diagnostics.kept)
                .documents
                .insert(key, document);
        }
        (value, wrong)
    };
    match serde_json::from_value(value) {
        Ok(raw) => Some(Document {
            name,
            raw,
            faults,
            tree,
            wrong,
        }),
        Err(error) => {
            diagnostics.note(
                start,
                format!("the file does not fit its own schema: {error}"),
            );
            None
        }
    }
}

/// Inserts the settings for a file of this kind into its tree; for a strategy, those of its team.
fn put_settings(diagnostics: &mut Diagnostics, (kind, owner): (Kind, &str), tree: &mut Node) {
    for setting in diagnostics.overrides.settings.clone() {
        let Some((_, key)) = setting.target().filter(|(target, _)| *target == kind) else {
            continue;
        };
        if setting.team().is_some_and(|team| team != owner) {
            continue;
        }
        let text: Arc<str> = setting.as_file(key).into();
        let start = diagnostics.sources.add(setting.path.clone(), text.clone());
        let layer = parsed(diagnostics, start, &text);
        tree.put(layer);
    }
}

/// Reads a file, merges it with its bases, and reports their syntax errors; the keys `own` of bases
/// do not count.
pub(super) fn tree(
    diagnostics: &mut Diagnostics,
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
            let through = paths
                .iter()
                .map(|p| p.display().to_string())
                .collect::<Vec<_>>()
                .join(", ");
            let why = if paths.contains(&path) {
                "refers back to itself"
            } else {
                "has too many levels"
            };
            diagnostics.note(
                at,
                format!(
                    "base {why} ({through}, {}), expected a file without this base",
                    path.display()
                ),
            );
            return None;
        }
        let (start, text) = text_of(diagnostics, &path, asked_at)?;
        let mut layer = parsed(diagnostics, start, &text);
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
        path = diagnostics.resolve(at, &base);
        asked_at = Some(at);
    }
}

/// The path of a base: a name without extension is that of a file in the same folder.
fn named(base: &str) -> String {
    let is_name = !base.is_empty() && base.chars().all(|c| c.is_ascii_alphanumeric() || c == '_');
    if is_name {
        format!("{base}.toml")
    } else {
        base.to_owned()
    }
}

/// Reads one file into the virtual text.
fn text_of(
    diagnostics: &mut Diagnostics,
    path: &Path,
    asked_at: Option<usize>,
) -> Option<(usize, Arc<str>)> {
    let bytes = match diagnostics.files.read(path, LARGEST_BYTES) {
        Ok(bytes) => input_file::utf_8(bytes.to_vec()).unwrap_or_else(|_| bytes.to_vec()),
        Err(error) => {
            let why = format!("cannot be read ({error}), expected a file");
            match asked_at {
                Some(at) => diagnostics.note(at, format!("{} {why}", path.display())),
                None => diagnostics.note_file(path.to_owned(), why),
            }
            return None;
        }
    };
    let good = std::str::from_utf8(&bytes).map_or_else(|error| error.valid_up_to(), str::len);
    let text: Arc<str> = String::from_utf8_lossy(&bytes[..good]).into();
    let start = diagnostics.sources.add(path.to_owned(), text.clone());
    if good < bytes.len() {
        diagnostics.note_syntax(start + good, "found invalid UTF-8, expected text");
        return None;
    }
    Some((start, text))
}

/// Reads the file of a model.
pub(super) fn model(
    diagnostics: &Diagnostics,
    path: &Path,
    said: PartialSpec,
) -> Result<PolicyModel, String> {
    let bytes = diagnostics.files.read(path, policy::BYTES_MAX);
    let bytes =
        bytes.map_err(|error| format!("it cannot be read ({error}), expected an ONNX file"))?;
    PolicyModel::read(&path.display().to_string(), &bytes, said)
}

/// The tree of a text that begins at `start`, as far as its syntax is valid; reports syntax errors.
fn parsed(diagnostics: &mut Diagnostics, start: usize, text: &str) -> Node {
    let (table, errors) = DeTable::parse_recoverable(text);
    for error in &errors {
        diagnostics
            .sources
            .mark_broken(start + error.span().map_or(0, |span| span.start));
    }
    let mistakes = if errors.is_empty() {
        vec![]
    } else {
        syntax::mistakes(text)
    };
    for (at, message) in mistakes {
        diagnostics.note_syntax(start + at, &message);
    }
    Node::root(table.into_inner(), start)
}
