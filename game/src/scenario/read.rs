//! From a path to what the file says: text, bases, merging, and every complaint about its form.

use super::diagnostics::Diagnostics;
use super::draw::{self, Drawable};
use super::explain::explain;
use super::raw::At;
use super::source::tidied;
use serde::de::DeserializeOwned;
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use toml::Spanned;
use toml::de::{DeTable, DeValue};

/// A file as typed, laid over its bases.
#[derive(Debug)]
pub(super) struct Document<T> {
    /// Its stem.
    pub(super) name: String,
    /// Where it begins in the virtual text.
    pub(super) start: usize,
    /// What it says.
    pub(super) raw: T,
}

/// The files are for people to write; one larger than this is something else.
const LARGEST_BYTES: u64 = 4 << 20;
/// Bases of bases of bases.
const LONGEST_CHAIN: usize = 16;
/// More complaints than this about the form of one file help nobody.
const MOST_COMPLAINTS: usize = 100;
/// Of a dotted key.
const MOST_PARTS: usize = 100;

type Table<'i> = Spanned<DeTable<'i>>;

/// A file and its bases, the file first: where each begins, and its text.
pub(super) type Chain = Vec<(usize, Arc<str>)>;

/// A kind of file as typed.
pub(super) trait Typed: DeserializeOwned + Default {
    /// Where distributions may stand in place of numbers.
    const DRAWABLE: Drawable;
    /// Whose the numbers are, where nobody says.
    const OWNER: &'static str;
    /// A key whose value serde cannot read alone; [`Typed::put_apart`] gets it.
    const APART: Option<&'static str> = None;

    /// Keys that count only in the file itself, not in its bases.
    const OWN: &'static [&'static str] = &[];

    /// Reads the value of [`Typed::APART`].
    fn put_apart(&mut self, _: &mut Diagnostics, _: Spanned<DeValue<'_>>) {}
}

/// Reads the file at `path` with its bases. Problems with finding it stand at `asked_at`, the reference.
pub(super) fn document<T: Typed>(
    diagnostics: &mut Diagnostics,
    path: &Path,
    asked_at: Option<usize>,
) -> Option<Document<T>> {
    document_of(diagnostics, path, asked_at, T::OWNER)
}

/// The same, for an owner who draws numbers of its own.
pub(super) fn document_of<T: Typed>(
    diagnostics: &mut Diagnostics,
    path: &Path,
    asked_at: Option<usize>,
    owner: &str,
) -> Option<Document<T>> {
    let chain = chain(diagnostics, path, asked_at)?;
    let start = chain[0].0;
    let name = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
    diagnostics.is_name(start, "the file's name", &name);
    let typed = merged(&chain);
    let numbers = draw::numbers(diagnostics, typed.get_ref(), T::DRAWABLE, owner);
    let mut table: Table<'_> = typed;
    let own = start..start + chain[0].1.len();
    for key in T::OWN {
        let of_base = table.get_ref().get(*key).is_some_and(|value| !own.contains(&value.span().start));
        if of_base {
            table.get_mut().remove(*key);
        }
    }
    draw::put(table.get_mut(), T::DRAWABLE, &numbers);
    let apart = T::APART.and_then(|key| table.get_mut().remove(key));
    let mut raw: T = deserialised(diagnostics, start, table);
    if let Some(value) = apart {
        raw.put_apart(diagnostics, value);
    }
    Some(Document { name, start, raw })
}

