//! `squall trial` and `squall identify` from the command line: reference data as CSV files.
#![expect(
    clippy::disallowed_methods,
    reason = "tolerances are far larger than the last bit"
)]

use crate::program::{printed, project, scenario, squall};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use tempfile::TempDir;

/// Numbers by column name.
type Columns = BTreeMap<String, Vec<f64>>;

fn boat(name: &str) -> String {
    scenario(&format!("boats/{name}.toml"))
}

/// Runs a trial that must succeed; returns its output.
fn trial(dir: &TempDir, args: &[&str]) -> String {
    printed(dir, &[&["trial"], args].concat())
}

fn columns(path: &Path) -> Columns {
    let text = std::fs::read_to_string(path).unwrap();
    let mut lines = text.lines();
    let heads: Vec<&str> = lines.next().unwrap().split(',').collect();
    let mut columns: Columns = heads
        .iter()
        .map(|head| ((*head).to_owned(), vec![]))
        .collect();
    for line in lines {
        for (head, cell) in heads.iter().zip(line.split(',')) {
            columns
                .get_mut(*head)
                .unwrap()
                .push(cell.parse().unwrap_or(f64::NAN));
        }
    }
    columns
}

fn reference(name: &str) -> Columns {
    columns(&project().join("sim/tests").join(name))
}

fn write_orders(dir: &TempDir, heads: &str, rows: impl Iterator<Item = [f64; 3]>) -> PathBuf {
    let rows: Vec<String> = rows.map(|[t, a, b]| format!("{t},{a},{b}")).collect();
    let path = dir.path().join("in.csv");
    std::fs::write(&path, format!("{heads}\n{}\n", rows.join("\n"))).unwrap();
    path
}

/// An Otter reference, and the track that its commands produce.
fn otter(name: &str, more: &[&str]) -> (Columns, Columns) {
    let dir = tempfile::tempdir().unwrap();
    let want = reference(&format!("otter/{name}.csv"));
    let rows = (0..want["t"].len()).map(|i| [want["t"][i], want["n1_cmd"][i], want["n2_cmd"][i]]);
    write_orders(&dir, "t_s,port_rad_s,starboard_rad_s", rows);
    trial(
        &dir,
        &[
            &[&boat("otter"), "--orders", "in.csv", "--csv", "out.csv"],
            more,
        ]
        .concat(),
    );
    (want, columns(&dir.path().join("out.csv")))
}

/// The largest distance from the reference, divided by the distance travelled (at least one metre).
fn position_error(want: &Columns, got: &Columns) -> f64 {
    assert_eq!(want["t"].len(), got["t_s"].len());
    let mut sailed_m = 0.0;
    let mut worst = 0.0_f64;
    for i in 0..want["t"].len() {
        assert!((want["t"][i] - got["t_s"][i]).abs() < 1e-9);
        let x = want["y_east"][i];
        let y = want["x_north"][i];
        if i > 0 {
            sailed_m += (x - want["y_east"][i - 1]).hypot(y - want["x_north"][i - 1]);
        }
        worst = worst.max((got["x_m"][i] - x).hypot(got["y_m"][i] - y) / f64::max(sailed_m, 1.0));
    }
    worst
}

fn last(columns: &Columns, head: &str) -> f64 {
    *columns[head].last().unwrap()
}

#[test]
fn the_otter_accelerates_and_turns_as_the_reference_does() {
    for (name, share) in [("accel_n80", 0.001), ("turn_80_60", 0.01)] {
        let (want, got) = otter(name, &[]);
        let error = position_error(&want, &got);
        assert!(
            error < f64::max(share, 0.005),
            "{name}: position is off by {error}"
        );
        let yaw_rate_deg_s = last(&want, "r").to_degrees();
        for (head, want) in [
            ("surge_m_s", last(&want, "u")),
            ("yaw_rate_deg_s", yaw_rate_deg_s),
            ("port_newton", last(&want, "T1")),
        ] {
            let got = last(&got, head);
            assert!(
                (got - want).abs() <= share * want.abs() + 1e-9,
                "{name}: {head} {got}, reference {want}"
            );
        }
    }
}

