//! The wire format of MOOSDB, protocol 4.1: messages, packets and their framing, without sockets.
//!
//! All numbers are little-endian. A packet consists of its length in bytes (i32, itself included),
//! the number of messages (i32), a compression flag (u8, always 0), and the messages. A pShare
//! datagram is a single message without a packet around it.

use std::collections::BTreeMap;
use thiserror::Error;

/// The greeting of a client: 32 bytes, padded with zeros.
pub const GREETING: [u8; 32] = *b"ELKS CAN'T DANCE 2/8/10\0\0\0\0\0\0\0\0\0";
/// The key in the handshake of a client that accepts packets at any time.
pub const ASYNCHRONOUS: &str = "asynchronous";
/// Maximum length of a packet, bytes.
pub const PACKET_MAX: usize = 4 << 20;
/// Maximum length of a message, bytes.
pub const MESSAGE_MAX: usize = 256 << 10;
/// Length of a packet's header, bytes.
const HEADER: usize = 9;
/// Length of a message without its strings, bytes.
const FIXED: usize = 54;

/// The kind of a message. Unknown kinds are kept unchanged.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Kind(pub u8);

impl Kind {
    /// A new value of a variable.
    pub const NOTIFY: Kind = Kind(b'N');
    /// A subscription; the number is the minimum interval in s.
    pub const REGISTER: Kind = Kind(b'R');
    /// The end of a subscription.
    pub const UNREGISTER: Kind = Kind(b'U');
    /// A subscription by patterns of source and variable.
    pub const WILDCARD: Kind = Kind(b'*');
    /// The end of a subscription by patterns.
    pub const WILDCARD_END: Kind = Kind(b'/');
    /// A clock comparison.
    pub const TIMING: Kind = Kind(b'T');
    /// A request to the database itself.
    pub const REQUEST: Kind = Kind(b'Q');
    /// No content.
    pub const NULL: Kind = Kind(b'.');
    /// The name of a connecting client.
    pub const DATA: Kind = Kind(b'i');
    /// The database accepts a client.
    pub const WELCOME: Kind = Kind(b'W');
    /// The database refuses a client.
    pub const POISON: Kind = Kind(b'K');
}

/// The type of a variable's value.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum DataType {
    /// A number.
    #[default]
    Double,
    /// A string.
    String,
    /// Bytes.
    Binary,
}

impl DataType {
    const ALL: [(DataType, u8); 3] = [
        (DataType::Double, b'D'),
        (DataType::String, b'S'),
        (DataType::Binary, b'B'),
    ];
}

/// A message.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Msg {
    /// Identifies a request and its answer.
    pub id: i32,
    /// The kind.
    pub kind: Kind,
    /// The type of the value.
    pub data: DataType,
    /// The name of the sending application.
    pub source: String,
    /// Details of the source.
    pub source_aux: String,
    /// The community of the source.
    pub community: String,
    /// The variable.
    pub key: String,
    /// MOOS time, s.
    pub time_s: f64,
    /// The value of a number; a parameter in control messages.
    pub number: f64,
    /// A second number.
    pub number2: f64,
    /// The value of string and binary data.
    pub bytes: Vec<u8>,
}

impl Msg {
    /// A message of this kind with a number.
    pub fn number(kind: Kind, key: &str, number: f64, time_s: f64) -> Msg {
        Msg {
            kind,
            key: key.to_owned(),
            number,
            time_s,
            ..Msg::default()
        }
    }

    /// A message of this kind with a string.
    pub fn text(kind: Kind, key: &str, text: &str, time_s: f64) -> Msg {
        Msg {
            data: DataType::String,
            bytes: text.as_bytes().to_vec(),
            ..Msg::number(kind, key, 0.0, time_s)
        }
    }

    /// The string, if the value is a valid string.
    pub fn as_text(&self) -> Option<&str> {
        std::str::from_utf8(&self.bytes)
            .ok()
            .filter(|_| self.data == DataType::String)
    }

