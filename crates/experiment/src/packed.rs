//! A plan of many games with all required files, for a process on another machine.

use base64::Engine;
use base64::engine::general_purpose::STANDARD as BASE64;
use scenario::{Files, Problems};
use serde::de::{DeserializeOwned, Error as _};
use serde::{Deserialize, Deserializer, Serialize, Serializer};
use std::path::PathBuf;
use std::sync::Arc;
use thiserror::Error;

/// A sweep or a tournament with all required files; unpacking it reads no other files.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Packed {
    /// The checked sweep or tournament file as JSON.
    pub spec: String,
    /// All required files, in the order in which they are requested: a file precedes those that it
    /// names. In JSON a file is its path with its content as a string, or as bytes in base64.
    #[serde(serialize_with = "write_files", deserialize_with = "read_files")]
    pub files: Vec<(PathBuf, Vec<u8>)>,
    /// The plan's digest.
    pub digest: String,
}

/// An error while unpacking a plan.
#[derive(Debug, Error)]
pub enum UnpackError {
    /// The checked file is invalid JSON.
    #[error("cannot read the packed plan: {0}")]
    Spec(#[from] serde_json::Error),
    /// The game cannot be read from the packed files.
    #[error("{0}")]
    Game(#[from] Problems),
    /// The unpacked plan has a different digest.
    #[error(
        "the packed games differ on this machine: expected digest {expected}, found {found}; \
         both machines need the same version of Squall, and this one has {}",
        primitives::VERSION
    )]
    Other {
        /// The digest at packing.
        expected: String,
        /// The digest after unpacking.
        found: String,
    },
}

impl Packed {
    /// Packs the plan of a checked file.
    ///
    /// # Panics
    /// If `spec` cannot be written as JSON because its maps have keys that are not strings.
    pub fn new(spec: &impl Serialize, files: Vec<(PathBuf, Arc<[u8]>)>, digest: String) -> Packed {
        Packed {
            spec: serde_json::to_string(spec).expect("its map keys are strings"),
            files: files
                .into_iter()
                .map(|(path, bytes)| (path, bytes.to_vec()))
                .collect(),
            digest,
        }
    }

    /// The plan that `plan` creates from the checked file and the packed files; `digest` computes
    /// its digest.
    ///
    /// # Errors
    /// [`UnpackError`] if it is damaged or was packed by a different version of Squall.
    pub fn unpack<S: DeserializeOwned, P>(
        self,
        plan: impl FnOnce(&S, Arc<Files>) -> Result<P, Problems>,
        digest: impl FnOnce(&P) -> String,
    ) -> Result<P, UnpackError> {
        let plan = plan(
            &serde_json::from_str(&self.spec)?,
            Arc::new(Files::kept(self.files)),
        )?;
        let found = digest(&plan);
        // The digest of plan and files shows whether the two versions agree on the games.
        if found == self.digest {
            Ok(plan)
        } else {
            Err(UnpackError::Other {
                expected: self.digest,
                found,
            })
        }
    }
}

/// The JSON form of a file.
#[derive(Serialize, Deserialize)]
struct PackedFile {
    path: PathBuf,
    #[serde(skip_serializing_if = "Option::is_none", default)]
    text: Option<String>,
    #[serde(skip_serializing_if = "Option::is_none", default)]
    base64: Option<String>,
}

fn write_files<S: Serializer>(
    files: &[(PathBuf, Vec<u8>)],
    serializer: S,
) -> Result<S::Ok, S::Error> {
    serializer.collect_seq(files.iter().map(|(path, bytes)| {
        let text = String::from_utf8(bytes.clone()).ok();
        let base64 = text.is_none().then(|| BASE64.encode(bytes));
        PackedFile {
            path: path.clone(),
            text,
            base64,
        }
    }))
}

fn read_files<'de, D: Deserializer<'de>>(
    deserializer: D,
) -> Result<Vec<(PathBuf, Vec<u8>)>, D::Error> {
    let files: Vec<PackedFile> = Vec::deserialize(deserializer)?;
    let unpacked =
        files
            .into_iter()
            .map(|PackedFile { path, text, base64 }| match (text, base64) {
                (Some(text), None) => Ok((path, text.into_bytes())),
                (None, Some(base64)) => {
                    let bytes = BASE64.decode(base64);
                    Ok((
                        path.clone(),
                        bytes.map_err(|why| {
                            D::Error::custom(format!("{}: {why}", path.display()))
                        })?,
                    ))
                }
                _ => Err(D::Error::custom(format!(
                    "{}: expected either text or base64",
                    path.display()
                ))),
            });
    unpacked.collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn texts_and_models_go_through_json_and_what_is_neither_is_refused() {
        let files = vec![
            (PathBuf::from("a.toml"), b"x = \"1\"\n".to_vec()),
            (PathBuf::from("b.onnx"), vec![0, 255, 7]),
        ];
        let packed = Packed {
            spec: "{}".to_owned(),
            files,
            digest: "d".to_owned(),
        };
        let json = serde_json::to_string(&packed).expect("its map keys are strings");
        assert!(
            json.contains("x = \\\"1\\\"\\n") && json.contains("AP8H"),
            "{json}"
        );
        assert_eq!(
            serde_json::from_str::<Packed>(&json).expect("it is read again"),
            packed
        );
        for (broken, why) in [
            ("\"base64\":\"AP8H\"", "\"base64\":\"?\""),
            ("\"base64\":\"AP8H\"", "\"bytes\":[]"),
        ] {
            let refused = serde_json::from_str::<Packed>(&json.replace(broken, why))
                .expect_err("it is refused");
            assert!(refused.to_string().contains("b.onnx"), "{refused}");
        }
    }
}
