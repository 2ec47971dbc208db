//! The token of a game, which grants the right to join, control and operate.
//!
//! It is never sent. A request that needs it is answered with a challenge, a number used once. The
//! request is then repeated with an HMAC-SHA256 (RFC 2104, FIPS 180-4) under the token. It covers
//! the challenge, the key and the request as sent, each preceded by its length as 64 bits,
//! little-endian.

use crate::{BusError, clock, random_bytes};
use hmac::{Hmac, KeyInit, Mac};
use parking_lot::Mutex;
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};
use serde_json::value::{RawValue, to_raw_value};
use sha2::Sha256;
use std::collections::VecDeque;
use std::fmt::Write as _;
use std::str::FromStr;
use std::sync::Arc;
use std::time::{Duration, Instant};
use thiserror::Error;

/// The environment variable that holds the token for the commands of a game.
pub const TOKEN_VARIABLE: &str = "SQUALL_TOKEN";
/// Lifetime of a proof after the challenge: an intercepted proof cannot be used later. A round trip
/// takes less.
const GOOD_FOR: Duration = Duration::from_millis(900);
/// Maximum attempts at a request whose proofs arrive too late, as on a busy machine.
pub const ATTEMPTS: usize = 5;
/// Maximum number of open challenges; the oldest are discarded first.
const OPEN_MAX: usize = 1024;

/// A game's secret: 256 random bits.
#[derive(Clone, PartialEq, Eq)]
pub struct Token([u8; 32]);

/// A string that is not a token.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Error)]
#[error(
    "not a token ({0} characters), expected the 64 hexadecimal digits that `squall sim` prints"
)]
pub struct NotAToken(usize);

impl Token {
    /// A new random token.
    ///
    /// # Panics
    /// If the operating system cannot provide randomness.
    pub fn random() -> Token {
        Token(random_bytes())
    }

    /// The token's 64 hexadecimal digits, which give every right to anyone who reads them.
    pub fn hex(&self) -> String {
        hex(&self.0)
    }

    fn mac(&self, parts: &[&[u8]]) -> Hmac<Sha256> {
        let mut mac = Hmac::<Sha256>::new_from_slice(&self.0).expect("a key of any length will do");
        for part in parts {
            // Include the length, so that different lists of parts cannot encode to the same bytes.
            // A password in a message could be read and reused; the MAC of a challenge cannot be
            // reused.
            mac.update(&(part.len() as u64).to_le_bytes());
            mac.update(part);
        }
        mac
    }

    /// The HMAC-SHA256 of these parts under the token.
    pub(crate) fn hmac(&self, parts: &[&[u8]]) -> Vec<u8> {
        self.mac(parts).finalize().into_bytes().to_vec()
    }

    /// Whether `mac` is the HMAC-SHA256 of these parts under the token; takes equally long for
    /// every wrong `mac`.
    pub(crate) fn verifies(&self, parts: &[&[u8]], mac: &[u8]) -> bool {
        // `verify_slice` takes constant time; `==` would reveal the position of the first
        // difference to an attacker.
        self.mac(parts).verify_slice(mac).is_ok()
    }

    pub(crate) fn prove(&self, challenge: String, key: &str, body: &[u8]) -> Proof {
        let mac = hex(&self.hmac(&[challenge.as_bytes(), key.as_bytes(), body]));
        Proof { challenge, mac }
    }

    pub(crate) fn is_proven(&self, proof: &Proof, key: &str, body: &[u8]) -> bool {
        let parts = [proof.challenge.as_bytes(), key.as_bytes(), body];
        bytes_of(&proof.mac).is_some_and(|mac| self.verifies(&parts, &mac))
    }
}

impl FromStr for Token {
    type Err = NotAToken;

    fn from_str(text: &str) -> Result<Token, NotAToken> {
        let bytes = bytes_of(text.trim()).and_then(|bytes| bytes.try_into().ok());
        bytes
            .map(Token)
            .ok_or(NotAToken(text.trim().chars().count()))
    }
}

/// Hides the value, which must not end up in a log.
impl std::fmt::Debug for Token {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str("Token(…)")
    }
}

