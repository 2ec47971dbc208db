//! Why messages from other programs were refused, counted by reason: the same reasons for agents,
//! gateways and the sim.

use crate::Message;
use primitives::codec::{self, DecodeError};
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::fmt;
use std::ops::Add;

/// Why a message, or a part of it, was refused.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Refusal {
    /// Bytes that do not decode as the message.
    Garbage,
    /// A message from a different version.
    Version,
    /// A ticket that is unknown or void.
    Ticket,
    /// Orders for a past or future decision, or a report older than the last one.
    WrongTick,
    /// A vehicle that does not exist or does not belong to the sender.
    NotYours,
    /// Non-finite or out-of-range numbers, or an unknown kind of order: the boat then holds.
    BadNumber,
    /// An agent gave no order for one of its vehicles. The boat holds.
    Missing,
    /// Operator requests that do not apply to the game, such as a change of speed with real boats,
    /// or a step of a game that is not paused; and published commands that must be queries.
    OutOfPlace,
    /// Messages that arrived faster than they could be read.
    Flood,
    /// More team messages from a boat than it has variables.
    Surplus,
    /// A team message that did not arrive in time, from a boat that had sent one at the previous
    /// decision.
    TeamMessageMissing,
    /// A decision without a proposal from a policy in time.
    ProposalMissing,
}

impl Refusal {
    /// All reasons, with their user-visible descriptions.
    const ALL: [(Refusal, &str); 12] = [
        (Refusal::Garbage, "malformed"),
        (Refusal::Version, "from a different version"),
        (Refusal::Ticket, "with an unknown ticket"),
        (Refusal::WrongTick, "out of sequence"),
        (Refusal::NotYours, "about another node's boat"),
        (Refusal::BadNumber, "with a number out of range"),
        (Refusal::Missing, "without an order for a boat"),
        (Refusal::OutOfPlace, "not applicable"),
        (Refusal::Flood, "too many at once"),
        (
            Refusal::Surplus,
            "more team messages than a boat has variables",
        ),
        (Refusal::TeamMessageMissing, "missing team message"),
        (Refusal::ProposalMissing, "missing proposal"),
    ];
}

/// Counts of refused or missing messages, by reason. In JSON, an object with one number per reason.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(into = "BTreeMap<Refusal, u64>", from = "BTreeMap<Refusal, u64>")]
pub struct Refusals([u64; Refusal::ALL.len()]);

impl Refusals {
    /// Counts one message.
    pub fn count(&mut self, refusal: Refusal) {
        self.add(refusal, 1);
    }

    /// Counts several messages.
    pub fn add(&mut self, refusal: Refusal, count: u64) {
        self.0[refusal as usize] += count;
    }

    /// The count for this reason.
    pub fn of(&self, refusal: Refusal) -> u64 {
        self.0[refusal as usize]
    }

    /// The total count.
    pub fn total(&self) -> u64 {
        self.0.iter().sum()
    }

    /// Decodes the message in `bytes`; counts the reason on failure.
    pub fn decode<M: Message + DeserializeOwned>(&mut self, bytes: &[u8]) -> Option<M> {
        let decoded = codec::decode(bytes);
        if let Err(error) = &decoded {
            let is_other = matches!(error, DecodeError::Version { .. });
            self.count(if is_other {
                Refusal::Version
            } else {
                Refusal::Garbage
            });
        }
        decoded.ok()
    }
}

impl<const N: usize> From<[(Refusal, u64); N]> for Refusals {
    fn from(counts: [(Refusal, u64); N]) -> Refusals {
        Refusals::from(BTreeMap::from(counts))
    }
}

impl From<BTreeMap<Refusal, u64>> for Refusals {
    fn from(counts: BTreeMap<Refusal, u64>) -> Refusals {
        Refusals(Refusal::ALL.map(|(refusal, _)| counts.get(&refusal).copied().unwrap_or(0)))
    }
}

impl From<Refusals> for BTreeMap<Refusal, u64> {
    fn from(refusals: Refusals) -> BTreeMap<Refusal, u64> {
        Refusal::ALL
            .map(|(refusal, _)| (refusal, refusals.of(refusal)))
            .into()
    }
}

impl Add for Refusals {
    type Output = Refusals;

    fn add(mut self, other: Refusals) -> Refusals {
        self.0
            .iter_mut()
            .zip(other.0)
            .for_each(|(own, more)| *own += more);
        self
    }
}

impl fmt::Display for Refusals {
    /// The reasons with non-zero counts: `2 x malformed, 1 x out of sequence`.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let occurred = Refusal::ALL
            .iter()
            .filter(|(refusal, _)| self.of(*refusal) > 0);
        let texts: Vec<String> = occurred
            .map(|(refusal, text)| format!("{} x {text}", self.of(*refusal)))
            .collect();
        f.write_str(&texts.join(", "))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Orders, Stamp};

    #[test]
    fn what_cannot_be_decoded_is_counted_by_reason_and_told_in_words_and_json() {
        let mut refusals = Refusals::default();
        let good = Orders {
            stamp: Stamp {
                version: Orders::VERSION,
                ..Stamp::default()
            },
            ..Orders::default()
        };
        let newer = Orders {
            stamp: Stamp {
                version: 99,
                ..Stamp::default()
            },
            ..Orders::default()
        };
        assert_eq!(refusals.decode::<Orders>(&codec::encode(&good)), Some(good));
        assert_eq!((refusals.total(), refusals.to_string().as_str()), (0, ""));
        for bytes in [b"ahoy".to_vec(), vec![], codec::encode(&newer)] {
            assert_eq!(refusals.decode::<Orders>(&bytes), None, "{bytes:?}");
        }
        assert_eq!(
            refusals,
            Refusals::from([(Refusal::Garbage, 2), (Refusal::Version, 1)])
        );
        assert_eq!(
            refusals.to_string(),
            "2 x malformed, 1 x from a different version"
        );
        let json = serde_json::to_value(refusals).expect("JSON");
        assert_eq!(
            (&json["garbage"], &json["team_message_missing"]),
            (&2.into(), &0.into())
        );
        assert_eq!(
            serde_json::from_value::<Refusals>(json).expect("refusals"),
            refusals
        );
        let of_old_files = serde_json::from_str::<Refusals>(r#"{"garbage": 2, "version": 1}"#);
        assert_eq!(
            of_old_files.expect("refusals") + Refusals::default(),
            refusals
        );
        assert!(
            Refusal::ALL
                .iter()
                .enumerate()
                .all(|(i, (refusal, _))| *refusal as usize == i)
        );
    }
}
