//! Limits on the memory and time that a file may require, checked before parsing.
//!
//! Fields are counted first, because the parser can turn two bytes into a struct of hundreds of
//! bytes.

use super::NetworkError;

/// Maximum size of a file, bytes.
pub(super) const FILE_BYTES_MAX: usize = 64 << 20;
/// Maximum number of fields in a file, including the elements of shapes and attributes but not
/// weights.
pub(super) const FIELDS_MAX: usize = 100_000;
/// Maximum number of weights in evaluation layout.
pub(super) const PARAMETERS_MAX: usize = 10_000_000;
/// Maximum number of values computed per evaluation.
pub(super) const VALUES_MAX: usize = 1_000_000;
/// Maximum number of multiplications by weights per evaluation.
pub(super) const PRODUCTS_MAX: usize = 100_000_000;
/// Maximum number of dimensions of a tensor.
pub(super) const RANK_MAX: usize = 8;

/// Returns `found` unless it exceeds `max`.
pub(super) fn at_most(what: &str, found: Option<usize>, max: usize) -> Result<usize, NetworkError> {
    let found = found.unwrap_or(usize::MAX);
    if found > max {
        return Err(NetworkError::at(
            what,
            found.to_string(),
            format!("at most {max}"),
        ));
    }
    Ok(found)
}

/// Messages with repeated fields.
#[derive(Clone, Copy)]
enum Kind {
    Model,
    Graph,
    Node,
    Attribute,
    Tensor,
    ValueInfo,
    Type,
    TensorType,
    Shape,
}

enum Content {
    Message(Kind),
    /// Consecutive numbers of at least one byte each.
    Integers,
    /// Takes about as much memory as in the file.
    Plain,
}

/// The content of a message's field `number`, as in `proto.rs`.
fn content(kind: Kind, number: u64) -> Content {
    match (kind, number) {
        (Kind::Model, 7) => Content::Message(Kind::Graph),
        (Kind::Graph, 1) => Content::Message(Kind::Node),
        (Kind::Graph, 5) | (Kind::Attribute, 5) => Content::Message(Kind::Tensor),
        (Kind::Graph, 11 | 12) => Content::Message(Kind::ValueInfo),
        (Kind::Node, 5) => Content::Message(Kind::Attribute),
        (Kind::ValueInfo, 2) => Content::Message(Kind::Type),
        (Kind::Type, 1) => Content::Message(Kind::TensorType),
        (Kind::TensorType, 2) => Content::Message(Kind::Shape),
        (Kind::Attribute, 8) | (Kind::Tensor, 1 | 5 | 7) => Content::Integers,
        _ => Content::Plain,
    }
}

/// Rejects files that are too long, have too many fields, or have badly nested fields.
pub(super) fn check(file: &[u8]) -> Result<(), NetworkError> {
    at_most("bytes of the file", Some(file.len()), FILE_BYTES_MAX)?;
    let mut fields = Fields {
        file,
        at: 0,
        count: 0,
    };
    fields.walk(Kind::Model, file.len())
}

struct Fields<'a> {
    file: &'a [u8],
    at: usize,
    count: usize,
}

impl Fields<'_> {
    /// Walks through a message up to `end`. Messages, and so the recursion, nest only a few levels
    /// deep.
    fn walk(&mut self, kind: Kind, end: usize) -> Result<(), NetworkError> {
        while self.at < end {
            let begin = self.at;
            let key = self.varint(end)?;
            self.add(1)?;
            match key & 7 {
                0 => _ = self.varint(end)?,
                1 => self.at = self.end_of(8, end)?,
                2 => {
                    let length = self.varint(end)?;
                    let field_end = self.end_of(length, end)?;
                    match content(kind, key >> 3) {
                        Content::Message(inner) => self.walk(inner, field_end)?,
                        Content::Integers => self.add(field_end - self.at)?,
                        Content::Plain => {}
                    }
                    self.at = field_end;
                }
                5 => self.at = self.end_of(4, end)?,
                wire_type => {
                    return Err(NetworkError::NotOnnx {
                        byte: begin,
                        found: format!("unexpected wire type {wire_type}"),
                    });
                }
            }
        }
        Ok(())
    }

    fn add(&mut self, count: usize) -> Result<(), NetworkError> {
        self.count = at_most(
            "fields of the file",
            self.count.checked_add(count),
            FIELDS_MAX,
        )?;
        Ok(())
    }

    fn end_of(&self, length: u64, end: usize) -> Result<usize, NetworkError> {
        let left = end - self.at;
        match usize::try_from(length) {
            Ok(length) if length <= left => Ok(self.at + length),
            _ => Err(self.wrong(format!(
                "a field of {length} bytes with {left} bytes remaining"
            ))),
        }
    }

    /// A varint: 7 bits per byte, lowest first. The last byte has its highest bit clear.
    fn varint(&mut self, end: usize) -> Result<u64, NetworkError> {
        let mut number = 0;
        for (i, byte) in self.file[self.at..end].iter().take(10).enumerate() {
            number |= u64::from(byte & 0x7f) << (7 * i);
            if byte & 0x80 == 0 {
                self.at += i + 1;
                return Ok(number);
            }
        }
        Err(self.wrong("an unterminated number".to_owned()))
    }

    fn wrong(&self, found: String) -> NetworkError {
        NetworkError::NotOnnx {
            byte: self.at,
            found,
        }
    }
}
