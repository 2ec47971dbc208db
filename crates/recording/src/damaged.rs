//! Messages of a recording that are damaged: counted, and left out.

use crate::RecordingError;
use serde::{Deserialize, Serialize};

/// How many messages are damaged, and what is wrong with the first.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Damaged {
    /// How many.
    pub count: u64,
    /// Which is the first, and what is wrong with it.
    pub first: Option<String>,
}

impl Damaged {
    /// What was read, if it could be; if not, one more is damaged.
    pub fn sound<T>(&mut self, read: Result<T, RecordingError>) -> Option<T> {
        let error = match read {
            Ok(message) => return Some(message),
            Err(error) => error,
        };
        self.count += 1;
        self.first.get_or_insert_with(|| error.to_string());
        None
    }

    /// These and those.
    #[must_use]
    pub fn and(self, others: &Damaged) -> Damaged {
        Damaged { count: self.count + others.count, first: self.first.or_else(|| others.first.clone()) }
    }

    /// All of it as a remark, if there are any.
    #[must_use]
    pub fn remark(&self) -> Option<String> {
        let first = self.first.as_ref()?;
        let messages = if self.count == 1 { "message is" } else { "messages are" };
        Some(format!("{} {messages} damaged and left out; {first}", self.count))
    }
}
