//! A row in the making; the first one makes the names of the columns as well.

use super::Sink;
use std::fmt::Display;

/// Collects cells and hands over whole rows.
pub(super) struct Row<'a> {
    sink: &'a mut Sink<'a>,
    /// The names of the columns, until they are handed over.
    names: Option<Vec<String>>,
    cells: Vec<String>,
}

impl<'a> Row<'a> {
    pub(super) fn new(sink: &'a mut Sink<'a>) -> Row<'a> {
        Row { sink, names: Some(vec![]), cells: vec![] }
    }

    /// A cell in a column of its own.
    pub(super) fn put(&mut self, name: &str, value: impl Display) {
        if let Some(names) = &mut self.names {
            names.push(name.to_owned());
        }
        self.cells.push(value.to_string());
    }

    /// A cell that belongs to something of this name.
    pub(super) fn put_of(&mut self, of: &str, name: &str, value: impl Display) {
        if let Some(names) = &mut self.names {
            names.push(format!("{of}.{name}"));
        }
        self.cells.push(value.to_string());
    }

    /// Ends the row.
    pub(super) fn end(&mut self) -> std::io::Result<()> {
        if let Some(names) = self.names.take() {
            (self.sink)(&names)?;
        }
        (self.sink)(&self.cells)?;
        self.cells.clear();
        Ok(())
    }

    /// Hands these names over if there was no row.
    pub(super) fn otherwise(&mut self, names: &[&str]) -> std::io::Result<()> {
        let named = |name: &&str| (*name).to_owned();
        if self.names.take().is_some() { (self.sink)(&names.iter().map(named).collect::<Vec<_>>()) } else { Ok(()) }
    }
}
