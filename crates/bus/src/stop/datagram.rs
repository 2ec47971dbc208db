//! Stop datagrams: a request as at a control port, and its answer.
//!
//! A request is JSON, padded with spaces. Its answer repeats its session and number, which an
//! outsider cannot guess. The answer is never longer than the request, so the port cannot amplify a
//! flood.

use crate::token::{Proof, Token};
use messages::external::GatewayCommand;
use serde::{Deserialize, Serialize};
use serde_json::value::{RawValue, to_raw_value};
use std::collections::BTreeMap;

/// Maximum length of a datagram, bytes: it fits into one packet on usual networks.
pub const DATAGRAM_MAX: usize = 1400;
/// Length to which requests are padded, bytes.
const FILLED: usize = 1200;
/// The key of answers, in proofs.
const ANSWER_KEY: &str = "stop datagram";

/// A request in a datagram: a stop, or a request for the status. A line at a control port has the
/// same format.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct StopRequest {
    /// The command; never a command that needs a token.
    #[serde(rename = "body")]
    pub command: GatewayCommand,
    /// A random number that identifies the sender.
    #[serde(default)]
    pub session: u64,
    /// Sequence number of the request.
    #[serde(default)]
    pub number: u64,
    /// The game; if unset, any game.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub game: Option<String>,
}

/// The states of boats, by name: the state as a string, and its age in ms when the answer was made.
/// The string is empty for a silent boat.
pub type States = BTreeMap<String, (String, u64)>;

/// The wire format.
#[derive(Serialize, Deserialize)]
struct AnswerDatagram {
    session: u64,
    number: u64,
    boats: Box<RawValue>,
    /// Proof that the sender of the answer knows the token, if it has one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    mac: Option<String>,
}

impl StopRequest {
    /// Encodes the request as a padded datagram.
    ///
    /// # Panics
    /// Never: every request can be encoded as JSON.
    pub fn encode(&self) -> Vec<u8> {
        let mut bytes = serde_json::to_vec(self).expect("a request is JSON");
        // The answer may be no longer than the request, but must name all boats. With headers, a
        // padded request stays below the 1280 bytes that every IPv6 link carries (RFC 8200); a
        // fragmented datagram is lost if any fragment is lost.
        bytes.resize(bytes.len().max(FILLED), b' ');
        bytes
    }

    /// Decodes a datagram; `None` if it is too long, garbage, or a command that needs a token.
    pub fn decode(bytes: &[u8]) -> Option<StopRequest> {
        if bytes.len() > DATAGRAM_MAX {
            return None;
        }
        let request: StopRequest = serde_json::from_slice(bytes).ok()?;
        // A datagram has no challenge, so a recorded one could be replayed. Accept datagrams only
        // for commands that any node may repeat.
        (!request.command.needs_token()).then_some(request)
    }

    /// The answer with the states of boats; `None` if it does not fit into `room` bytes, the length
    /// of the request.
    ///
    /// # Panics
    /// Never: every answer can be encoded as JSON.
    pub fn answer(&self, room: usize, token: Option<&Token>, boats: &States) -> Option<Vec<u8>> {
        let boats = to_raw_value(boats).expect("states are JSON");
        let mac = token.map(|token| {
            token
                .prove(self.challenge(), ANSWER_KEY, boats.get().as_bytes())
                .mac
        });
        let answer = AnswerDatagram {
            session: self.session,
            number: self.number,
            boats,
            mac,
        };
        let bytes = serde_json::to_vec(&answer).expect("an answer is JSON");
        (bytes.len() <= room).then_some(bytes)
    }

    /// Decodes the answer to this request; `None` if it is garbage, answers a different request, or
    /// does not prove the known token.
    pub(super) fn read_answer(&self, bytes: &[u8], token: Option<&Token>) -> Option<States> {
        let AnswerDatagram {
            session,
            number,
            boats,
            mac,
        } = serde_json::from_slice(bytes).ok()?;
        let proof = |mac| Proof {
            challenge: self.challenge(),
            mac,
        };
        let is_proven = match (token, mac) {
            (Some(token), Some(mac)) => {
                token.is_proven(&proof(mac), ANSWER_KEY, boats.get().as_bytes())
            }
            (Some(_), None) => false,
            (None, _) => true,
        };
        let is_ours = (session, number) == (self.session, self.number);
        if is_ours && is_proven {
            serde_json::from_str(boats.get()).ok()
        } else {
            None
        }
    }

    fn challenge(&self) -> String {
        format!("{:016x}{:016x}", self.session, self.number)
    }
}

