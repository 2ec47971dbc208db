//! A parcel: what travels with a question or an answer.

use zenoh::bytes::ZBytes;

/// The bytes of a question or an answer, with its nonce or seal; that is empty where there is none.
#[derive(Clone, Debug, Default)]
pub struct Parcel {
    /// What is asked or answered.
    pub bytes: Vec<u8>,
    /// The nonce or seal.
    pub attachment: Vec<u8>,
}

impl Parcel {
    /// Bytes with neither.
    #[must_use]
    pub fn new(bytes: Vec<u8>) -> Parcel {
        Parcel { bytes, attachment: Vec::new() }
    }

    /// What zenoh has received.
    pub(crate) fn of(bytes: Option<&ZBytes>, attachment: Option<&ZBytes>) -> Parcel {
        let [bytes, attachment] =
            [bytes, attachment].map(|part| part.map(|part| part.to_bytes().into_owned()).unwrap_or_default());
        Parcel { bytes, attachment }
    }
}
