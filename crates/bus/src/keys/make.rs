//! Makes keys: an authority, and a bundle for each identity of a game.

use super::{AUTHORITY_FILE, CERTIFICATE_FILE, Identity, KEY_FILE};
use rcgen::{
    BasicConstraints, CertificateParams, DnType, ExtendedKeyUsagePurpose, IsCa, Issuer, KeyPair,
    KeyUsagePurpose,
};
use std::fs::{DirBuilder, OpenOptions};
use std::io::Write;
use std::os::unix::fs::{DirBuilderExt, OpenOptionsExt};
use std::path::{Path, PathBuf};
use std::time::Duration;
use thiserror::Error;
use time::OffsetDateTime;

/// How far the clocks of boats and laptops may lag behind that of the machine that creates the
/// keys.
const CLOCKS_DIFFER: Duration = Duration::from_secs(24 * 3600);

/// An error while making keys.
#[derive(Debug, Error)]
pub enum MakeError {
    /// A file or folder could not be written.
    #[error("cannot write {}: {source}", path.display())]
    Write {
        /// The file or folder.
        path: PathBuf,
        /// The system's error.
        source: std::io::Error,
    },
    /// A host name is not valid in a certificate, or the time is out of range.
    #[error("cannot make a certificate: {0}")]
    Certificate(#[from] rcgen::Error),
    /// The end of the validity period is beyond the last representable date.
    #[error("certificates cannot be valid for that long")]
    TooLong,
}

/// Makes an authority and a bundle for each identity, each in a folder of that name under `folder`;
/// returns the bundles' folders. Nodes reach the sim at the names and addresses in `hosts`.
///
/// # Errors
/// [`MakeError`]; also if a bundle with one of these names already exists.
pub fn make(
    folder: &Path,
    identities: &[Identity],
    hosts: &[String],
    valid: Duration,
) -> Result<Vec<PathBuf>, MakeError> {
    let now = OffsetDateTime::now_utc();
    let period = (
        now - CLOCKS_DIFFER,
        now.checked_add(valid.try_into().map_err(|_| MakeError::TooLong)?),
    );
    let (from, Some(until)) = period else {
        return Err(MakeError::TooLong);
    };
    let params = |name: String, hosts: &[String]| -> Result<CertificateParams, rcgen::Error> {
        let mut params = CertificateParams::new(hosts)?;
        // zenoh's access control distinguishes nodes by the common name alone.
        params.distinguished_name.push(DnType::CommonName, name);
        (params.not_before, params.not_after) = (from, until);
        Ok(params)
    };
    // Each set has an authority with its own name, so that keys of different sets can be
    // distinguished.
    let mut authority = params(format!("Squall {:016x}", crate::random_number()), &[])?;
    // Allow no authorities below this one: its key is discarded when this function returns, and no
    // other may sign in its name. Revoking a single certificate would need a list that reaches
    // every boat, so sets are replaced as a whole.
    authority.is_ca = IsCa::Ca(BasicConstraints::Constrained(0));
    authority.key_usages = vec![KeyUsagePurpose::KeyCertSign];
    let authority_key = KeyPair::generate()?;
    let authority_pem = authority.self_signed(&authority_key)?.pem();
    let issuer = Issuer::new(authority, authority_key);
    let mut folders = Vec::new();
    for identity in identities {
        // The sim only listens and all others only connect, so no other certificate can serve a
        // game.
        let (usage, hosts) = match identity {
            Identity::Sim => (ExtendedKeyUsagePurpose::ServerAuth, hosts),
            _ => (ExtendedKeyUsagePurpose::ClientAuth, &[][..]),
        };
        let mut certificate = params(identity.to_string(), hosts)?;
        certificate.key_usages = vec![KeyUsagePurpose::DigitalSignature];
        certificate.extended_key_usages = vec![usage];
        // Strict verifiers, such as `openssl verify -x509_strict`, reject a certificate without an
        // authority key identifier.
        certificate.use_authority_key_identifier_extension = true;
        let key = KeyPair::generate()?;
        let certificate = certificate.signed_by(&key, &issuer)?.pem();
        let place = folder.join(identity.to_string());
        make_folder(&place)?;
        write(&place.join(AUTHORITY_FILE), &authority_pem)?;
        write(&place.join(CERTIFICATE_FILE), &certificate)?;
        write(&place.join(KEY_FILE), &key.serialize_pem())?;
        folders.push(place);
    }
    Ok(folders)
}

/// Creates a folder that only its owner can read, and its parent folders; fails if the folder
/// exists.
fn make_folder(path: &Path) -> Result<(), MakeError> {
    let failed = |source| MakeError::Write {
        path: path.to_owned(),
        source,
    };
    let mut builder = DirBuilder::new();
    builder.mode(0o700);
    if let Some(above) = path.parent() {
        builder.recursive(true).create(above).map_err(failed)?;
    }
    // An existing bundle is not overwritten: replacing half a set would leave two sets that do not
    // trust each other.
    builder.recursive(false).create(path).map_err(failed)
}

fn write(path: &Path, text: &str) -> Result<(), MakeError> {
    let file = OpenOptions::new()
        .write(true)
        .create_new(true)
        .mode(0o600)
        .open(path);
    let written = file.and_then(|mut file| file.write_all(text.as_bytes()));
    written.map_err(|source| MakeError::Write {
        path: path.to_owned(),
        source,
    })
}
