//! Keys of a game: certificates that identify nodes, for TLS on both sides of every link.
//!
//! `make` creates a separate authority for each set of keys and discards the authority's key. No
//! one can extend a set; to revoke a set, create a new one. A node has a [`Bundle`]: its
//! certificate, its key, and the authority's certificate.

mod bundle;
mod handshake;
mod identity;
#[cfg(feature = "make_keys")]
mod make;

pub use bundle::{Bundle, BundleError};
pub(crate) use handshake::{is_tls, refusal};
pub use identity::Identity;
#[cfg(feature = "make_keys")]
pub use make::{MakeError, make};

/// The certificate of the authority, in a bundle's folder.
const AUTHORITY_FILE: &str = "authority.pem";
/// The node's certificate, in a bundle's folder.
const CERTIFICATE_FILE: &str = "certificate.pem";
/// The key of the certificate, in a bundle's folder.
const KEY_FILE: &str = "key.pem";
