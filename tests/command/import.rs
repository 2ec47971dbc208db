//! `squall import` from the command line: logs of other programs become recordings, and boats are
//! fitted to them. `crates/import/tests` checks the numbers.

use crate::program;

fn log(name: &str) -> String {
    program::project()
        .join("crates/import/tests/logs")
        .join(name)
        .display()
        .to_string()
}

#[test]
fn logs_of_two_boats_are_replayed_as_one_game() {
    let dir = tempfile::tempdir().unwrap();
    let red = format!("red_one={}", log("circle.tlog"));
    let printed = program::printed(dir.path(), &["import", &log("circle.nmea"), &red]);
    for want in [
        "circle.nmea: NMEA 0183 log\n",
        "circle.tlog: MAVLink telemetry log\n",
        "  circle: 20 s, 21 positions, heading, speed, thrust\n",
        "  red_one: 20 s, 101 positions, heading, speed, yaw rate, thrust\n",
        "watch it with: squall replay runs/circle.mcap\n",
    ] {
        assert!(printed.contains(want), "{printed} lacks {want}");
    }
    let summary = program::printed(dir.path(), &["log", "circle"]);
    assert!(
        summary.contains("recorded 2026-05-01 12:00:00 UTC by other programs"),
        "{summary}"
    );
    assert!(summary.contains("red_one           40"), "{summary}");
    let listed = program::printed(dir.path(), &["runs"]);
    assert!(listed.contains("unknown : unknown"), "{listed}");
    // A second import does not overwrite the first.
    let again = program::printed(dir.path(), &["import", &log("circle.nmea")]);
    assert!(
        again.contains("runs/circle_2.mcap") || again.contains("runs/circle-2.mcap"),
        "{again}"
    );
}

#[test]
fn a_boat_is_fitted_to_a_log_of_the_firmware() {
    let dir = tempfile::tempdir().unwrap();
    let rover = log("rover.bin");
    let fitted = program::printed(
        dir.path(),
        &[
            "identify",
            "surveyor_m1_8",
            "--log",
            &rover,
            "--segment-s",
            "3",
            "--fit",
            "yaw_linear",
        ],
    );
    assert!(
        fitted.contains("rover.bin: 594 values in 3 segments"),
        "{fitted}"
    );
    assert!(
        fitted.contains("surge") && fitted.contains("R²"),
        "{fitted}"
    );
}