/// Reads a file and its bases, and notes what is wrong with their syntax.
pub(super) fn chain(diagnostics: &mut Diagnostics, path: &Path, asked_at: Option<usize>) -> Option<Chain> {
    let mut chain: Chain = vec![];
    let mut paths: Vec<PathBuf> = vec![];
    let (mut path, mut asked_at) = (tidied(path), asked_at);
    loop {
        if let Some(at) = asked_at
            && (paths.contains(&path) || paths.len() == LONGEST_CHAIN)
        {
            let through = paths.iter().map(|p| p.display().to_string()).collect::<Vec<_>>().join(" on ");
            let why = if paths.contains(&path) { "goes round in a circle" } else { "is too deep" };
            diagnostics.note(at, format!("base {why} ({through} on {}), expected an end", path.display()));
            return None;
        }
        let (start, text) = text_of(diagnostics, &path, asked_at)?;
        let base = syntax_of(diagnostics, start, &text);
        chain.push((start, text));
        paths.push(path);
        match base {
            Some(base) => {
                path = diagnostics.sources.resolve(base.at, &base.value);
                asked_at = Some(base.at);
            }
            None => return Some(chain),
        }
    }
}

/// Reads one file into the virtual text.
fn text_of(diagnostics: &mut Diagnostics, path: &Path, asked_at: Option<usize>) -> Option<(usize, Arc<str>)> {
    let bytes = match bytes_of(diagnostics, path) {
        Ok(bytes) => bytes,
        Err(why) => {
            match asked_at {
                Some(at) => diagnostics.note(at, format!("{} {why}", path.display())),
                None => diagnostics.note_file(path.to_owned(), why),
            }
            return None;
        }
    };
    match String::from_utf8(bytes) {
        Ok(text) => {
            let text: Arc<str> = text.into();
            Some((diagnostics.sources.add(path.to_owned(), text.clone()), text))
        }
        Err(error) => {
            let good = error.utf8_error().valid_up_to();
            let text = String::from_utf8_lossy(&error.as_bytes()[..good]).into_owned();
            let start = diagnostics.sources.add(path.to_owned(), text.into());
            diagnostics.note_syntax(start + good, "found a byte that is not UTF-8, expected text");
            None
        }
    }
}

fn bytes_of(diagnostics: &Diagnostics, path: &Path) -> Result<Vec<u8>, String> {
    if let Some(files) = &diagnostics.files {
        let kept = files.iter().find(|(kept, _)| kept == path);
        return kept.map(|(_, text)| text.clone().into_bytes()).ok_or_else(|| "is not among the files kept".into());
    }
    let unreadable = |error: std::io::Error| format!("cannot be read ({error}), expected a file");
    let about = std::fs::metadata(path).map_err(unreadable)?;
    if !about.is_file() {
        return Err("is not a file, expected one".into());
    }
    if about.len() > LARGEST_BYTES {
        return Err(format!("is {} bytes long, expected at most {LARGEST_BYTES}", about.len()));
    }
    std::fs::read(path).map_err(unreadable)
}

/// Notes what is wrong with the syntax, and returns the base the file names.
fn syntax_of(diagnostics: &mut Diagnostics, start: usize, text: &str) -> Option<At<String>> {
    if let Some(at) = too_deep(text) {
        diagnostics.note_syntax(
            start + at,
            format!("found a key of more than {MOST_PARTS} parts, expected at most 3").as_str(),
        );
        return None;
    }
    let (table, errors) = DeTable::parse_recoverable(text);
    for error in errors {
        let at = error.span().map_or(0, |span| span.start);
        diagnostics.note_syntax(start + at, error.message());
    }
    let base = table.get_ref().get("base")?;
    let at = start + base.span().start;
    Some(At { value: base.get_ref().as_str()?.to_owned(), at })
}

/// Where a dotted key has more parts than can be meant: the parser recurses once a part.
fn too_deep(text: &str) -> Option<usize> {
    let (mut dots, mut before, mut in_comment) = (0, '\n', false);
    for (at, c) in text.char_indices() {
        in_comment = c != '\n' && (in_comment || c == '#' && before.is_whitespace());
        match c {
            '.' if !in_comment => dots += 1,
            '=' | '\n' | ',' | '[' | '{' => dots = 0,
            _ => {}
        }
        if dots > MOST_PARTS {
            return Some(at);
        }
        before = c;
    }
    None
}

