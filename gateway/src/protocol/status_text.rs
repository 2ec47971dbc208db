//! Reassembles STATUSTEXT messages: a message of more than 50 characters arrives in chunks.

use crate::mavlink::dialect::STATUSTEXT_DATA;
use primitives::SimTime;

/// Maximum delay (s) of the next chunk before a message is shown without it.
const CHUNK_AGE_MAX_S: f64 = 1.0;
/// Maximum bytes of a message: ArduPilot's have up to 256, and an unknown sender must not be able
/// to exhaust memory.
const TEXT_MAX: usize = 1000;
/// Maximum number of incomplete messages.
const UNFINISHED_MAX: usize = 4;
/// The placeholder for lost chunks.
const LOST: &[u8] = "…".as_bytes();

/// The messages with missing chunks.
#[derive(Clone, Debug, Default)]
pub(super) struct StatusTexts {
    unfinished: Vec<Unfinished>,
}

#[derive(Clone, Debug)]
struct Unfinished {
    id: u16,
    next_chunk: u8,
    at: SimTime,
    text: Vec<u8>,
}

impl StatusTexts {
    /// Accepts a chunk; calls `say` with each message that it completes.
    pub(super) fn take(
        &mut self,
        now: SimTime,
        status: &STATUSTEXT_DATA,
        say: &mut dyn FnMut(String),
    ) {
        let letters = status.text.iter().take_while(|letter| **letter != 0);
        let capacity = status.text.len();
        let letters: Vec<u8> = letters.copied().collect();
        // MAVLink 1 has neither `id` nor `chunk_seq`: the message is complete.
        if status.id == 0 {
            return say(in_words(&letters));
        }
        let place = self.unfinished.iter().position(|text| text.id == status.id);
        // A repeated chunk number starts a new message, since numbers are reused.
        let (mut text, again) = match place.map(|place| self.unfinished.remove(place)) {
            Some(text) if text.next_chunk <= status.chunk_seq => (text, None),
            other => (
                Unfinished {
                    id: status.id,
                    next_chunk: 0,
                    at: now,
                    text: vec![],
                },
                other,
            ),
        };
        again.into_iter().for_each(|text| say(text.cut_off()));
        if status.chunk_seq > text.next_chunk {
            text.text.extend(LOST);
        }
        text.text.extend(&letters);
        (text.at, text.next_chunk) = (now, status.chunk_seq.saturating_add(1));
        // A chunk that is not full is the last one.
        if letters.len() < capacity {
            return say(in_words(&text.text));
        }
        if text.text.len() >= TEXT_MAX {
            return say(text.cut_off());
        }
        if self.unfinished.len() == UNFINISHED_MAX {
            say(self.unfinished.remove(0).cut_off());
        }
        self.unfinished.push(text);
    }

    /// Calls `say` with each message whose next chunk is overdue.
    pub(super) fn take_overdue(&mut self, now: SimTime, say: &mut dyn FnMut(String)) {
        let is_overdue = |text: &mut Unfinished| (now - text.at).as_s() > CHUNK_AGE_MAX_S;
        self.unfinished
            .extract_if(.., is_overdue)
            .for_each(|text| say(text.cut_off()));
    }
}

impl Unfinished {
    fn cut_off(self) -> String {
        in_words(&[&self.text, LOST].concat())
    }
}

/// Decodes chunks that have been joined: a single chunk may end within a character.
fn in_words(letters: &[u8]) -> String {
    String::from_utf8_lossy(letters).trim().to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    const LONG: &str = "PreArm: Compass not calibrated and the accelerometers are inconsistent at 12° and 50°, please wait a while";

    /// The messages shown while these chunks arrive, 0.1 s apart, and 2 s after the last one.
    fn said(chunks: &[(u16, u8, &[u8])]) -> Vec<String> {
        let mut texts = StatusTexts::default();
        let mut said = vec![];
        for (i, (id, chunk_seq, text)) in chunks.iter().enumerate() {
            let mut letters = [0; 50];
            letters[..text.len()].copy_from_slice(text);
            let id = *id;
            let chunk_seq = *chunk_seq;
            let text = letters.into();
            let status = STATUSTEXT_DATA {
                id,
                chunk_seq,
                text,
                ..STATUSTEXT_DATA::default()
            };
            texts.take(SimTime::from_s(0.1 * i as f64), &status, &mut |text| {
                said.push(text)
            });
        }
        texts.take_overdue(
            SimTime::from_s(0.1 * chunks.len() as f64 + 2.0),
            &mut |text| said.push(text),
        );
        said
    }

    #[test]
    fn chunks_are_joined_and_a_lost_one_leaves_a_mark() {
        let parts: Vec<&[u8]> = LONG.as_bytes().chunks(50).collect();
        let [a, b, c] = parts[..] else {
            panic!("{} parts", parts.len())
        };
        let part = |bytes: &[u8]| String::from_utf8_lossy(bytes).trim().to_owned();
        let full = &[b'x'; 50][..];
        let whole = vec![LONG.to_owned()];
        for (chunks, want) in [
            (vec![(7, 0, a), (7, 1, b), (7, 2, c)], whole),
            (vec![(0, 0, c), (0, 0, c)], vec![part(c), part(c)]),
            (
                vec![(7, 0, a), (8, 0, c), (7, 1, b), (7, 2, c)],
                vec![part(c), LONG.to_owned()],
            ),
            (
                vec![(7, 0, a), (7, 2, c)],
                vec![part(&[a, LOST, c].concat())],
            ),
            (
                vec![(7, 1, b), (7, 2, c)],
                vec![part(&[LOST, b, c].concat())],
            ),
            (vec![(7, 0, a)], vec![part(&[a, LOST].concat())]),
            (
                vec![(7, 0, a), (7, 0, c)],
                vec![part(&[a, LOST].concat()), part(c)],
            ),
            // Exactly 50 characters, followed by the empty chunk that marks the end.
            (vec![(7, 0, full), (7, 1, b"")], vec![part(full)]),
        ] {
            assert_eq!(said(&chunks), want);
        }
        let endless: Vec<_> = (0..=255).map(|i| (7, i, full)).collect();
        assert!(
            said(&endless)
                .iter()
                .all(|text| text.len() < TEXT_MAX + 100)
        );
    }
}
