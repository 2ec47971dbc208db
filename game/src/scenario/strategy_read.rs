//! Strategy files, read by serde, until they are read like all others.

use super::diagnostics::Diagnostics;
use super::explain::explain;
use super::read::{Chain, chain, too_deep};
use serde::de::DeserializeOwned;
use std::ops::Range;
use std::path::Path;
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

/// More complaints than this about the form of one file help nobody.
const MOST_COMPLAINTS: usize = 100;

type Table<'i> = Spanned<DeTable<'i>>;

/// A kind of file as typed.
pub(super) trait Typed: DeserializeOwned + Default {
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
    let chain = chain(diagnostics, path, asked_at)?;
    let start = chain[0].0;
    let name = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
    diagnostics.is_name(start, "the file's name", &name);
    let mut table: Table<'_> = merged(&chain);
    let own = start..start + chain[0].1.len();
    for key in T::OWN {
        let of_base = table.get_ref().get(*key).is_some_and(|value| !own.contains(&value.span().start));
        if of_base {
            table.get_mut().remove(*key);
        }
    }
    let apart = T::APART.and_then(|key| table.get_mut().remove(key));
    let mut raw: T = deserialised(diagnostics, start, table);
    if let Some(value) = apart {
        raw.put_apart(diagnostics, value);
    }
    Some(Document { name, start, raw })
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
