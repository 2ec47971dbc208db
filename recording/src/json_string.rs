//! JSON in a recording: the text of a ROS 2 string, since tools of ROS 2 read files in which everything is CDR, and no others.

use game::codec::ENCAPSULATION;
use std::ops::Range;

/// The message that holds it.
pub(crate) const SCHEMA: &str = "std_msgs/msg/String";
/// Its definition.
pub(crate) const DEFINITION: &str = "string data\n";

/// What stands before the text: that, and its length with the NUL after it.
const BEFORE: usize = ENCAPSULATION.len() + 4;

/// The message that holds this text.
pub(crate) fn wrap(text: &[u8]) -> Vec<u8> {
    let length = u32::try_from(text.len() + 1).unwrap_or(u32::MAX);
    [&ENCAPSULATION[..], &length.to_le_bytes(), text, &[0]].concat()
}

/// The place of the text in the message at `place` of `bytes`; of a message that is damaged, all of it, which is no JSON.
pub(crate) fn place_in(bytes: &[u8], place: Range<usize>) -> Range<usize> {
    let text = place.start + BEFORE..place.end.saturating_sub(1);
    let is_sound = bytes.get(text.clone()).is_some_and(|text| wrap(text) == bytes[place.clone()]);
    if is_sound { text } else { place }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_text_is_found_where_it_was_put_and_nothing_else_is_taken_for_one() {
        let message = wrap(b"{}");
        assert_eq!(message, [0, 1, 0, 0, 3, 0, 0, 0, b'{', b'}', 0], "as CDR lays a string");
        let bytes = [b"abc", &message[..], b"de"].concat();
        let whole = 3..3 + message.len();
        assert_eq!(&bytes[place_in(&bytes, whole.clone())], b"{}");
        for (at, other) in [(0, 1), (1, 0), (4, 2), (7, 9), (10, b' ')] {
            let mut damaged = bytes.clone();
            damaged[3 + at] = other;
            assert_eq!(place_in(&damaged, whole.clone()), whole, "byte {at}");
        }
        for end in 0..whole.end {
            let cut = whole.start.min(end)..end;
            assert_eq!(place_in(&bytes, cut.clone()), cut, "cut at {end}");
        }
    }
}
