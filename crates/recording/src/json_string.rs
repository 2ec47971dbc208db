//! JSON in a recording: wrapped in a ROS 2 string, because ROS 2 tools only read files whose
//! messages are all in CDR.

use primitives::codec::ENCAPSULATION;

/// The schema of the wrapper.
// Foxglove could plot plain JSON, but rosbag tools refuse a file with mixed encodings or with
// topics without a schema.
pub(crate) const SCHEMA: &str = "std_msgs/msg/String";
/// The definition of the wrapper.
pub(crate) const DEFINITION: &str = "string data\n";

/// Size of the prefix: encapsulation header and length of the string, including its NUL.
const BEFORE: usize = ENCAPSULATION.len() + 4;

/// Wraps JSON in a string message.
pub(crate) fn wrap(text: &[u8]) -> Vec<u8> {
    let length = u32::try_from(text.len() + 1).unwrap_or(u32::MAX);
    [&ENCAPSULATION[..], &length.to_le_bytes(), text, &[0]].concat()
}

/// Unwraps the JSON of a message. A damaged message is returned whole and does not parse as JSON.
pub(crate) fn text_of(mut message: Vec<u8>) -> Vec<u8> {
    let text = BEFORE..message.len().saturating_sub(1);
    if message
        .get(text.clone())
        .is_some_and(|text| wrap(text) == message)
    {
        message.truncate(text.end);
        message.drain(..text.start);
    }
    message
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_text_is_found_where_it_was_put_and_nothing_else_is_taken_for_one() {
        let message = wrap(b"{}");
        assert_eq!(
            message,
            [0, 1, 0, 0, 3, 0, 0, 0, b'{', b'}', 0],
            "as CDR lays out a string"
        );
        assert_eq!(text_of(message.clone()), b"{}");
        for (at, other) in [(0, 1), (1, 0), (4, 2), (7, 9), (10, b' ')] {
            let mut damaged = message.clone();
            damaged[at] = other;
            assert_eq!(text_of(damaged.clone()), damaged, "byte {at}");
        }
        for end in 0..message.len() {
            let cut = message[..end].to_vec();
            assert_eq!(text_of(cut.clone()), cut, "cut at {end}");
        }
    }
}
