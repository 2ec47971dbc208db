//! `squall trial` from outside: references through its CSV door, mistakes explained.
#![expect(clippy::unwrap_used, reason = "a test that cannot go on has failed")]

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use tempfile::TempDir;

/// Numbers by column.
type Columns = BTreeMap<String, Vec<f64>>;

fn project() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

fn boat(name: &str) -> String {
    project().join(format!("scenarios/boats/{name}.toml")).display().to_string()
}

fn squall(dir: &TempDir, args: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_squall")).current_dir(dir.path()).args(args).output().expect("the program starts")
}

/// Runs a trial that must succeed; what it printed.
fn trial(dir: &TempDir, args: &[&str]) -> String {
    let output = squall(dir, &[&["trial"], args].concat());
    assert!(output.status.success(), "{args:?}: {}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8(output.stdout).unwrap()
}

/// Runs a trial that must be refused; why it was.
fn refusal(dir: &TempDir, args: &[&str]) -> String {
    let output = squall(dir, &[&["trial"], args].concat());
    assert!(!output.status.success(), "{args:?} is accepted");
    let text = String::from_utf8(output.stderr).unwrap();
    assert!(!text.contains("panicked"), "{text}");
    text
}

fn columns(path: &Path) -> Columns {
    let text = std::fs::read_to_string(path).unwrap();
    let mut lines = text.lines();
    let heads: Vec<&str> = lines.next().unwrap().split(',').collect();
    let mut columns: Columns = heads.iter().map(|head| ((*head).to_owned(), vec![])).collect();
    for line in lines {
        for (head, cell) in heads.iter().zip(line.split(',')) {
            columns.get_mut(*head).unwrap().push(cell.parse().unwrap_or(f64::NAN));
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

/// An Otter reference and the track that its commands give through the door.
fn otter(name: &str, more: &[&str]) -> (Columns, Columns) {
    let dir = tempfile::tempdir().unwrap();
    let want = reference(&format!("otter/{name}.csv"));
    let rows = (0..want["t"].len()).map(|i| [want["t"][i], want["n1_cmd"][i], want["n2_cmd"][i]]);
    write_orders(&dir, "t_s,port_rad_s,starboard_rad_s", rows);
    trial(&dir, &[&[&boat("otter"), "--orders", "in.csv", "--csv", "out.csv"], more].concat());
    (want, columns(&dir.path().join("out.csv")))
}

/// The largest distance from the reference over the distance sailed, which counts as a metre at least.
fn position_error(want: &Columns, got: &Columns) -> f64 {
    assert_eq!(want["t"].len(), got["t_s"].len());
    let (mut sailed_m, mut worst) = (0.0, 0.0_f64);
    for i in 0..want["t"].len() {
        assert!((want["t"][i] - got["t_s"][i]).abs() < 1e-9);
        let (x, y) = (want["y_east"][i], want["x_north"][i]);
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
fn the_otter_accelerates_as_the_reference_does() {
    let (want, got) = otter("accel_n80", &[]);
    let error = position_error(&want, &got);
    println!("position within {:.4} %", 100.0 * error);
    assert!(error < 0.005, "position is off by {error}");
    let steady_m_s = 2.0 * 0.01108 * 80.0 * 80.0 / 77.5544;
    assert!((last(&got, "surge_m_s") - steady_m_s).abs() < 0.001 * steady_m_s);
    assert!((last(&got, "port_newton") - 0.01108 * 6400.0).abs() < 1e-6);
}

#[test]
fn the_otter_turns_as_the_reference_does() {
    let (want, got) = otter("turn_80_60", &[]);
    let (u, v, r) = (last(&got, "surge_m_s"), last(&got, "sway_m_s"), last(&got, "yaw_rate_deg_s"));
    let radius_m = u.hypot(v) / r.to_radians();
    println!("{u} m/s, {r} deg/s, {radius_m} m, position within {:.4} %", 100.0 * position_error(&want, &got));
    for (what, got, want) in [("surge", u, 1.400), ("yaw rate", r, 9.375), ("radius", radius_m, 8.57)] {
        assert!((got - want).abs() < 0.01 * want, "{what} {got}, reference {want}");
    }
    assert!(position_error(&want, &got) < 0.01);
}

#[test]
fn the_otter_drifts_in_a_current_as_the_reference_does() {
    let (want, got) = otter("current_drift_0p5_b30", &["--current-m-s", "0.5", "--current-toward-deg", "30"]);
    let error = position_error(&want, &got);
    let psi_deg = last(&got, "heading_deg") - 360.0;
    println!("position within {:.4} %, heading {psi_deg}", 100.0 * error);
    assert!(error < 0.005, "position is off by {error}");
    assert!((psi_deg + 6.22).abs() < 0.05, "heading {psi_deg}");
    for i in 0..want["t"].len() {
        // Over the ground, along the boat's axes.
        assert!((want["u"][i] - got["surge_m_s"][i]).abs() < 2e-3, "row {i}: {} {}", want["u"][i], got["surge_m_s"][i]);
        assert!((want["v"][i] - got["sway_m_s"][i]).abs() < 2e-3, "row {i}: {} {}", want["v"][i], got["sway_m_s"][i]);
    }
}

/// The headings of a zigzag after 40 s, degrees within ±180, and the times at which they pass zero upwards.
fn zigzag(times_s: &[f64], headings_deg: &[f64]) -> (f64, Vec<f64>) {
    let within: Vec<f64> = headings_deg.iter().map(|h| (h + 180.0).rem_euclid(360.0) - 180.0).collect();
    let settled = || (1..times_s.len()).filter(|i| times_s[*i] > 40.0);
    let peak_deg = settled().map(|i| within[i].abs()).fold(0.0, f64::max);
    let rising = settled().filter(|i| within[i - 1] < 0.0 && within[*i] >= 0.0);
    (peak_deg, rising.map(|i| times_s[i] - 0.1 * within[i] / (within[i] - within[i - 1])).collect())
}

#[test]
fn the_otter_zigzags_as_the_reference_does() {
    let (want, got) = otter("zigzag10_n80_d10", &[]);
    let psi_deg: Vec<f64> = want["psi"].iter().map(|psi| psi.to_degrees()).collect();
    let (want_peak_deg, want_s) = zigzag(&want["t"], &psi_deg);
    let (peak_deg, passes_s) = zigzag(&got["t_s"], &got["heading_deg"]);
    let period_s = |passes: &[f64]| (passes[passes.len() - 1] - passes[0]) / (passes.len() - 1) as f64;
    println!("period {} s of {}, peak {peak_deg} of {want_peak_deg}", period_s(&passes_s), period_s(&want_s));
    println!("position within {:.4} %", 100.0 * position_error(&want, &got));
    assert!((period_s(&passes_s) - 8.25).abs() < 0.02 * 8.25, "period {} s", period_s(&passes_s));
    assert!((peak_deg - want_peak_deg).abs() < 0.5, "swings to {peak_deg}, reference {want_peak_deg}");
}

/// A kinematic reference through the door, every row and column within a tolerance of 1e-6. A row of the reference is the
/// state after its command, so the command is given at the time of the row before.
fn kinematic(name: &str, kind: &str, heads: [&str; 2], more: &[&str]) {
    let dir = tempfile::tempdir().unwrap();
    let want = reference(&format!("kinematic/{kind}_{name}.csv"));
    let from = if heads[0] == "thrust" { "t_s,thrust_pct,rudder_pct" } else { "t_s,speed_m_s,heading_deg" };
    let n = want["t"].len();
    write_orders(&dir, from, (1..n).map(|i| [want["t"][i - 1], want[heads[0]][i], want[heads[1]][i]]));
    let end = want["t"][n - 1].to_string();
    let fixed = ["--orders", "in.csv", "--csv", "out.csv", "--duration-s", &end];
    trial(&dir, &[&[boat(&format!("{kind}_kinematic")).as_str()][..], &fixed, more].concat());
    let got = columns(&dir.path().join("out.csv"));
    assert_eq!(got["t_s"].len(), n);
    let mut worst = 0.0_f64;
    for i in 0..n {
        let turned = (got["heading_deg"][i] - want["heading"][i] + 180.0).rem_euclid(360.0) - 180.0;
        let errors = [
            got["x_m"][i] - want["x"][i],
            got["y_m"][i] - want["y"][i],
            got["surge_m_s"][i] - want["speed"][i],
            turned,
        ];
        for (what, error) in ["x", "y", "speed", "heading"].iter().zip(errors) {
            worst = worst.max(error.abs());
            assert!(error.abs() < 1e-6, "{kind} {name}, row {i}: {what} is off by {error}");
        }
    }
    println!("{kind} {name}: within {worst:.2e}");
    assert!(got["port_newton"].iter().all(|newton| newton.is_nan()), "it has no thrusters");
}

const STEERED: [&str; 2] = ["cmd_speed", "target_heading"];

#[test]
fn kinematic_boats_accelerate_as_the_reference_does() {
    kinematic("accel_max", "heron", STEERED, &[]);
    kinematic("accel_max", "surveyor", STEERED, &[]);
}

#[test]
fn kinematic_boats_turn_as_the_reference_does() {
    // The reference's run-up in full, of which its file shows six places: see the test of that below.
    let start = ["--start-surge-m-s", "1.9999443", "--start-thrust-pct", "99.9966940"];
    kinematic("turn90_max", "heron", STEERED, &start);
    kinematic("turn90_max", "surveyor", STEERED, &["--start-surge-m-s", "3"]);
}

#[test]
fn kinematic_boats_take_thrust_and_rudder_as_the_reference_does() {
    let start = ["--start-surge-m-s", "3", "--start-thrust-pct", "100"];
    kinematic("tr_thrust100_rudder50", "surveyor", ["thrust", "rudder"], &start);
}
