//! A hub's limit on open files. Some files are held in reserve until all others are in use.

use rustix::process::{Resource, Rlimit, getrlimit, setrlimit};

/// The number reserved, if the system allows at least eight times as many.
const KEPT: u64 = 128;

/// The limits on this process's open files.
#[derive(Clone, Copy, Debug)]
pub(crate) struct OpenFiles {
    /// The limit in normal operation.
    pub(crate) usual: u64,
    /// The limit including the reserve.
    most: u64,
}

impl OpenFiles {
    /// Raises the limit to `wanted` files, or as far as the system permits, and reserves some.
    pub(crate) fn reserve(wanted: u64) -> OpenFiles {
        let limits = getrlimit(Resource::Nofile);
        let [current, maximum] =
            [limits.current, limits.maximum].map(|limit| limit.unwrap_or(u64::MAX));
        // The limit is lowered by the reserve, so that the system itself refuses files: zenoh's
        // `accept` cannot be told to keep a reserve.
        let kept = KEPT.min(maximum / 8);
        let most = maximum.min(current.max(wanted).saturating_add(kept));
        let files = OpenFiles {
            usual: most - kept,
            most,
        };
        // If the system refuses, the limits remain unchanged.
        if set(files.usual) {
            files
        } else {
            OpenFiles {
                usual: current,
                most: current,
            }
        }
    }

    /// The number of reserved files.
    pub(crate) fn kept(self) -> u64 {
        self.most - self.usual
    }

    /// Makes the reserve available to this process, or withdraws it.
    pub(crate) fn lend(self, is_lent: bool) {
        set(if is_lent { self.most } else { self.usual });
    }
}

fn set(current: u64) -> bool {
    let maximum = getrlimit(Resource::Nofile).maximum;
    setrlimit(
        Resource::Nofile,
        Rlimit {
            current: Some(current),
            maximum,
        },
    )
    .is_ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn some_files_are_kept_and_a_second_hub_of_the_process_keeps_no_more() {
        let files = OpenFiles::reserve(0);
        assert!(files.kept() > 0);
        assert_eq!(OpenFiles::reserve(0).usual, files.usual);
        for (is_lent, want) in [(true, files.most), (false, files.usual)] {
            files.lend(is_lent);
            assert_eq!(getrlimit(Resource::Nofile).current, Some(want));
        }
    }
}