#[test]
fn the_otter_drifts_in_a_current_as_the_reference_does() {
    let (want, got) = otter(
        "current_drift_0p5_b30",
        &["--current-m-s", "0.5", "--current-toward-deg", "30"],
    );
    let error = position_error(&want, &got);
    let psi_deg = last(&got, "heading_deg") - 360.0;
    assert!(error < 0.005, "position is off by {error}");
    assert!((psi_deg + 6.22).abs() < 0.05, "heading {psi_deg}");
    for i in 0..want["t"].len() {
        // Velocity over the ground, in the boat's axes.
        assert!(
            (want["u"][i] - got["surge_m_s"][i]).abs() < 2e-3,
            "row {i}: {} {}",
            want["u"][i],
            got["surge_m_s"][i]
        );
        assert!(
            (want["v"][i] - got["sway_m_s"][i]).abs() < 2e-3,
            "row {i}: {} {}",
            want["v"][i],
            got["sway_m_s"][i]
        );
    }
}

/// The swings of a zigzag (extreme headings, in degrees) and the mean period (s) after 40 s.
fn zigzag(times_s: &[f64], headings_deg: &[f64]) -> (Vec<f64>, f64) {
    let within: Vec<f64> = headings_deg
        .iter()
        .map(|h| (h + 180.0).rem_euclid(360.0) - 180.0)
        .collect();
    let settled = || (1..times_s.len() - 1).filter(|i| times_s[*i] > 40.0);
    let turns = |i: &usize| (within[*i] - within[i - 1]) * (within[i + 1] - within[*i]) <= 0.0;
    let swings_deg = settled()
        .filter(turns)
        .map(|i| within[i])
        .filter(|psi| psi.abs() > 10.0)
        .collect();
    let rising = settled().filter(|i| within[i - 1] < 0.0 && within[*i] >= 0.0);
    let passes: Vec<f64> = rising
        .map(|i| times_s[i] - 0.1 * within[i] / (within[i] - within[i - 1]))
        .collect();
    (
        swings_deg,
        (passes[passes.len() - 1] - passes[0]) / (passes.len() - 1) as f64,
    )
}

/// With the switching times taken from the recorded shaft speeds, every swing is right.
#[test]
fn the_otter_zigzags_swing_by_swing_where_the_switches_are_known() {
    let dir = tempfile::tempdir().unwrap();
    let want = reference("otter/zigzag10_n80_d10.csv");
    let switch = |i: usize| {
        let told = want["n1_cmd"][i];
        let before = want["n1"][i - 1];
        let now = want["n1"][i];
        // Since the switch, a first-order lag of 0.1 s has moved from `before` towards `told`, if
        // it has moved at all.
        let left = (now - told) / (before - told);
        want["t"][i] + if now == before { 0.0 } else { 0.1 * left.ln() }
    };
    let changes = (1..want["t"].len()).filter(|i| want["n1_cmd"][*i] != want["n1_cmd"][i - 1]);
    let rows = changes.map(|i| {
        [
            (50.0 * switch(i)).round() / 50.0,
            want["n1_cmd"][i],
            want["n2_cmd"][i],
        ]
    });
    write_orders(
        &dir,
        "t_s,port_rad_s,starboard_rad_s",
        [[0.0, 80.0, 80.0]].into_iter().chain(rows),
    );
    let end = last(&want, "t").to_string();
    let how = ["--tick-s", "0.02", "--duration-s", &end];
    trial(
        &dir,
        &[
            &[
                boat("otter").as_str(),
                "--orders",
                "in.csv",
                "--csv",
                "out.csv",
            ][..],
            &how,
        ]
        .concat(),
    );
    let got = columns(&dir.path().join("out.csv"));
    let psi_deg: Vec<f64> = want["psi"].iter().map(|psi| psi.to_degrees()).collect();
    let (want_deg, _) = zigzag(&want["t"], &psi_deg);
    let (swings_deg, period_s) = zigzag(&got["t_s"], &got["heading_deg"]);
    assert!(
        swings_deg.len() == want_deg.len() && (period_s - 8.25).abs() < 0.02 * 8.25,
        "period {period_s} s"
    );
    let worst_deg = swings_deg
        .iter()
        .zip(&want_deg)
        .map(|(a, b)| (a - b).abs())
        .fold(0.0, f64::max);
    let error = position_error(&want, &got);
    assert!(
        worst_deg < 0.5 && error < 0.005,
        "{swings_deg:?}, reference {want_deg:?}; position {error}"
    );
}

