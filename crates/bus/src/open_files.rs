//! How many files a hub may have open. Some of those that the system allows are kept for when all others are taken.

use rustix::process::{Resource, Rlimit, getrlimit, setrlimit};

/// How many are kept, if the system allows eight times as many.
const KEPT: u64 = 128;

/// The limits of this process.
#[derive(Clone, Copy, Debug)]
pub(crate) struct OpenFiles {
    /// As long as nobody opens too many.
    pub(crate) usual: u64,
    /// With those that are kept.
    most: u64,
}

impl OpenFiles {
    /// Allows this process to open so many files, or as many as the system lets it, and keeps some.
    pub(crate) fn reserve(wanted: u64) -> OpenFiles {
        let limits = getrlimit(Resource::Nofile);
        let [current, maximum] = [limits.current, limits.maximum].map(|limit| limit.unwrap_or(u64::MAX));
        // The limit is lowered by what is kept, so that the system itself refuses the files:
        // `accept` in zenoh cannot be asked to leave some.
        let kept = KEPT.min(maximum / 8);
        let most = maximum.min(current.max(wanted).saturating_add(kept));
        let files = OpenFiles { usual: most - kept, most };
        // Where the system does not let it, all stays as it was.
        if set(files.usual) { files } else { OpenFiles { usual: current, most: current } }
    }

    /// How many are kept.
    pub(crate) fn kept(self) -> u64 {
        self.most - self.usual
    }

    /// Lets this process open those too that are kept, or no more of them.
    pub(crate) fn lend(self, is_lent: bool) {
        set(if is_lent { self.most } else { self.usual });
    }
}

fn set(current: u64) -> bool {
    let maximum = getrlimit(Resource::Nofile).maximum;
    setrlimit(Resource::Nofile, Rlimit { current: Some(current), maximum }).is_ok()
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
