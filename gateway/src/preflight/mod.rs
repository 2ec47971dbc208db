//! The pre-flight check of a boat before it is armed, and its report.

mod boat;
mod compass_swing;
mod fix_scatter;

pub use boat::{Water, boat_checks};
pub use compass_swing::{CompassSwing, Deviation};

use serde::{Deserialize, Serialize};

/// The checks that a report must contain before a boat can be armed.
const NEEDED: [&str; 6] = [
    "sentences",
    "fix",
    "scatter",
    "geofence",
    "compass",
    "control",
];

/// The result of one check.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Verdict {
    /// Passed.
    Passed,
    /// Failed.
    Failed,
    /// Not checked, or could not be checked.
    NotChecked,
}

/// One check.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Check {
    /// The name of the check.
    pub name: String,
    /// The result of the check.
    pub verdict: Verdict,
    /// The value found, and the values allowed.
    pub found: String,
}

impl Check {
    /// A check that passes if `is_well`.
    pub fn of(name: &str, is_well: bool, found: String) -> Check {
        Check {
            name: name.to_owned(),
            verdict: if is_well {
                Verdict::Passed
            } else {
                Verdict::Failed
            },
            found,
        }
    }

    /// A check that was not done, and why.
    pub fn not_done(name: &str, why: impl Into<String>) -> Check {
        Check {
            name: name.to_owned(),
            verdict: Verdict::NotChecked,
            found: why.into(),
        }
    }
}

/// The report of a pre-flight check.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Report {
    /// The boat's name in its game.
    pub vehicle: String,
    /// The link's address.
    pub link: String,
    /// The time, s since 1970 in UTC.
    pub at_unix_s: u64,
    /// The same time as a string.
    pub at: String,
    /// The checks, in this order.
    pub checks: Vec<Check>,
}

impl Report {
    /// The reasons why the check has not passed: failed checks, and required checks that were not
    /// done.
    pub fn faults(&self) -> Vec<String> {
        let failed = self
            .checks
            .iter()
            .filter(|check| check.verdict == Verdict::Failed);
        let failed = failed.map(|check| format!("{} ({})", check.name, check.found));
        let is_done = |name: &str| {
            self.checks
                .iter()
                .any(|check| check.name == name && check.verdict != Verdict::NotChecked)
        };
        let missing = NEEDED
            .iter()
            .filter(|name| !is_done(name))
            .map(|name| format!("{name} (not checked)"));
        failed.chain(missing).collect()
    }

    /// Whether the report allows a gateway to arm this boat.
    ///
    /// # Errors
    /// The reason for refusal.
    pub fn admits(
        &self,
        vehicle: &str,
        link: &str,
        now_unix_s: u64,
        age_max_h: f64,
    ) -> Result<(), String> {
        let faults = self.faults();
        if !faults.is_empty() {
            return Err(format!("it has not passed: {}", faults.join("; ")));
        }
        if (self.vehicle.as_str(), self.link.as_str()) != (vehicle, link) {
            return Err(format!(
                "it is for {} at {}, expected {vehicle} at {link}",
                self.vehicle, self.link
            ));
        }
        let age_h = (now_unix_s as f64 - self.at_unix_s as f64) / 3600.0;
        // A report from the future comes from a machine with a different clock, so its age is
        // unknown.
        if (0.0..=age_max_h).contains(&age_h) {
            return Ok(());
        }
        Err(format!(
            "it is {age_h:.1} h old, expected 0 to {age_max_h} (preflight.age_max_h)"
        ))
    }

    /// The report as a string.
    pub fn text(&self) -> String {
        let line = |check: &Check| {
            let verdict = match check.verdict {
                Verdict::Passed => "passed",
                Verdict::Failed => "FAILED",
                Verdict::NotChecked => "-",
            };
            format!("  {verdict:<7} {:<16} {}\n", check.name, check.found)
        };
        let lines: String = self.checks.iter().map(line).collect();
        let faults = self.faults();
        let end = if faults.is_empty() {
            "passed".to_owned()
        } else {
            format!("NOT passed: {}", faults.join("; "))
        };
        format!(
            "pre-flight check of {} at {}, {}\n{lines}{end}\n",
            self.vehicle, self.link, self.at
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn report(checks: Vec<Check>) -> Report {
        Report {
            vehicle: "blue_one".into(),
            link: "tcp://a:1".into(),
            at_unix_s: 7200,
            at: "then".into(),
            checks,
        }
    }

    fn all_well() -> Vec<Check> {
        NEEDED
            .iter()
            .map(|name| Check::of(name, true, String::new()))
            .collect()
    }

    #[test]
    fn a_report_admits_its_own_boat_for_as_long_as_it_is_fresh() {
        let report = report(all_well());
        for (vehicle, link, now_s, refusal) in [
            ("blue_one", "tcp://a:1", 7200, ""),
            ("blue_one", "tcp://a:1", 10_800, ""),
            (
                "blue_one",
                "tcp://a:1",
                11_000,
                "it is 1.1 h old, expected 0 to 1",
            ),
            ("blue_one", "tcp://a:1", 7000, "it is -0.1 h old"),
            (
                "red_one",
                "tcp://a:1",
                7200,
                "it is for blue_one at tcp://a:1, expected red_one at tcp://a:1",
            ),
            (
                "blue_one",
                "tcp://b:1",
                7200,
                "expected blue_one at tcp://b:1",
            ),
        ] {
            let refused = report
                .admits(vehicle, link, now_s, 1.0)
                .err()
                .unwrap_or_default();
            assert!(
                refused.contains(refusal) && refused.is_empty() == refusal.is_empty(),
                "{refused}"
            );
        }
    }

    #[test]
    fn what_failed_and_what_nobody_looked_at_is_named() {
        let mut checks = all_well();
        checks.push(Check::of(
            "battery",
            false,
            "21.0 V, expected 22 or more".into(),
        ));
        checks.push(Check::not_done("sleep", "no systemd here"));
        checks[3] = Check::not_done("geofence", "no game");
        let report = report(checks);
        assert_eq!(
            report.faults(),
            [
                "battery (21.0 V, expected 22 or more)",
                "geofence (not checked)"
            ]
        );
        assert!(report.admits("blue_one", "tcp://a:1", 7200, 1.0).is_err());
        let text = report.text();
        assert!(
            text.contains("FAILED  battery") && text.contains("-       sleep"),
            "{text}"
        );
        assert!(
            text.ends_with(
                "NOT passed: battery (21.0 V, expected 22 or more); geofence (not checked)\n"
            ),
            "{text}"
        );
    }
}