/// Compares a kinematic reference with a trial; every value must agree within 1e-6. A row of the
/// reference is the state after its command, so the command is given at the time of the previous
/// row.
fn kinematic(name: &str, kind: &str, heads: [&str; 2], more: &[&str]) {
    let dir = tempfile::tempdir().unwrap();
    let want = reference(&format!("kinematic/{kind}_{name}.csv"));
    let from = if heads[0] == "thrust" {
        "t_s,thrust_pct,rudder_pct"
    } else {
        "t_s,speed_m_s,heading_deg"
    };
    let n = want["t"].len();
    write_orders(
        &dir,
        from,
        (1..n).map(|i| [want["t"][i - 1], want[heads[0]][i], want[heads[1]][i]]),
    );
    let end = want["t"][n - 1].to_string();
    let fixed = [
        "--orders",
        "in.csv",
        "--csv",
        "out.csv",
        "--duration-s",
        &end,
    ];
    trial(
        &dir,
        &[
            &[boat(&format!("{kind}_kinematic")).as_str()][..],
            &fixed,
            more,
        ]
        .concat(),
    );
    let got = columns(&dir.path().join("out.csv"));
    assert_eq!(got["t_s"].len(), n);
    for i in 0..n {
        let turned = (got["heading_deg"][i] - want["heading"][i] + 180.0).rem_euclid(360.0) - 180.0;
        let errors = [
            got["x_m"][i] - want["x"][i],
            got["y_m"][i] - want["y"][i],
            got["surge_m_s"][i] - want["speed"][i],
            turned,
        ];
        for (what, error) in ["x", "y", "speed", "heading"].iter().zip(errors) {
            assert!(
                error.abs() < 1e-6,
                "{kind} {name}, row {i}: {what} is off by {error}"
            );
        }
    }
    assert!(
        got["port_newton"].iter().all(|newton| newton.is_nan()),
        "it has no thrusters"
    );
}

#[test]
fn kinematic_boats_follow_orders_and_commands_as_the_reference_does() {
    const STEERED: [&str; 2] = ["cmd_speed", "target_heading"];
    // Each begins with the first row of the reference.
    for (name, kind, heads, start) in [
        ("accel_max", "heron", STEERED, &[][..]),
        ("accel_max", "surveyor", STEERED, &[]),
        (
            "turn90_max",
            "heron",
            STEERED,
            &[
                "--start-surge-m-s",
                "1.999944",
                "--start-thrust-pct",
                "99.996694",
            ],
        ),
        (
            "turn90_max",
            "surveyor",
            STEERED,
            &["--start-surge-m-s", "3"],
        ),
        (
            "tr_thrust100_rudder50",
            "surveyor",
            ["thrust", "rudder"],
            &["--start-surge-m-s", "3", "--start-thrust-pct", "100"],
        ),
    ] {
        kinematic(name, kind, heads, start);
    }
}

#[test]
fn the_units_of_a_thruster_say_the_same() {
    let dir = tempfile::tempdir().unwrap();
    let mut tracks = vec![];
    let newton = 0.01108 * 50.0 * 50.0;
    for (heads, value) in [
        ("t_s,port_rad_s,starboard_rad_s", 50.0),
        ("t (s),Port [rad/s],Starboard [rad/s]", 50.0),
        ("t_s,port_pct,starboard_pct", 100.0 * 50.0 / 103.931),
        ("t_s,port_newton,starboard_newton", newton),
    ] {
        write_orders(
            &dir,
            heads,
            [[0.0, value, value], [20.0, 0.0, 0.0]].into_iter(),
        );
        trial(
            &dir,
            &[&boat("otter"), "--orders", "in.csv", "--csv", "out.csv"],
        );
        tracks.push(columns(&dir.path().join("out.csv")));
    }
    assert!((last(&tracks[0], "port_newton") - newton).abs() < 1e-6);
    for track in &tracks {
        assert!((last(track, "y_m") - last(&tracks[0], "y_m")).abs() < 1e-6);
    }
}

