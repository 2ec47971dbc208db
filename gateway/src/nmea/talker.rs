//! The talker of a standard sentence.

/// The talker: two characters, A to Z and 0 to 9, that identify the sender's type of device.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Talker(pub(super) [u8; 2]);

impl Talker {
    /// A satellite receiver that uses GPS.
    pub const GP: Talker = Talker(*b"GP");
    /// A magnetic compass.
    pub const HC: Talker = Talker(*b"HC");

    /// Talker and sentence type of a five-character address. A proprietary sentence begins with `P`
    /// and has no talker.
    pub(super) fn split(address: &str) -> Option<(Talker, &str)> {
        let (talker, kind) = address.split_at_checked(2)?;
        let characters: [u8; 2] = talker.as_bytes().try_into().ok()?;
        let known = |byte: &u8| byte.is_ascii_uppercase() || byte.is_ascii_digit();
        (characters.iter().all(known) && characters[0] != b'P')
            .then_some((Talker(characters), kind))
    }
}

impl Default for Talker {
    fn default() -> Talker {
        Talker::GP
    }
}
