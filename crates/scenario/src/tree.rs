//! A parsed scenario file: a tree of values, each with its position.

use super::draw::distribution_kind;
use std::collections::BTreeMap;
use std::ops::Range;
use toml::Spanned;
use toml::de::{DeTable, DeValue};

/// A value and its position in the virtual text of all files.
#[derive(Clone, Debug)]
pub(super) struct Node {
    /// Its offset.
    pub(super) at: usize,
    /// The offset of its key; for an element of a list, its own offset.
    pub(super) key_at: usize,
    pub(super) value: Value,
}

/// The types of TOML.
#[derive(Clone, Debug)]
pub(super) enum Value {
    Table(Table),
    List(Vec<Node>),
    Text(String),
    Whole(i64),
    Number(f64),
    Truth(bool),
    Date(String),
}

/// Keys and values.
pub(super) type Table = BTreeMap<String, Node>;

impl Node {
    /// The root of a file that begins at `start` in the virtual text.
    pub(super) fn root(table: DeTable<'_>, start: usize) -> Node {
        Node {
            at: start,
            key_at: start,
            value: Value::Table(table_from(table, start)),
        }
    }

    /// The entries of a table; empty for other values.
    pub(super) fn entries(&self) -> impl Iterator<Item = (&String, &Node)> {
        let table = if let Value::Table(table) = &self.value {
            Some(table)
        } else {
            None
        };
        table.into_iter().flatten()
    }

    /// Its value, if it is a number.
    pub(super) fn as_number(&self) -> Option<f64> {
        match self.value {
            Value::Whole(whole) => Some(whole as f64),
            Value::Number(number) => Some(number),
            _ => None,
        }
    }

    /// The value at `path`, for example `team.1.name`, or else the innermost existing table or
    /// list; and whether it was found.
    pub(super) fn find(&self, path: &str) -> (&Node, bool) {
        let mut node = self;
        for part in path.split('.').filter(|part| !part.is_empty()) {
            let next = match &node.value {
                Value::Table(table) => table.get(part),
                Value::List(list) => part.parse().ok().and_then(|index: usize| list.get(index)),
                _ => None,
            };
            match next {
                Some(next) => node = next,
                None => return (node, false),
            }
        }
        (node, true)
    }

    /// Removes keys from a table.
    pub(super) fn remove(&mut self, keys: &[&str]) {
        if let Value::Table(table) = &mut self.value {
            table.retain(|key, _| !keys.contains(&key.as_str()));
        }
    }

    /// Overrides the entries of this node with those of `over`.
    pub(super) fn put(&mut self, over: Node) {
        let is_distribution =
            matches!(&over.value, Value::Table(table) if distribution_kind(table).is_some());
        match (&mut self.value, over.value) {
            (Value::Table(table), Value::Table(over)) if !is_distribution => {
                for (key, value) in over {
                    match table.get_mut(&key) {
                        Some(mine) => mine.put(value),
                        None => drop(table.insert(key, value)),
                    }
                }
            }
            (_, value) => {
                *self = Node {
                    value,
                    at: over.at,
                    key_at: over.key_at,
                }
            }
        }
    }

    /// Merges this node over `base`: tables merge, other values replace those of the base.
    pub(super) fn lay_over(&mut self, base: Node) {
        let (Value::Table(over), Value::Table(base)) = (&mut self.value, base.value) else {
            return;
        };
        for (key, value) in base {
            match over.get_mut(&key) {
                Some(mine) => mine.lay_over(value),
                None => drop(over.insert(key, value)),
            }
        }
    }
}

fn table_from(table: DeTable<'_>, start: usize) -> Table {
    let entry = |(key, value): (Spanned<_>, Spanned<DeValue<'_>>)| {
        let Range { start: key_at, .. } = key.span();
        let key: std::borrow::Cow<'_, str> = key.into_inner();
        (
            key.into_owned(),
            node_from(value, start, Some(start + key_at)),
        )
    };
    table.into_iter().map(entry).collect()
}

fn node_from(value: Spanned<DeValue<'_>>, start: usize, key_at: Option<usize>) -> Node {
    let at = start + value.span().start;
    let value = match value.into_inner() {
        DeValue::Table(table) => Value::Table(table_from(table, start)),
        DeValue::Array(array) => {
            let nodes = array.into_iter();
            Value::List(nodes.map(|value| node_from(value, start, None)).collect())
        }
        DeValue::String(text) => Value::Text(text.into_owned()),
        // Integers too large for 64 bits are rejected later, as numbers.
        DeValue::Integer(whole) => i64::from_str_radix(whole.as_str(), whole.radix()).map_or_else(
            |_| Value::Number(whole.as_str().parse().unwrap_or(f64::NAN)),
            Value::Whole,
        ),
        DeValue::Float(number) => Value::Number(number.as_str().parse().unwrap_or(f64::NAN)),
        DeValue::Boolean(truth) => Value::Truth(truth),
        DeValue::Datetime(date) => Value::Date(date.to_string()),
    };
    Node {
        at,
        key_at: key_at.unwrap_or(at),
        value,
    }
}
