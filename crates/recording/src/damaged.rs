//! Damaged messages of a recording: counted and skipped.

use crate::RecordingError;
use serde::{Deserialize, Serialize};

/// Count of damaged messages, with the first defect.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Damaged {
    /// The count.
    pub count: u64,
    /// The first damaged message and its defect.
    pub first: Option<String>,
}

impl Damaged {
    /// Returns the value if reading succeeded; otherwise counts a damaged message.
    pub fn sound<T>(&mut self, read: Result<T, RecordingError>) -> Option<T> {
        let error = match read {
            Ok(message) => return Some(message),
            Err(error) => error,
        };
        self.count += 1;
        self.first.get_or_insert_with(|| error.to_string());
        None
    }

    /// The sum of both counts.
    pub fn and(self, others: &Damaged) -> Damaged {
        Damaged {
            count: self.count + others.count,
            first: self.first.or_else(|| others.first.clone()),
        }
    }

    /// A note for the user if any message is damaged.
    pub fn remark(&self) -> Option<String> {
        let first = self.first.as_ref()?;
        let messages = if self.count == 1 {
            "message is"
        } else {
            "messages are"
        };
        Some(format!(
            "{} {messages} damaged and skipped; {first}",
            self.count
        ))
    }
}
