//! Keys of a node: the authority's certificate, the node's certificate and its key, each decoded
//! from PEM and preceded by its length. Real ones are created for every run.

use super::{Target, check_shown, mutations};
use base64::Engine;
use base64::prelude::BASE64_STANDARD;
use bus::keys::{Bundle, Identity, make};
use std::sync::LazyLock;
use std::time::Duration;
use tempfile::TempDir;

pub(super) const TARGET: Target = Target {
    name: "keys",
    seeds,
    change: mutations,
    check,
    allocated_max: (4 << 20, 500),
};

/// The files of a bundle, with the labels of their contents.
const FILES: [(&str, &str); 3] = [
    ("authority.pem", "CERTIFICATE"),
    ("certificate.pem", "CERTIFICATE"),
    ("key.pem", "PRIVATE KEY"),
];
const VALID: Duration = Duration::from_secs(3600);

static FOLDER: LazyLock<TempDir> = LazyLock::new(|| tempfile::tempdir().expect("a folder"));

fn seeds() -> Vec<Vec<u8>> {
    let identities = [
        Identity::Sim,
        Identity::Team("blue".to_owned()),
        Identity::Gateway(None),
        Identity::Operator,
    ];
    let hosts = ["boat.example".to_owned(), "192.168.1.2".to_owned()];
    let folder = tempfile::tempdir().expect("a folder");
    let bundles = make(folder.path(), &identities, &hosts, VALID).expect("keys");
    let seed = |bundle: std::path::PathBuf| {
        let parts = FILES.map(|(file, _)| {
            let text = std::fs::read_to_string(bundle.join(file)).expect("a file");
            let digits: String = text.lines().filter(|line| !line.starts_with('-')).collect();
            let der = BASE64_STANDARD.decode(digits).expect("PEM");
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
        let pem = format!(
            "-----BEGIN {label}-----\n{}\n-----END {label}-----\n",
            BASE64_STANDARD.encode(der)
        );
        std::fs::write(FOLDER.path().join(file), pem).expect("a file");
        bytes = rest;
    }
    match Bundle::load(FOLDER.path()) {
        Ok(bundle) => {
            assert_eq!(
                bundle.identity.to_string().parse(),
                Ok(bundle.identity.clone())
            );
            check_shown(&bundle.valid.join(" "));
        }
        Err(error) => {
            check_shown(&error);
            assert!(
                error
                    .to_string()
                    .contains(&FOLDER.path().display().to_string()),
                "{error} names no file"
            );
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn real_keys_are_keys_here() {
        for seed in seeds() {
            check(&seed);
            assert!(
                Bundle::load(FOLDER.path()).is_ok(),
                "a reassembled bundle is valid"
            );
        }
    }
}
