//! What an agent heard from others and did not heed, counted by reason.

use std::fmt;
use std::ops::Add;

/// How often something from other programs was ignored, and what never came.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Ignored {
    /// Bytes that are no such message.
    pub garbage: u64,
    /// Messages of another version.
    pub version: u64,
    /// Words or proposals for a boat that is not there, not of this team, or not theirs to speak for.
    pub not_theirs: u64,
    /// Numbers that are not finite.
    pub bad_number: u64,
    /// More words of one boat than anybody has.
    pub surplus: u64,
    /// Words of a mate that talked before, waited for in vain.
    pub unheard: u64,
    /// Decisions for which a policy's proposal was waited for in vain.
    pub unadvised: u64,
}

impl Ignored {
    /// How many there were in all.
    #[must_use]
    pub fn total(&self) -> u64 {
        self.parts().iter().map(|(count, _)| count).sum()
    }

    fn parts(&self) -> [(u64, &'static str); 7] {
        [
            (self.garbage, "a message not understood"),
            (self.version, "a message of another version"),
            (self.not_theirs, "something about a boat that is not theirs"),
            (self.bad_number, "a number that is none"),
            (self.surplus, "more words than a boat has"),
            (self.unheard, "words of a mate that never came"),
            (self.unadvised, "a proposal that never came"),
        ]
    }
}

impl Add for Ignored {
    type Output = Ignored;

    fn add(self, other: Ignored) -> Ignored {
        Ignored {
            garbage: self.garbage + other.garbage,
            version: self.version + other.version,
            not_theirs: self.not_theirs + other.not_theirs,
            bad_number: self.bad_number + other.bad_number,
            surplus: self.surplus + other.surplus,
            unheard: self.unheard + other.unheard,
            unadvised: self.unadvised + other.unadvised,
        }
    }
}

impl fmt::Display for Ignored {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let parts = self.parts();
        let said: Vec<String> =
            parts.iter().filter(|(count, _)| *count > 0).map(|(count, what)| format!("{count} x {what}")).collect();
        f.write_str(&said.join(", "))
    }
}
