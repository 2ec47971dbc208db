//! A message as a readable string.

use super::dialect::MavMessage;

/// The delimiters of a string in the crate's output.
const BEGIN: &str = "CharArray { data: [";
const END: &str = " }";

/// All fields of a message. Strings appear as text; the crate prints character codes instead.
pub fn message_text(message: &MavMessage) -> String {
    let printed = format!("{message:?}");
    let mut parts = printed.split(BEGIN);
    let mut text = parts.next().unwrap_or_default().to_owned();
    for part in parts {
        let (array, rest) = part.split_once(END).unwrap_or((part, ""));
        let numbers = array.split(']').next().unwrap_or_default().split(", ");
        let letters: Vec<u8> = numbers
            .filter_map(|number| number.parse().ok())
            .take_while(|letter| *letter != 0)
            .collect();
        text.push_str(&format!("{:?}{rest}", String::from_utf8_lossy(&letters)));
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mavlink::dialect::{PARAM_VALUE_DATA, STATUSTEXT_DATA};

    #[test]
    fn texts_are_printed_as_text() {
        let status = STATUSTEXT_DATA {
            text: "PreArm: \"no\" fix".into(),
            ..STATUSTEXT_DATA::default()
        };
        let text = message_text(&MavMessage::STATUSTEXT(status));
        assert!(
            text.contains(r#"text: "PreArm: \"no\" fix", id: 0"#),
            "{text}"
        );
        let value = PARAM_VALUE_DATA {
            param_id: "CRUISE_SPEED".into(),
            ..PARAM_VALUE_DATA::default()
        };
        let text = message_text(&MavMessage::PARAM_VALUE(value));
        assert!(
            text.contains("\"CRUISE_SPEED\"") && text.ends_with("})"),
            "{text}"
        );
    }
}
