//! Keys of a node: the authority's certificate, the node's certificate and its key, each decoded
//! from PEM and preceded by its length. Real ones are created for every run.

use super::{Target, binaries, check_shown};
use bus::keys::{Bundle, Identity, make};
use std::sync::LazyLock;
use std::time::Duration;
use tempfile::TempDir;

pub(super) const TARGET: Target =
    Target { name: "keys", seeds, change: binaries, check, allocated_max: (4 << 20, 500) };

/// The files of a bundle, with the labels of their contents.
const FILES: [(&str, &str); 3] =
    [("authority.pem", "CERTIFICATE"), ("certificate.pem", "CERTIFICATE"), ("key.pem", "PRIVATE KEY")];
const DIGITS: &[u8; 64] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
const VALID: Duration = Duration::from_secs(3600);

static FOLDER: LazyLock<TempDir> = LazyLock::new(|| tempfile::tempdir().expect("a folder"));

fn seeds() -> Vec<Vec<u8>> {
    let identities = [Identity::Sim, Identity::Team("blue".to_owned()), Identity::Gateway(None), Identity::Operator];
    let hosts = ["boat.example".to_owned(), "192.168.1.2".to_owned()];
    let folder = tempfile::tempdir().expect("a folder");
    let bundles = make(folder.path(), &identities, &hosts, VALID).expect("keys");
    let seed = |bundle: std::path::PathBuf| {
        let parts = FILES.map(|(file, _)| {
            let text = std::fs::read_to_string(bundle.join(file)).expect("a file");
            let der = from_base64(text.lines().filter(|line| !line.starts_with('-')));
            [&(der.len() as u32).to_le_bytes()[..], &der].concat()
        });
        parts.concat()
    };
    bundles.into_iter().map(seed).collect()
}

fn check(mut bytes: &[u8]) {
    for (file, label) in FILES {
        let (length, rest) = bytes.split_first_chunk::<4>().unwrap_or((&[0; 4], &[]));
        let (der, rest) = rest.split_at((u32::from_le_bytes(*length) as usize).min(rest.len()));
        let pem = format!("-----BEGIN {label}-----\n{}\n-----END {label}-----\n", base64(der));
        std::fs::write(FOLDER.path().join(file), pem).expect("a file");
        bytes = rest;
    }
    match Bundle::load(FOLDER.path()) {
        Ok(bundle) => {
            assert_eq!(bundle.identity.to_string().parse(), Ok(bundle.identity.clone()));
            check_shown(&bundle.valid.join(" "));
        }
        Err(error) => {
            check_shown(&error);
            assert!(error.to_string().contains(&FOLDER.path().display().to_string()), "{error} names no file");
        }
    }
}

fn base64(bytes: &[u8]) -> String {
    let sextets = bytes.chunks(3).flat_map(|three| {
        let whole = three.iter().fold(0_u32, |whole, byte| whole << 8 | u32::from(*byte)) << (8 * (3 - three.len()));
        (0..4).map(move |i| if i <= three.len() { DIGITS[(whole >> (18 - 6 * i)) as usize % 64] } else { b'=' })
    });
    sextets.map(char::from).collect()
}

fn from_base64<'a>(lines: impl Iterator<Item = &'a str>) -> Vec<u8> {
    let (mut bytes, mut whole, mut bits) = (Vec::new(), 0_u32, 0);
    for digit in lines.flat_map(str::bytes).filter_map(|c| DIGITS.iter().position(|digit| *digit == c)) {
        (whole, bits) = (whole << 6 | digit as u32, bits + 6);
        if bits >= 8 {
            bits -= 8;
            bytes.push((whole >> bits) as u8);
        }
    }
    bytes
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn real_keys_are_keys_here() {
        for seed in seeds() {
            check(&seed);
            assert!(Bundle::load(FOLDER.path()).is_ok(), "a reassembled bundle is valid");
        }
    }
}