/// The number of the request that these bytes claim to answer.
pub(super) fn answered_number(bytes: &[u8]) -> Option<u64> {
    serde_json::from_slice::<AnswerDatagram>(bytes)
        .ok()
        .map(|answer| answer.number)
}

#[cfg(test)]
mod tests {
    use super::*;
    use messages::external::{FleetCommand, OperatorCommand};

    fn request(command: GatewayCommand) -> StopRequest {
        StopRequest {
            session: u64::MAX,
            number: 7,
            game: Some("match".to_owned()),
            command,
        }
    }

    fn boat(command: OperatorCommand) -> GatewayCommand {
        GatewayCommand::boat("blue_one", command)
    }

    fn states(count: usize) -> States {
        (0..count)
            .map(|i| {
                (
                    format!("boat_{i:03}"),
                    ("e-stopped (by an E-stop of the fleet)".to_owned(), 3),
                )
            })
            .collect()
    }

    #[test]
    fn stops_and_status_are_read_as_they_were_sent_and_nothing_else_is() {
        let commands = [
            OperatorCommand::EStop,
            OperatorCommand::Disarm,
            OperatorCommand::Status,
        ]
        .map(boat);
        for command in commands
            .into_iter()
            .chain([GatewayCommand::Fleet(FleetCommand::EStop)])
        {
            let request = request(command);
            let bytes = request.encode();
            assert!((FILLED..=DATAGRAM_MAX).contains(&bytes.len()));
            assert_eq!(StopRequest::decode(&bytes), Some(request));
        }
        for command in [
            boat(OperatorCommand::Arm),
            GatewayCommand::Fleet(FleetCommand::Release),
        ] {
            assert_eq!(StopRequest::decode(&request(command).encode()), None);
        }
        // A request in the format of a line at a control port.
        let line = StopRequest::decode(br#"{"body":{"fleet":"e_stop"}}"#).expect("a request");
        assert_eq!(
            (line.game, line.command),
            (None, GatewayCommand::Fleet(FleetCommand::EStop))
        );
    }

    #[test]
    fn garbage_and_what_is_too_long_is_no_request() {
        let mut long = request(boat(OperatorCommand::EStop)).encode();
        long.resize(DATAGRAM_MAX + 1, b' ');
        let deep = [b'['; DATAGRAM_MAX];
        for bad in [
            &long[..],
            b"",
            b"{}",
            b"\"e_stop\"",
            b"{\"body\":{\"fleet\":\"e_stop\"}",
            &[0xff; 300],
            &deep,
        ] {
            assert_eq!(
                StopRequest::decode(bad),
                None,
                "{}",
                String::from_utf8_lossy(bad)
            );
        }
    }

    #[test]
    fn an_answer_is_never_longer_than_its_request() {
        let request = request(GatewayCommand::Fleet(FleetCommand::EStop));
        let token = Token::random();
        let answer = |count, room| request.answer(room, Some(&token), &states(count));
        assert_eq!(
            (answer(1, 0), answer(1, 27), answer(100, FILLED)),
            (None, None, None)
        );
        for count in [0, 1, 12] {
            let whole = answer(count, FILLED).expect("there is room");
            assert_eq!(
                request.read_answer(&whole, Some(&token)),
                Some(states(count))
            );
            assert!(
                answer(count, whole.len()).is_some() && answer(count, whole.len() - 1).is_none()
            );
        }
    }

    #[test]
    fn an_answer_counts_for_its_request_alone_and_only_with_the_token_that_is_known() {
        let request = request(boat(OperatorCommand::EStop));
        let token = Token::random();
        let other = Token::random();
        let answer = |token| request.answer(FILLED, token, &states(1)).expect("room");
        assert_eq!(
            request.read_answer(&answer(Some(&token)), Some(&token)),
            Some(states(1))
        );
        assert_eq!(
            request.read_answer(&answer(Some(&token)), None),
            Some(states(1)),
            "nothing is known to prove"
        );
        for forged in [answer(None), answer(Some(&other))] {
            assert_eq!(request.read_answer(&forged, Some(&token)), None);
        }
        for (session, number) in [(1, 7), (u64::MAX, 8)] {
            let replayed = StopRequest {
                session,
                number,
                ..request.clone()
            };
            assert_eq!(
                replayed.read_answer(&answer(Some(&token)), Some(&token)),
                None
            );
        }
        let changed = String::from_utf8(answer(Some(&token)))
            .expect("JSON")
            .replace("e-stopped", "armed");
        assert_eq!(request.read_answer(changed.as_bytes(), Some(&token)), None);
    }
}