#[test]
fn a_boat_starts_as_it_is_told_to() {
    let dir = tempfile::tempdir().unwrap();
    write_orders(
        &dir,
        "t_s,speed_m_s,heading_deg",
        [[0.0, 1.0, 90.0], [30.0, 1.0, 90.0]].into_iter(),
    );
    let start = [
        "--start-heading-deg",
        "350",
        "--start-surge-m-s",
        "1.5",
        "--start-sway-m-s",
        "-0.1",
    ];
    let more = ["--start-yaw-rate-deg-s", "3", "--with-orders"];
    trial(
        &dir,
        &[
            &[
                boat("surveyor_m1_8").as_str(),
                "--orders",
                "in.csv",
                "--csv",
                "out.csv",
            ],
            &start[..],
            &more,
        ]
        .concat(),
    );
    let got = columns(&dir.path().join("out.csv"));
    for (head, want) in [
        ("t_s", 0.0),
        ("x_m", 0.0),
        ("y_m", 0.0),
        ("heading_deg", 350.0),
        ("surge_m_s", 1.5),
        ("sway_m_s", -0.1),
        ("yaw_rate_deg_s", 3.0),
        ("port_newton", 0.0),
        ("heading_order_deg", 90.0),
    ] {
        assert!(
            (got[head][0] - want).abs() < 1e-9,
            "{head} starts at {}",
            got[head][0]
        );
    }
    assert!(
        (last(&got, "heading_deg") - 90.0).abs() < 3.0
            && (last(&got, "surge_m_s") - 1.0).abs() < 0.05
    );
}

/// The results of a manoeuvre by name.
fn manoeuvre(dir: &TempDir, kind: &str, name: &str, more: &[&str]) -> BTreeMap<String, f64> {
    let text = trial(
        dir,
        &[&[boat(kind).as_str(), "--manoeuvre", name], more].concat(),
    );
    let number = |line: &str| -> Option<(String, f64)> {
        let (what, rest) = line.strip_prefix("  ")?.split_once("  ")?;
        Some((
            what.to_owned(),
            rest.split_whitespace().next()?.parse().ok()?,
        ))
    };
    text.lines().filter_map(number).collect()
}

#[test]
fn manoeuvres_give_numbers_a_track_and_a_plot() {
    for name in [
        "turning_circle",
        "zigzag",
        "crash_stop",
        "acceleration",
        "drift",
        "spin",
    ] {
        for kind in ["surveyor_m1_8", "surveyor_kinematic"] {
            let dir = tempfile::tempdir().unwrap();
            let current = ["--current-m-s", "0.2", "--current-toward-deg", "45"];
            let results = manoeuvre(&dir, kind, name, &current);
            assert!(results.len() >= 4, "{kind} {name}: {results:?}");
            let track = columns(&dir.path().join(format!("{kind}_{name}.csv")));
            assert!(
                (last(&track, "t_s") - results["duration"]).abs() < 0.01,
                "{kind} {name}"
            );
            assert_eq!((track["x_m"][0], track["y_m"][0]), (0.0, 0.0));
            let svg =
                std::fs::read_to_string(dir.path().join(format!("{kind}_{name}.svg"))).unwrap();
            assert!(svg.contains("Track") && svg.contains("m/s") && svg.ends_with("</svg>\n"));
        }
    }
}

#[test]
fn manoeuvres_have_the_numbers_of_the_current_and_of_the_published_boat() {
    let dir = tempfile::tempdir().unwrap();
    let drift = manoeuvre(
        &dir,
        "otter",
        "drift",
        &["--current-m-s", "0.5", "--current-toward-deg", "30"],
    );
    assert!(
        (drift["drift speed"] - 0.5).abs() < 0.005 && (drift["drift direction"] - 30.0).abs() < 0.5,
        "{drift:?}"
    );
    let ahead = manoeuvre(
        &dir,
        "surveyor_kinematic",
        "acceleration",
        &["--duration-s", "60"],
    );
    assert!((ahead["steady speed"] - 3.0).abs() < 0.005, "{ahead:?}");
}

#[test]
fn turns_to_both_sides_are_mirror_images() {
    let dir = tempfile::tempdir().unwrap();
    let starboard = manoeuvre(&dir, "surveyor_m1_8", "turning_circle", &[]);
    let port = manoeuvre(
        &dir,
        "surveyor_m1_8",
        "turning_circle",
        &["--to-port", "--start-heading-deg", "200"],
    );
    for name in [
        "advance at 90°",
        "transfer at 90°",
        "tactical diameter at 180°",
        "steady turning diameter",
        "speed loss",
    ] {
        assert!(
            (starboard[name] - port[name]).abs() < 0.02,
            "{name}: {} and {}",
            starboard[name],
            port[name]
        );
        assert!(starboard[name] > 0.0, "{name}");
    }
}

