//! Checks this machine before a boat is driven from it.

use crate::preflight::Check;
use std::path::Path;

/// Minimum free disk space for a gateway's recording, MiB; a day of recording takes a tenth of
/// this.
const SPACE_MIN_MIB: u64 = 1024;
/// The folder where systemd lists its inhibitors.
const INHIBITORS: &str = "/run/systemd/inhibit";

/// Checks whether this folder has space for recordings, and whether something prevents the machine
/// from sleeping.
pub fn machine_checks(folder: &Path) -> Vec<Check> {
    vec![space(folder), sleep(Path::new(INHIBITORS))]
}

fn space(folder: &Path) -> Check {
    let name = "recording space";
    match rustix::fs::statvfs(folder) {
        Ok(disk) => {
            let free_mib = disk.f_bavail.saturating_mul(disk.f_frsize) >> 20;
            let found = format!(
                "{free_mib} MiB free in {}, expected at least {SPACE_MIN_MIB}",
                folder.display()
            );
            Check::of(name, free_mib >= SPACE_MIN_MIB, found)
        }
        Err(e) => Check::not_done(name, format!("{}: {e}", folder.display())),
    }
}

fn sleep(inhibitors: &Path) -> Check {
    let Ok(entries) = std::fs::read_dir(inhibitors) else {
        return Check::not_done(
            "sleep",
            format!(
                "{} does not exist: make sure that this machine stays awake",
                inhibitors.display()
            ),
        );
    };
    let texts = entries
        .flatten()
        .filter_map(|entry| std::fs::read_to_string(entry.path()).ok());
    let holders: Vec<String> = texts.filter_map(|text| sleep_inhibitor(&text)).collect();
    if holders.is_empty() {
        let found = "nothing prevents this machine from sleeping; use systemd-inhibit --what=sleep or the systemd unit";
        return Check::of("sleep", false, found.to_owned());
    }
    Check::of(
        "sleep",
        true,
        format!("prevented by {}", holders.join(", ")),
    )
}

/// The name of the process that owns this inhibitor entry, if the entry prevents sleep.
fn sleep_inhibitor(text: &str) -> Option<String> {
    let value = |key: &str| {
        text.lines()
            .find_map(|line| line.strip_prefix(key)?.strip_prefix('='))
    };
    // An inhibitor with the mode "delay" only delays sleep by a few seconds.
    let blocks = value("MODE")? == "block" && value("WHAT")?.split(':').any(|what| what == "sleep");
    blocks.then(|| value("WHO").unwrap_or("somebody").to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::preflight::Verdict;

    #[test]
    fn only_who_blocks_sleep_keeps_a_machine_awake() {
        let folder = tempfile::tempdir().expect("a folder");
        let entry = |name: &str, what: &str, mode: &str| {
            let text = format!(
                "# made by logind\nWHAT={what}\nWHO={name}\nWHY=because\nMODE={mode}\nUID=0\nPID=1\n"
            );
            std::fs::write(folder.path().join(name), text).expect("written");
        };
        entry("NetworkManager", "sleep", "delay");
        entry("desktop", "handle-lid-switch:idle", "block");
        assert_eq!(sleep(folder.path()).verdict, Verdict::Failed);
        entry("squall", "idle:sleep", "block");
        assert_eq!(
            sleep(folder.path()),
            Check::of("sleep", true, "prevented by squall".to_owned())
        );
        assert_eq!(
            sleep(&folder.path().join("none")).verdict,
            Verdict::NotChecked
        );
    }

    #[test]
    fn a_folder_that_is_not_there_has_no_room() {
        let folder = tempfile::tempdir().expect("a folder");
        assert_ne!(space(folder.path()).verdict, Verdict::NotChecked);
        assert_eq!(
            space(&folder.path().join("none")).verdict,
            Verdict::NotChecked
        );
    }
}