    /// The number, if the value is a number or a string that contains one.
    pub fn as_number(&self) -> Option<f64> {
        match self.data {
            DataType::Double => Some(self.number),
            _ => self.as_text()?.trim().parse().ok(),
        }
    }

    /// The value as a boolean, if it is `true`, `yes`, `on`, `false`, `no`, `off` or a number.
    pub fn as_bool(&self) -> Option<bool> {
        match self
            .as_text()
            .map(|text| text.trim().to_ascii_lowercase())
            .as_deref()
        {
            Some("true" | "yes" | "on") => Some(true),
            Some("false" | "no" | "off") => Some(false),
            _ => self.as_number().map(|number| number != 0.0),
        }
    }
}

/// Why bytes do not form a packet or a message.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Error)]
pub enum Malformed {
    /// An invalid length.
    #[error("a length is {0}, which is out of range")]
    Length(i64),
    /// An unknown data type.
    #[error("a data type is byte {0}, expected D, S or B")]
    DataType(u8),
    /// A name that is not UTF-8.
    #[error("a name is not UTF-8 text")]
    Name,
    /// A compressed packet.
    #[error("a packet is compressed, which is not supported")]
    Compressed,
}

/// The unread rest of a message.
struct Reader<'a>(&'a [u8]);

impl<'a> Reader<'a> {
    fn bytes(&mut self, length: usize) -> Result<&'a [u8], Malformed> {
        let (read, rest) = self
            .0
            .split_at_checked(length)
            .ok_or(Malformed::Length(length as i64))?;
        self.0 = rest;
        Ok(read)
    }

    fn array<const N: usize>(&mut self) -> Result<[u8; N], Malformed> {
        Ok(self
            .bytes(N)?
            .try_into()
            .expect("as many bytes as were read"))
    }

    fn i32(&mut self) -> Result<i32, Malformed> {
        Ok(i32::from_le_bytes(self.array()?))
    }

    fn f64(&mut self) -> Result<f64, Malformed> {
        Ok(f64::from_le_bytes(self.array()?))
    }

    /// Reads a length, which must be from `min` to `max`.
    fn length(&mut self, min: usize, max: usize) -> Result<usize, Malformed> {
        let given = self.i32()?;
        usize::try_from(given)
            .ok()
            .filter(|length| (min..=max).contains(length))
            .ok_or(Malformed::Length(given.into()))
    }

    fn sized(&mut self) -> Result<&'a [u8], Malformed> {
        let length = self.length(0, MESSAGE_MAX)?;
        self.bytes(length)
    }

    fn name(&mut self) -> Result<String, Malformed> {
        std::str::from_utf8(self.sized()?)
            .map(str::to_owned)
            .map_err(|_| Malformed::Name)
    }

    fn message(&mut self) -> Result<Msg, Malformed> {
        let length = self.length(FIXED, MESSAGE_MAX)?;
        let mut body = Reader(self.bytes(length - 4)?);
        let id = body.i32()?;
        let [kind, data] = body.array()?;
        let known = DataType::ALL.iter().find(|(_, byte)| *byte == data);
        let (data, _) = *known.ok_or(Malformed::DataType(data))?;
        let source = body.name()?;
        let source_aux = body.name()?;
        let community = body.name()?;
        let key = body.name()?;
        let [time_s, number, number2] = [body.f64()?, body.f64()?, body.f64()?];
        let bytes = body.sized()?.to_vec();
        // The rest is ignored, because newer programs may append fields.
        Ok(Msg {
            id,
            kind: Kind(kind),
            data,
            source,
            source_aux,
            community,
            key,
            time_s,
            number,
            number2,
            bytes,
        })
    }
}

/// Decodes one message, as in a pShare datagram.
///
/// # Errors
/// [`Malformed`] names the defect.
pub fn decode(bytes: &[u8]) -> Result<Msg, Malformed> {
    Reader(bytes).message()
}

