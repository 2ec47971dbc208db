//! The talker of a standard sentence.

/// The talker: two characters of A to Z and 0 to 9 that say which kind of device sends a sentence.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Talker([u8; 2]);

impl Talker {
    /// A satellite receiver that uses GPS.
    pub const GP: Talker = Talker(*b"GP");
    /// A satellite receiver that uses several systems.
    pub const GN: Talker = Talker(*b"GN");
    /// A magnetic compass.
    pub const HC: Talker = Talker(*b"HC");
    /// A weather instrument.
    pub const WI: Talker = Talker(*b"WI");
    /// A log: speed through the water.
    pub const VW: Talker = Talker(*b"VW");

    /// The talker of two characters; nothing if they are not two of A to Z and 0 to 9. `P` is not the first of
    /// any: it begins the sentences of a maker.
    #[must_use]
    pub fn new(characters: [u8; 2]) -> Option<Talker> {
        let known = |byte: &u8| byte.is_ascii_uppercase() || byte.is_ascii_digit();
        (characters.iter().all(known) && characters[0] != b'P').then_some(Talker(characters))
    }

    /// The two characters.
    #[must_use]
    pub fn characters(self) -> [u8; 2] {
        self.0
    }

    /// Talker and kind of an address of five characters.
    pub(super) fn split(address: &str) -> Option<(Talker, &str)> {
        let (talker, kind) = address.split_at_checked(2)?;
        Some((Talker::new(talker.as_bytes().try_into().ok()?)?, kind))
    }
}

impl Default for Talker {
    fn default() -> Talker {
        Talker::GP
    }
}
