//! A parcel: the content of a query or an answer. The seal of an answer proves that the answering
//! node knows the game's token.
//!
//! Without keys, any node may declare that it answers at the topic of a boat. A query therefore
//! goes to all such nodes, with a nonce as its attachment. The attachment of an answer is the
//! HMAC-SHA256, under the game's token, of nonce, key, query and answer. Answers to other queries,
//! or from nodes without the token, do not count.

use crate::{Token, random_bytes};
use zenoh::bytes::ZBytes;

/// The first part of the sealed data; no proof of a request begins with it.
const TAG: &[u8] = b"answer";

/// The bytes of a query or an answer, with its nonce or seal; the attachment is empty if there is
/// neither.
#[derive(Clone, Debug, Default)]
pub struct Parcel {
    /// The content of the query or answer.
    pub bytes: Vec<u8>,
    /// The nonce or seal.
    pub attachment: Vec<u8>,
}

impl Parcel {
    /// A parcel without nonce or seal.
    pub fn new(bytes: Vec<u8>) -> Parcel {
        Parcel {
            bytes,
            attachment: Vec::new(),
        }
    }

    /// The parcel in a message that zenoh has received.
    pub(crate) fn of(bytes: Option<&ZBytes>, attachment: Option<&ZBytes>) -> Parcel {
        let [bytes, attachment] = [bytes, attachment].map(|part| {
            part.map(|part| part.to_bytes().into_owned())
                .unwrap_or_default()
        });
        Parcel { bytes, attachment }
    }

    /// A query whose answers must be sealed.
    pub(crate) fn question(bytes: Vec<u8>) -> Parcel {
        // 128 bits: no two queries ever share a nonce, so a recorded answer matches no later query.
        Parcel {
            bytes,
            attachment: random_bytes::<16>().to_vec(),
        }
    }

    /// The answer to this query at `key`, sealed if the node knows a token.
    pub(crate) fn answer(&self, key: &str, bytes: Vec<u8>, token: Option<&Token>) -> Parcel {
        // A query without a nonce comes from a node without the token, which could not verify a
        // seal.
        let token = token.filter(|_| !self.attachment.is_empty());
        let attachment = token
            .map(|token| token.hmac(&self.sealed(key, &bytes)))
            .unwrap_or_default();
        Parcel { bytes, attachment }
    }

    /// Whether `answer` was made for this query at `key` by a node that knows `token`.
    pub(crate) fn is_answered_by(&self, key: &str, answer: &Parcel, token: &Token) -> bool {
        !self.attachment.is_empty()
            && token.verifies(&self.sealed(key, &answer.bytes), &answer.attachment)
    }

    fn sealed<'a>(&'a self, key: &'a str, answer: &'a [u8]) -> [&'a [u8]; 5] {
        [TAG, &self.attachment, key.as_bytes(), &self.bytes, answer]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const KEY: &str = "squall/pond/operate/blue_one";

    #[test]
    fn only_an_answer_to_this_question_by_a_node_with_the_token_is_sealed() {
        let token = Token::random();
        let question = Parcel::question(b"status".to_vec());
        let answer = question.answer(KEY, b"armed".to_vec(), Some(&token));
        assert!(question.is_answered_by(KEY, &answer, &token));
        let another_answer = Parcel {
            bytes: b"disarmed".to_vec(),
            ..answer.clone()
        };
        for (what, key, question, answer) in [
            ("another answer", KEY, &question, &another_answer),
            (
                "another key",
                "squall/pond/operate/red_one",
                &question,
                &answer,
            ),
            (
                "another nonce",
                KEY,
                &Parcel::question(b"status".to_vec()),
                &answer,
            ),
            (
                "another question",
                KEY,
                &Parcel {
                    bytes: b"arm".to_vec(),
                    ..question.clone()
                },
                &answer,
            ),
            (
                "another token",
                KEY,
                &question,
                &question.answer(KEY, b"armed".to_vec(), Some(&Token::random())),
            ),
            (
                "no token",
                KEY,
                &question,
                &question.answer(KEY, b"armed".to_vec(), None),
            ),
            ("no nonce", KEY, &Parcel::new(b"status".to_vec()), &answer),
        ] {
            assert!(!question.is_answered_by(key, answer, &token), "{what}");
        }
    }
}