/// Appends the encoded message.
pub fn encode(msg: &Msg, out: &mut Vec<u8>) {
    let texts = [
        msg.source.as_bytes(),
        msg.source_aux.as_bytes(),
        msg.community.as_bytes(),
        msg.key.as_bytes(),
    ];
    let length = FIXED + texts.iter().map(|text| text.len()).sum::<usize>() + msg.bytes.len();
    out.reserve(length);
    let sized = |out: &mut Vec<u8>, bytes: &[u8]| {
        out.extend((bytes.len() as i32).to_le_bytes());
        out.extend(bytes);
    };
    out.extend((length as i32).to_le_bytes());
    out.extend(msg.id.to_le_bytes());
    let data = DataType::ALL
        .iter()
        .find(|(data, _)| *data == msg.data)
        .map_or(b'D', |(_, byte)| *byte);
    out.extend([msg.kind.0, data]);
    texts.iter().for_each(|text| sized(out, text));
    [msg.time_s, msg.number, msg.number2]
        .iter()
        .for_each(|number| out.extend(number.to_le_bytes()));
    sized(out, &msg.bytes);
}

/// A packet of encoded messages.
pub fn packet<'a>(messages: impl Iterator<Item = &'a [u8]> + Clone) -> Vec<u8> {
    let length = HEADER + messages.clone().map(<[u8]>::len).sum::<usize>();
    let mut out = Vec::with_capacity(length);
    out.extend((length as i32).to_le_bytes());
    out.extend((messages.clone().count() as i32).to_le_bytes());
    out.push(0);
    messages.for_each(|message| out.extend(message));
    out
}

/// A packet of these messages.
pub fn packet_of(messages: &[Msg]) -> Vec<u8> {
    let encoded = |msg: &Msg| {
        let mut out = Vec::new();
        encode(msg, &mut out);
        out
    };
    let encoded: Vec<Vec<u8>> = messages.iter().map(encoded).collect();
    packet(encoded.iter().map(Vec::as_slice))
}

/// Splits a byte stream into packets.
#[derive(Default)]
pub struct Framer {
    unread: Vec<u8>,
}

impl Framer {
    /// Adds received bytes.
    pub fn push(&mut self, bytes: &[u8]) {
        self.unread.extend(bytes);
    }

    /// The messages of the next complete packet, if there is one.
    ///
    /// # Errors
    /// [`Malformed`]; the stream is then useless, because the start of the next packet is unknown.
    pub fn next_packet(&mut self) -> Result<Option<Vec<Msg>>, Malformed> {
        if self.unread.len() < HEADER {
            return Ok(None);
        }
        let mut header = Reader(&self.unread);
        let length = header.length(HEADER, PACKET_MAX)?;
        let count = header.length(0, length / FIXED)?;
        let [compressed] = header.array()?;
        if compressed != 0 {
            return Err(Malformed::Compressed);
        }
        if self.unread.len() < length {
            return Ok(None);
        }
        let mut body = Reader(&self.unread[HEADER..length]);
        let messages: Result<Vec<Msg>, Malformed> = (0..count).map(|_| body.message()).collect();
        self.unread.drain(..length);
        messages.map(Some)
    }
}

/// Variables in which helms publish drawings for viewers.
pub(crate) const DRAWINGS: [&str; 6] = [
    "VIEW_POINT",
    "VIEW_SEGLIST",
    "VIEW_POLYGON",
    "VIEW_CIRCLE",
    "VIEW_MARKER",
    "VIEW_RANGE_PULSE",
];
/// Number of waiting values at which further drawings are dropped.
const HEARD_MAX: usize = 1024;
/// Maximum length of a drawing for the shoreside, bytes.
const DRAWING_MAX: usize = 8 << 10;

