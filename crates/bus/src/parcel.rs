//! A parcel: the content of a query or an answer.

use zenoh::bytes::ZBytes;

/// The bytes of a query or an answer, with its nonce or seal; the attachment is empty if it has
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
    #[must_use]
    pub fn new(bytes: Vec<u8>) -> Parcel {
        Parcel { bytes, attachment: Vec::new() }
    }

    /// The parcel in a message that zenoh has received.
    pub(crate) fn of(bytes: Option<&ZBytes>, attachment: Option<&ZBytes>) -> Parcel {
        let [bytes, attachment] =
            [bytes, attachment].map(|part| part.map(|part| part.to_bytes().into_owned()).unwrap_or_default());
        Parcel { bytes, attachment }
    }
}