/// A node's current token, which can change while the node runs. All copies see the change.
#[derive(Clone, Debug, Default)]
pub struct CurrentToken(Arc<Mutex<Option<Token>>>);

impl CurrentToken {
    /// The current token, if any.
    pub fn get(&self) -> Option<Token> {
        self.0.lock().clone()
    }

    /// Replaces the token.
    pub fn set(&self, token: Option<Token>) {
        *self.0.lock() = token;
    }
}

impl From<Option<Token>> for CurrentToken {
    fn from(token: Option<Token>) -> CurrentToken {
        CurrentToken(Arc::new(Mutex::new(token)))
    }
}

/// Proof that the sender knows the token.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) struct Proof {
    pub(crate) challenge: String,
    pub(crate) mac: String,
}

/// The wire format of a request: JSON, with the body exactly as its sender wrote it.
#[derive(Debug, Serialize, Deserialize)]
struct Request {
    body: Box<RawValue>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    proof: Option<Proof>,
}

/// The wire format of an answer: JSON.
#[derive(Clone, Debug, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub(crate) enum Answer<T> {
    Challenge(String),
    Answer(T),
}

/// A request without a proof.
pub(crate) fn first<T: Serialize>(body: &T) -> Vec<u8> {
    json(&Request {
        body: spelled(body),
        proof: None,
    })
}

/// Sends a request on `key` through `ask`, and proves knowledge of the token if challenged; returns
/// the answer, or `None` without one.
///
/// # Errors
/// The errors of `ask`, or [`BusError`] if a required token is missing or wrong, or if the answer
/// cannot be read.
pub fn request<B: Serialize, T: DeserializeOwned>(
    token: Option<&Token>,
    key: &str,
    body: &B,
    mut ask: impl FnMut(Vec<u8>) -> Result<Option<Vec<u8>>, BusError>,
) -> Result<Option<T>, BusError> {
    let refused = |reason| BusError::Request {
        key: key.to_owned(),
        reason,
    };
    let mut payload = first(body);
    for _ in 0..ATTEMPTS {
        let Some(answer) = ask(payload)? else {
            return Ok(None);
        };
        let answer = serde_json::from_slice(&answer);
        match answer.map_err(|e| refused(format!("cannot parse the reply: {e}")))? {
            Answer::Answer(answer) => return Ok(Some(answer)),
            Answer::Challenge(challenge) => {
                payload = proven(token.ok_or(BusError::NeedsToken)?, key, body, challenge);
            }
        }
    }
    Err(BusError::WrongToken)
}

/// The request on `key` again, with the proof requested by a challenge.
fn proven<T: Serialize>(token: &Token, key: &str, body: &T, challenge: String) -> Vec<u8> {
    let body = spelled(body);
    let proof = Some(token.prove(challenge, key, body.get().as_bytes()));
    json(&Request { body, proof })
}

/// The answer to a granted request.
pub fn answer<T: Serialize>(answer: &T) -> Vec<u8> {
    json(&Answer::Answer(answer))
}

/// The result of checking a request.
#[derive(Debug)]
pub enum Checked<T> {
    /// The request may be carried out.
    Granted(T),
    /// The answer to send: a challenge.
    Challenged(Vec<u8>),
    /// Not a request of the expected type.
    Garbage(serde_json::Error),
}

/// Admits requests whose sender knows the token.
#[derive(Debug, Default)]
pub struct Guard {
    token: CurrentToken,
    open: VecDeque<(String, Instant)>,
}

impl Guard {
    /// A guard for this token; without a token it admits every request.
    pub fn new(token: impl Into<CurrentToken>) -> Guard {
        Guard {
            token: token.into(),
            open: VecDeque::new(),
        }
    }

