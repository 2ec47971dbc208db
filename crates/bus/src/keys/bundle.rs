//! The keys of one node, loaded and validated.

use super::{AUTHORITY_FILE, CERTIFICATE_FILE, Identity, KEY_FILE};
use primitives::input_file;
use rustls::crypto::ring;
use rustls::pki_types::pem::PemObject;
use rustls::pki_types::{CertificateDer, PrivateKeyDer};
use rustls::sign::CertifiedKey;
use std::fmt::Display;
use std::path::{Path, PathBuf};
use thiserror::Error;
use x509_parser::prelude::{ASN1Time, FromDer, GeneralName, X509Certificate};

/// Size limit of each file, bytes.
const FILE_MAX: u64 = 1 << 16;

/// The keys of one node: a folder made by [`make`](super::make()).
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Bundle {
    /// The folder of the bundle.
    pub folder: PathBuf,
    /// The identity in the certificate.
    pub identity: Identity,
    /// The names and addresses covered by the certificate, if it is that of a sim.
    pub hosts: Vec<String>,
    /// The start and end of the certificate's validity, as strings.
    pub valid: [String; 2],
}

/// A file of a bundle, and its fault.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[error("{}: {problem}", file.display())]
pub struct BundleError {
    file: PathBuf,
    problem: String,
}

impl Bundle {
    /// Loads the bundle in a folder.
    ///
    /// # Errors
    /// [`BundleError`] if a file is missing or damaged, if the certificate is not valid now, or if
    /// the key does not match the certificate.
    pub fn load(folder: &Path) -> Result<Bundle, BundleError> {
        let path = |name: &str| folder.join(name);
        if !path(CERTIFICATE_FILE).exists() {
            let problem = format!(
                "no keys found; a key bundle is a folder that contains {CERTIFICATE_FILE}{}",
                bundles_in(folder)
            );
            return Err(BundleError {
                file: folder.to_owned(),
                problem,
            });
        }
        let chain = certificates(&path(CERTIFICATE_FILE))?;
        let key = private_key(&path(KEY_FILE))?;
        certificates(&path(AUTHORITY_FILE))?;
        // zenoh would only report that it cannot open a session. These checks name the faulty file
        // and its fault before anything is opened.
        CertifiedKey::from_der(chain.clone(), key, &ring::default_provider()).map_err(|e| {
            refused(
                &path(KEY_FILE),
                format!("is not the key of {CERTIFICATE_FILE}: {e}"),
            )
        })?;
        let not_understood = |problem: String| refused(&path(CERTIFICATE_FILE), problem);
        let (_, certificate) = X509Certificate::from_der(&chain[0])
            .map_err(|e| not_understood(format!("is not a certificate: {e}")))?;
        let name = certificate
            .subject()
            .iter_common_name()
            .find_map(|name| name.as_str().ok())
            .unwrap_or_default();
        let identity = name
            .parse()
            .map_err(|e| not_understood(format!("was not made by `squall keys new`: {e}")))?;
        // To its owner, an expired certificate looks like a network failure, since the other side
        // silently closes the link.
        check_period(&certificate, ASN1Time::now()).map_err(not_understood)?;
        let validity = certificate.validity();
        let hosts = hosts(&certificate);
        let valid = [validity.not_before, validity.not_after].map(|at| at.to_string());
        Ok(Bundle {
            folder: folder.to_owned(),
            identity,
            hosts,
            valid,
        })
    }

    /// The paths of the authority, the certificate and the key.
    pub(crate) fn files(&self) -> [PathBuf; 3] {
        [AUTHORITY_FILE, CERTIFICATE_FILE, KEY_FILE].map(|name| self.folder.join(name))
    }

    pub(super) fn contents(
        &self,
    ) -> Result<
        (
            Vec<CertificateDer<'static>>,
            Vec<CertificateDer<'static>>,
            PrivateKeyDer<'static>,
        ),
        BundleError,
    > {
        let [authority, certificate, key] = self.files();
        Ok((
            certificates(&authority)?,
            certificates(&certificate)?,
            private_key(&key)?,
        ))
    }
}

/// The certificates in a file, at least one.
fn certificates(file: &Path) -> Result<Vec<CertificateDer<'static>>, BundleError> {
    let text = read(file)?;
    let found: Result<Vec<_>, _> = CertificateDer::pem_slice_iter(&text).collect();
    match found {
        Ok(found) if !found.is_empty() => Ok(found),
        Ok(_) => Err(refused(file, "contains no PEM certificate")),
        Err(e) => Err(refused(file, format!("is damaged: {e}"))),
    }
}

fn private_key(file: &Path) -> Result<PrivateKeyDer<'static>, BundleError> {
    PrivateKeyDer::from_pem_slice(&read(file)?)
        .map_err(|e| refused(file, format!("contains no PEM private key: {e}")))
}

fn read(file: &Path) -> Result<Vec<u8>, BundleError> {
    input_file::read(file, FILE_MAX).map_err(|e| refused(file, e))
}

fn refused(file: &Path, problem: impl Display) -> BundleError {
    BundleError {
        file: file.to_owned(),
        problem: problem.to_string(),
    }
}

/// Checks the validity period of a certificate against `now`.
fn check_period(certificate: &X509Certificate<'_>, now: ASN1Time) -> Result<(), String> {
    let validity = certificate.validity();
    if now > validity.not_after {
        let at = validity.not_after;
        return Err(format!(
            "expired at {at}, and it is {now}: make new keys for all nodes with `squall keys new`"
        ));
    }
    if now < validity.not_before {
        let at = validity.not_before;
        return Err(format!(
            "is valid from {at}, but it is {now} by this machine's clock: check the clock"
        ));
    }
    Ok(())
}

fn hosts(certificate: &X509Certificate<'_>) -> Vec<String> {
    let names = certificate.subject_alternative_name().ok().flatten();
    let names = names.iter().flat_map(|names| &names.value.general_names);
    let host = |name: &GeneralName<'_>| match name {
        GeneralName::DNSName(name) => Some((*name).to_owned()),
        GeneralName::IPAddress(bytes) => match <[u8; 4]>::try_from(*bytes) {
            Ok(v4) => Some(std::net::Ipv4Addr::from(v4).to_string()),
            Err(_) => <[u8; 16]>::try_from(*bytes)
                .ok()
                .map(|v6| std::net::Ipv6Addr::from(v6).to_string()),
        },
        _ => None,
    };
    names.filter_map(host).collect()
}

/// The bundles in a folder, listed for a user who specified the parent folder.
fn bundles_in(folder: &Path) -> String {
    let is_bundle = |name: &String| name.parse::<Identity>().is_ok();
    let names = std::fs::read_dir(folder).into_iter().flatten().flatten();
    let mut names: Vec<String> = names
        .filter_map(|entry| entry.file_name().into_string().ok())
        .filter(is_bundle)
        .collect();
    names.sort();
    if names.is_empty() {
        String::new()
    } else {
        format!("; this folder contains the bundles {}", names.join(", "))
    }
}
