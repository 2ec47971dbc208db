//! Finds out why a TLS connection fails; zenoh only reports the failure.

use super::{Bundle, Identity};
use crate::BusError;
use crate::net::address;
use rustls::crypto::ring;
use rustls::pki_types::ServerName;
use rustls::version::TLS13;
use rustls::{
    AlertDescription, CertificateError, ClientConfig, ClientConnection, Error, RootCertStore,
};
use std::io::{Read, Write};
use std::net::{TcpStream, ToSocketAddrs};
use std::sync::Arc;
use std::time::Duration;

/// Timeout of each step; short, because this only explains a failure after the fact.
const STEP: Duration = Duration::from_millis(500);
/// The record type of a TLS alert, which a TLS server sends if it receives a different protocol.
const ALERT: u8 = 0x15;

/// Why the sim at `endpoint` (for example `tls/127.0.0.1:7447`) and these keys do not match; `None`
/// if nothing is listening there or there is no fault.
pub(crate) fn refusal(endpoint: &str, keys: &Bundle) -> Option<BusError> {
    let refused = |why: String| BusError::Keys(format!("{endpoint}: {why}"));
    let address = address(endpoint);
    let host = address
        .rsplit_once(':')?
        .0
        .trim_start_matches('[')
        .trim_end_matches(']');
    // zenoh (1.10) only reports that it could not connect. Repeat the handshake directly with
    // rustls to learn the reason.
    let mut stream = connect(address)?;
    let mut tls = match client(host, keys) {
        Ok(tls) => tls,
        Err(problem) => return Some(refused(problem)),
    };
    // The sim checks our certificate after the handshake has ended on our side, so its alert
    // arrives when we read.
    let outcome = tls
        .complete_io(&mut stream)
        .and_then(|_| rustls::Stream::new(&mut tls, &mut stream).read(&mut [0; 1]));
    let error = outcome.err()?;
    if let Some(error) = error
        .get_ref()
        .and_then(|inner| inner.downcast_ref::<Error>())
    {
        return Some(refused(explained(error, host, &keys.identity)));
    }
    // A suspended sim does not answer either, but may resume.
    let reason = "the server there does not use TLS: the game may have no keys".to_owned();
    tls.is_handshaking().then(|| BusError::Open {
        what: format!("connect to {endpoint}"),
        reason,
    })
}

/// Whether a TLS hub listens at `endpoint`.
pub(crate) fn is_tls(endpoint: &str) -> bool {
    let asked = || {
        let mut stream = connect(address(endpoint))?;
        let mut answer = [0; 1];
        // Eight zeros are not a TLS record, so a TLS server replies with an alert.
        stream.write_all(&[0; 8]).ok()?;
        stream.read_exact(&mut answer).ok()?;
        Some(answer[0] == ALERT)
    };
    asked() == Some(true)
}

fn connect(address: &str) -> Option<TcpStream> {
    let found = address
        .to_socket_addrs()
        .ok()?
        .find_map(|at| TcpStream::connect_timeout(&at, STEP).ok())?;
    found.set_read_timeout(Some(STEP)).ok()?;
    found.set_write_timeout(Some(STEP)).ok()?;
    Some(found)
}

/// The client side of a connection, as zenoh sets it up.
fn client(host: &str, keys: &Bundle) -> Result<ClientConnection, String> {
    let (authority, chain, key) = keys.contents().map_err(|e| e.to_string())?;
    let mut roots = RootCertStore::empty();
    roots.add_parsable_certificates(authority);
    let name = ServerName::try_from(host.to_owned()).map_err(|e| format!("{host:?}: {e}"))?;
    let config = ClientConfig::builder_with_provider(Arc::new(ring::default_provider()))
        // Use the oldest version that zenoh's own links accept (`zenoh-link-tls` 1.10.2): with
        // other versions the handshake could fail or succeed for different reasons.
        .with_protocol_versions(&[&TLS13])
        .and_then(|builder| {
            builder
                .with_root_certificates(roots)
                .with_client_auth_cert(chain, key)
        });
    config
        .and_then(|config| ClientConnection::new(Arc::new(config), name))
        .map_err(|e| e.to_string())
}

fn explained(error: &Error, host: &str, identity: &Identity) -> String {
    match error {
        Error::InvalidCertificate(
            CertificateError::NotValidForName | CertificateError::NotValidForNameContext { .. },
        ) => {
            format!(
                "the sim's certificate is not for {host:?}: connect to a name or address that it covers, or make new keys \
                 with --host {host} ({error})"
            )
        }
        Error::InvalidCertificate(CertificateError::Expired | CertificateError::ExpiredContext { .. }) => {
            format!("the sim's certificate has expired: make new keys for all nodes with `squall keys new` ({error})")
        }
        Error::InvalidCertificate(CertificateError::UnknownIssuer | CertificateError::BadSignature) => {
            "the sim's certificate is from a different authority: its keys and this node's come from different runs of `squall keys new`"
                .to_owned()
        }
        Error::InvalidCertificate(_) => format!("this node rejects the sim's certificate: {error}"),
        Error::AlertReceived(AlertDescription::CertificateExpired) => {
            format!("the sim reports that the certificate of {identity} has expired: check the clocks of both machines")
        }
        Error::AlertReceived(alert) => format!(
            "the sim rejects the certificate of {identity} ({alert:?}): its keys and this node's come from different runs of \
             `squall keys new`"
        ),
        other => other.to_string(),
    }
}