    /// Checks a request on `key`. `needs_proof` says whether the request needs a proof.
    pub fn check<T: DeserializeOwned>(
        &mut self,
        key: &str,
        payload: &[u8],
        needs_proof: impl Fn(&T) -> bool,
    ) -> Checked<T> {
        let read = |payload| {
            let Request { body, proof } = serde_json::from_slice(payload)?;
            Ok((serde_json::from_str::<T>(body.get())?, body, proof))
        };
        let (request, body, proof) = match read(payload) {
            Ok(read) => read,
            Err(error) => return Checked::Garbage(error),
        };
        let Some(token) = self.token.get().filter(|_| needs_proof(&request)) else {
            return Checked::Granted(request);
        };
        let now = clock::now();
        self.open
            .retain(|(_, since)| now.saturating_duration_since(*since) < GOOD_FOR);
        if let Some(proof) = proof
            && let Some(i) = self
                .open
                .iter()
                .position(|(challenge, _)| *challenge == proof.challenge)
        {
            // Remove the challenge before verifying the proof: it is valid for one attempt, right
            // or wrong.
            self.open.remove(i);
            if token.is_proven(&proof, key, body.get().as_bytes()) {
                return Checked::Granted(request);
            }
        }
        let challenge = hex(&random_bytes::<16>());
        self.open.push_back((challenge.clone(), now));
        let surplus = self.open.len().saturating_sub(OPEN_MAX);
        self.open.drain(..surplus);
        Checked::Challenged(json(&Answer::<()>::Challenge(challenge)))
    }
}

fn hex(bytes: &[u8]) -> String {
    bytes.iter().fold(String::new(), |mut text, byte| {
        write!(text, "{byte:02x}").expect("a text can be written to");
        text
    })
}

fn bytes_of(hex: &str) -> Option<Vec<u8>> {
    let digits: Option<Vec<u8>> = hex
        .chars()
        .map(|c| c.to_digit(16).map(|digit| digit as u8))
        .collect();
    let digits = digits.filter(|digits| digits.len().is_multiple_of(2))?;
    Some(
        digits
            .chunks(2)
            .map(|pair| pair[0] << 4 | pair[1])
            .collect(),
    )
}

fn spelled<T: Serialize>(body: &T) -> Box<RawValue> {
    to_raw_value(body).expect("a request is JSON")
}

fn json<T: Serialize>(value: &T) -> Vec<u8> {
    serde_json::to_vec(value).expect("a request is JSON")
}

#[cfg(test)]
mod tests {
    use super::*;

    const KEY: &str = "g/join";

    fn guard(token: &Token) -> Guard {
        Guard::new(Some(token.clone()))
    }

    fn check(guard: &mut Guard, key: &str, payload: &[u8]) -> Checked<String> {
        guard.check(key, payload, |_| true)
    }

    /// The challenge in the answer to a request without a proof.
    fn challenge(guard: &mut Guard, payload: &[u8]) -> String {
        let Checked::Challenged(answer) = check(guard, KEY, payload) else {
            panic!("it needs a proof")
        };
        let Ok(Answer::<()>::Challenge(challenge)) = serde_json::from_slice(&answer) else {
            panic!("a challenge")
        };
        challenge
    }

    /// The reply to a challenge from a node with this token.
    fn proven(guard: &mut Guard, token: &Token, body: &str) -> Vec<u8> {
        super::proven(token, KEY, &body, challenge(guard, &first(&body)))
    }

    fn is_granted(checked: Checked<String>, body: &str) -> bool {
        matches!(checked, Checked::Granted(granted) if granted == body)
    }

    #[test]
    fn who_knows_the_token_is_let_through_once_for_each_challenge() {
        let token = Token::random();
        let mut guard = guard(&token);
        let again = proven(&mut guard, &token, "blue_one");
        assert!(is_granted(check(&mut guard, KEY, &again), "blue_one"));
        assert!(
            matches!(check(&mut guard, KEY, &again), Checked::Challenged(_)),
            "a replay"
        );
    }