/// Writes a log of the Surveyor, and a boat file with different initial values.
fn log_and_start(dir: &TempDir) {
    let rows = [
        [90.0, 90.0],
        [60.0, 20.0],
        [20.0, 70.0],
        [-40.0, -40.0],
        [100.0, 40.0],
        [0.0, 0.0],
        [50.0, 80.0],
    ];
    let steps = (0..28).map(|i| {
        [
            6.0 * f64::from(i),
            rows[i as usize % 7][0],
            rows[i as usize % 7][1],
        ]
    });
    write_orders(dir, "t_s,port_pct,starboard_pct", steps);
    trial(
        dir,
        &[
            &boat("surveyor_m1_8"),
            "--orders",
            "in.csv",
            "--csv",
            "log.csv",
            "--with-orders",
        ],
    );
    let start = format!(
        "base = {:?}\n[hull]\nsurge_linear_kg_s = 9\nyaw_linear_kg_m2_s = 24\n",
        boat("surveyor_m1_8")
    );
    std::fs::write(dir.path().join("start.toml"), start).unwrap();
}

#[test]
fn identify_writes_a_boat_that_check_accepts() {
    let dir = tempfile::tempdir().unwrap();
    log_and_start(&dir);
    let args = [
        "identify",
        "start.toml",
        "--log",
        "log.csv",
        "--fit",
        "surge_linear,yaw_linear",
        "--out",
        "new.toml",
    ];
    let output = squall(&dir, &args);
    let said = String::from_utf8(output.stdout).unwrap();
    assert!(
        output.status.success(),
        "{}",
        String::from_utf8_lossy(&output.stderr)
    );
    assert!(
        said.contains("surge_linear") && said.contains('±') && said.contains("R²"),
        "{said}"
    );
    let toml = std::fs::read_to_string(dir.path().join("new.toml")).unwrap();
    assert!(
        toml.starts_with("# Fitted to log.csv") && toml.contains("base = \"start.toml\""),
        "{toml}"
    );
    let number = |key: &str| -> f64 {
        let line = toml.lines().find(|line| line.starts_with(key)).unwrap();
        line.split_whitespace().nth(2).unwrap().parse().unwrap()
    };
    // A noise-free log yields the numbers of the boat that produced it.
    for (key, want) in [("surge_linear_kg_s", 6.0), ("yaw_linear_kg_m2_s", 16.0)] {
        assert!((number(key) - want).abs() < 0.01, "{key} {}", number(key));
    }
    let checked = squall(&dir, &["check", "new.toml"]);
    assert!(
        checked.status.success(),
        "{}",
        String::from_utf8_lossy(&checked.stdout)
    );
    trial(&dir, &["new.toml", "--manoeuvre", "acceleration"]);
}

#[test]
fn gap_names_the_number_that_differs_and_draws_the_spread() {
    let dir = tempfile::tempdir().unwrap();
    log_and_start(&dir);
    let slow = format!(
        "base = {:?}\n[hull]\nsurge_quadratic_kg_m = 20\n",
        boat("surveyor_m1_8")
    );
    std::fs::write(dir.path().join("slow.toml"), slow).unwrap();
    let said = crate::program::printed(
        &dir,
        &["gap", "log.csv", "--boat", "slow.toml", "--runs", "20"],
    );
    let speed = said.lines().find(|line| line.starts_with("  speed"));
    let speed = speed.unwrap_or_else(|| panic!("{said}"));
    assert!(speed.contains(" +0.") && speed.ends_with('*'), "{said}");
    // The log is that of a boat with 13 kg/m.
    let advice = said.lines().find(|line| line.contains("->")).unwrap();
    assert!(
        advice.contains("hull.surge_quadratic_kg_m") && advice.contains("-> 13.0"),
        "{said}"
    );
    let svg = std::fs::read_to_string(dir.path().join("log_gap.svg")).unwrap();
    assert!(svg.contains("sideslip") && svg.contains("97.5 %"));
}