/// The file laid over its bases, with spans in the virtual text.
pub(super) fn merged(chain: &Chain) -> Table<'_> {
    let mut tables = chain.iter().map(|(start, text)| {
        let usable = if too_deep(text).is_some() { "" } else { text };
        let (table, _) = DeTable::parse_recoverable(usable);
        let span = moved(table.span(), *start);
        Spanned::new(span, moved_table(table.into_inner(), *start))
    });
    let mut over = tables.next().unwrap_or_else(|| Spanned::new(0..0, DeTable::new()));
    for base in tables {
        lay_over(over.get_mut(), base.into_inner());
    }
    over
}

fn moved(span: Range<usize>, by: usize) -> Range<usize> {
    span.start + by..span.end + by
}

fn moved_table(table: DeTable<'_>, by: usize) -> DeTable<'_> {
    table
        .into_iter()
        .map(|(key, value)| {
            let span = moved(key.span(), by);
            (Spanned::new(span, key.into_inner()), moved_value(value, by))
        })
        .collect()
}

fn moved_value(value: Spanned<DeValue<'_>>, by: usize) -> Spanned<DeValue<'_>> {
    let span = moved(value.span(), by);
    let inner = match value.into_inner() {
        DeValue::Table(table) => DeValue::Table(moved_table(table, by)),
        DeValue::Array(array) => DeValue::Array(array.into_iter().map(|value| moved_value(value, by)).collect()),
        plain => plain,
    };
    Spanned::new(span, inner)
}

/// Tables merge; anything else in `over` replaces what `base` says.
fn lay_over<'i>(over: &mut DeTable<'i>, base: DeTable<'i>) {
    for (key, value) in base {
        match (over.get_mut(key.get_ref().as_ref()), value) {
            (None, value) => {
                over.insert(key, value);
            }
            (Some(mine), value) => {
                if let (DeValue::Table(mine), DeValue::Table(base)) = (mine.get_mut(), value.into_inner()) {
                    lay_over(mine, base);
                }
            }
        }
    }
}

/// Reads the table into `T`; an entry that does not fit is noted, taken out, and the rest tried again.
pub(super) fn deserialised<T: DeserializeOwned + Default>(
    diagnostics: &mut Diagnostics,
    start: usize,
    mut table: Table<'_>,
) -> T {
    for _ in 0..MOST_COMPLAINTS {
        let error = match T::deserialize(toml::de::Deserializer::from(table.clone())) {
            Ok(raw) => return raw,
            Err(error) => error,
        };
        let at = error.span().map_or(table.span().start, |span| span.start);
        let Some(key) = take_out(table.get_mut(), at) else {
            diagnostics.note(at, explain(error.message(), "the file"));
            break;
        };
        diagnostics.mark_unfit(start, &key);
        diagnostics.mark_unfit(at, &key);
        let message = explain(error.message(), &key);
        // A table head with broken syntax leaves its keys to the table before.
        if error.message().starts_with("unknown field") {
            diagnostics.note_if_intact(at, message);
        } else {
            diagnostics.note(at, message);
        }
    }
    T::default()
}

/// Takes the innermost entry that stands at `at` out of the table; returns its key.
fn take_out(table: &mut DeTable<'_>, at: usize) -> Option<String> {
    for (_, value) in table.iter_mut() {
        if let Some(key) = take_out_within(value.get_mut(), at) {
            return Some(key);
        }
    }
    let stands_at = |span: Range<usize>| span.contains(&at) || span.start == at;
    let (key, _) = table.iter().find(|(key, value)| stands_at(key.span()) || stands_at(value.span()))?;
    let key = key.get_ref().to_string();
    table.remove(key.as_str());
    Some(key)
}

fn take_out_within(value: &mut DeValue<'_>, at: usize) -> Option<String> {
    match value {
        DeValue::Table(inner) => take_out(inner, at),
        DeValue::Array(array) => array.iter_mut().find_map(|value| take_out_within(value.get_mut(), at)),
        _ => None,
    }
}