    #[test]
    fn others_are_not() {
        let token = Token::random();
        let mut guard = guard(&token);
        let foreign = proven(&mut guard, &Token::random(), "blue_one");
        assert!(
            matches!(check(&mut guard, KEY, &foreign), Checked::Challenged(_)),
            "another token"
        );
        let good = proven(&mut guard, &token, "blue_one");
        assert!(
            matches!(
                check(&mut guard, "g/control", &good),
                Checked::Challenged(_)
            ),
            "another key"
        );
        let good = String::from_utf8(proven(&mut guard, &token, "blue_one")).expect("JSON");
        let other = good.replace("blue_one", "blue_two");
        assert!(
            matches!(
                check(&mut guard, KEY, other.as_bytes()),
                Checked::Challenged(_)
            ),
            "another request"
        );
        let unasked = Request {
            body: spelled(&"x"),
            proof: Some(token.prove("00".repeat(16), KEY, br#""x""#)),
        };
        assert!(
            matches!(
                check(&mut guard, KEY, &json(&unasked)),
                Checked::Challenged(_)
            ),
            "a challenge of its own"
        );
        assert!(matches!(check(&mut guard, KEY, b"{}"), Checked::Garbage(_)));
        let asked = request::<_, String>(None, KEY, &"x", |_| {
            Ok(Some(br#"{"challenge":"ab"}"#.to_vec()))
        });
        assert!(matches!(asked, Err(BusError::NeedsToken)));
    }

    #[test]
    fn a_request_counts_as_it_is_spelled() {
        let token = Token::random();
        let mut guard = guard(&token);
        let challenge = challenge(&mut guard, br#"{ "body": "a\u0062" }"#);
        let Proof { challenge, mac } = token.prove(challenge, KEY, br#""a\u0062""#);
        let again = format!(
            r#"{{"proof": {{"mac": "{mac}", "challenge": "{challenge}"}}, "body":  "a\u0062" }}"#
        );
        assert!(is_granted(check(&mut guard, KEY, again.as_bytes()), "ab"));
    }

    #[test]
    fn what_needs_no_proof_gets_through_without() {
        let mut guard = guard(&Token::random());
        assert!(is_granted(
            guard.check(KEY, &first(&"stop"), |body| body != "stop"),
            "stop"
        ));
        assert!(
            is_granted(check(&mut Guard::default(), KEY, &first(&"x")), "x"),
            "there is no token"
        );
    }

    #[test]
    fn a_guard_goes_by_the_token_of_now() {
        let first = Token::random();
        let second = Token::random();
        let current = CurrentToken::default();
        let mut guard = Guard::new(current.clone());
        for token in [&first, &second] {
            current.set(Some(token.clone()));
            let again = proven(&mut guard, token, "x");
            assert!(is_granted(check(&mut guard, KEY, &again), "x"));
        }
        let outdated = proven(&mut guard, &first, "x");
        assert!(
            matches!(check(&mut guard, KEY, &outdated), Checked::Challenged(_)),
            "the token of the game before"
        );
    }

    #[test]
    fn challenges_of_many_strangers_do_not_pile_up() {
        let mut guard = guard(&Token::random());
        (0..3 * OPEN_MAX).for_each(|_| drop(check(&mut guard, KEY, &first(&"x"))));
        assert_eq!(guard.open.len(), OPEN_MAX);
    }

    #[test]
    fn a_token_is_read_as_it_is_shown_and_never_logged() {
        let token = Token::random();
        assert_eq!(format!("{}\n", token.hex()).parse(), Ok(token.clone()));
        assert_eq!(format!("{token:?}"), "Token(…)");
        for bad in ["", "12", &"g".repeat(64), &"0".repeat(63), &"0".repeat(66)] {
            assert_eq!(bad.parse::<Token>(), Err(NotAToken(bad.len())), "{bad}");
        }
        // Computed with Python's `hmac`, as in docs/agents.md.
        let token: Token = "0123456789abcdef".repeat(4).parse().expect("64 digits");
        let proof = token.prove("4f0c".repeat(8), KEY, br#"{"vehicles": ["blue_one"]}"#);
        assert_eq!(
            proof.mac,
            "c5c85c75544a5893559866cd73c08baec4f04276dd346c726a156e722f60ac4f"
        );
        // RFC 4231, test case 1, for the MAC alone.
        let mut mac = Hmac::<Sha256>::new_from_slice(&[0x0b; 20]).expect("a key");
        mac.update(b"Hi There");
        let want = "b0344c61d8db38535ca8afceaf0bf12b881dc200c9833da726e9376c2e32cff7";
        assert_eq!(hex(&mac.finalize().into_bytes()), want);
    }
}