/// Stores a value as the newest of its variable. Drawings with different texts are all kept,
/// because one variable carries many of them.
pub(crate) fn keep(heard: &mut BTreeMap<String, Msg>, msg: Msg) {
    let is_drawing = DRAWINGS.contains(&msg.key.as_str());
    let key = match msg.as_text() {
        Some(text) if is_drawing => format!("{} {text}", msg.key),
        _ => msg.key.clone(),
    };
    let fits = heard.len() < HEARD_MAX && msg.bytes.len() < DRAWING_MAX;
    if fits || !is_drawing {
        heard.insert(key, msg);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A notification of `pymoos2` 0.1.0 as captured from its socket.
    const CAPTURED: &str = "5400000001000000004b000000070000004e44080000007048656c6d49765000000000000000\
        000d000000444553495245445f5350454544b81ec5f1b2d1d941000000000000f83f000000000000000000000000";

    fn bytes(hex: &str) -> Vec<u8> {
        let digits: Vec<u8> = hex.bytes().filter(u8::is_ascii_hexdigit).collect();
        let byte =
            |pair: &[u8]| u8::from_str_radix(std::str::from_utf8(pair).unwrap(), 16).unwrap();
        digits.chunks(2).map(byte).collect()
    }

    #[test]
    fn a_captured_packet_is_read_and_written_to_the_byte() {
        let captured = bytes(CAPTURED);
        let mut framer = Framer::default();
        for (i, byte) in captured.iter().enumerate() {
            framer.push(&[*byte]);
            assert_eq!(
                framer.next_packet().unwrap().is_some(),
                i + 1 == captured.len(),
                "byte {i}"
            );
        }
        framer.push(&captured);
        let read = framer.next_packet().unwrap().unwrap();
        let msg = &read[0];
        assert_eq!(
            (msg.kind, msg.key.as_str(), msg.source.as_str()),
            (Kind::NOTIFY, "DESIRED_SPEED", "pHelmIvP")
        );
        assert_eq!(
            (msg.id, msg.as_number(), msg.time_s),
            (7, Some(1.5), 1_732_692_935.08)
        );
        assert_eq!(packet_of(&read), captured);
    }

    #[test]
    fn lengths_and_types_that_lie_are_refused() {
        let sound = bytes(CAPTURED);
        for (at, value, want) in [
            (0, 8_i32, Malformed::Length(8)),
            (0, -1, Malformed::Length(-1)),
            (0, i32::MAX, Malformed::Length(i32::MAX.into())),
            (4, 99, Malformed::Length(99)),
            (4, -2, Malformed::Length(-2)),
            (9, 53, Malformed::Length(53)),
            (9, 1 << 20, Malformed::Length(1 << 20)),
            (19, 1 << 20, Malformed::Length(1 << 20)),
            (19, 64, Malformed::Length(64)),
        ] {
            let mut framer = Framer::default();
            let mut broken = sound.clone();
            broken[at..at + 4].copy_from_slice(&value.to_le_bytes());
            framer.push(&broken);
            assert_eq!(framer.next_packet(), Err(want), "{value} at {at}");
        }
        for (at, byte, want) in [
            (18, b'X', Malformed::DataType(b'X')),
            (8, 1, Malformed::Compressed),
        ] {
            let mut framer = Framer::default();
            let mut broken = sound.clone();
            broken[at] = byte;
            framer.push(&broken);
            assert_eq!(framer.next_packet(), Err(want), "{byte} at {at}");
        }
    }

    #[test]
    fn values_read_as_people_write_them() {
        for (text, want) in [
            ("true", Some(true)),
            ("FALSE", Some(false)),
            ("1", Some(true)),
            ("maybe", None),
        ] {
            assert_eq!(
                Msg::text(Kind::NOTIFY, "DEPLOY", text, 0.0).as_bool(),
                want,
                "{text}"
            );
        }
        assert_eq!(
            Msg::number(Kind::NOTIFY, "DEPLOY", 0.0, 0.0).as_bool(),
            Some(false)
        );
    }
}
