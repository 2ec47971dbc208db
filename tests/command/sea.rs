//! `squall sea` from the command line: the numbers that it prints and the page that it draws.

use crate::program::{printed, scenario};
use roxmltree::Document;
use tempfile::TempDir;

/// The titles of the panels.
const TITLES: [&str; 4] = [
    "Wave spectrum",
    "Surface elevation at the datum",
    "Wind at the datum, 10 m above the water",
    "Track of a drifting boat",
];

/// Runs `squall sea` for the Surveyor in a folder; returns its output and the page.
fn sea(dir: &TempDir, file: &str, more: &[&str]) -> (String, String) {
    let boat = scenario("boats/surveyor_m1_8.toml");
    let text = printed(
        dir,
        &[&["sea", file, "--boat", &boat, "--plot", "page.svg"], more].concat(),
    );
    assert!(text.ends_with("plot: page.svg\n"), "{text}");
    (
        text,
        std::fs::read_to_string(dir.path().join("page.svg")).unwrap(),
    )
}

/// The value after a name in the program's output.
fn value<'a>(text: &'a str, name: &str) -> &'a str {
    let line = text
        .lines()
        .find_map(|line| line.trim_start().strip_prefix(name));
    line.unwrap_or_else(|| panic!("no {name:?} in\n{text}"))
        .trim()
}

/// The numbers in a string, in order.
fn numbers(text: &str) -> Vec<f64> {
    text.split(|c: char| !(c.is_ascii_digit() || c == '.'))
        .filter_map(|word| word.parse().ok())
        .collect()
}

/// Checks that elements are closed in order and that special characters are escaped.
fn assert_well_formed(svg: &str) {
    Document::parse(svg).unwrap_or_else(|error| panic!("{error}: {svg}"));
}

#[test]
fn every_sea_has_its_numbers_and_a_page_of_four_panels() {
    let calm = ["no waves", "no waves", "no wind", "the boat does not drift"];
    // The panels that have no data.
    for (name, absent) in [
        ("fresh_breeze", &[][..]),
        ("bay_gale", &[]),
        ("calm", &calm),
        ("tidal", &calm[..3]),
        ("any", &[]),
    ] {
        let dir = tempfile::tempdir().unwrap();
        let (text, svg) = sea(&dir, &scenario(&format!("seas/{name}.toml")), &[]);
        assert!(
            text.contains(&format!("{name} for the boat surveyor_m1_8\n")),
            "{text}"
        );
        assert_eq!(
            text.contains("randomised by seed 1: sea/wind.speed_m_s = "),
            name == "any",
            "{text}"
        );
        assert_well_formed(&svg);
        for title in TITLES
            .into_iter()
            .chain([format!("{name}: surveyor_m1_8, seed 1").as_str()])
        {
            assert!(
                svg.lines().any(|line| line == title),
                "{name} has no {title:?}"
            );
        }
        assert_eq!(
            svg.lines()
                .filter(|line| calm.contains(line))
                .collect::<Vec<_>>(),
            absent,
            "{name}"
        );
        assert!(!svg.contains("NaN") && !svg.contains("inf"), "{name}");
    }
}

#[test]
fn the_page_is_named_after_the_sea_and_changes_with_the_seed() {
    let dir = tempfile::tempdir().unwrap();
    let file = dir.path().join("own_gale.toml");
    let boat = scenario("boats/otter.toml");
    std::fs::write(&file, format!("base = {:?}\n", scenario("seas/gale.toml"))).unwrap();
    let page = |seed: &str| {
        let text = printed(
            &dir,
            &["sea", "own_gale.toml", "--boat", &boat, "--seed", seed],
        );
        assert!(text.ends_with("plot: own_gale.svg\n"), "{text}");
        std::fs::read_to_string(dir.path().join("own_gale.svg")).unwrap()
    };
    let one = page("1");
    let two = page("2");
    assert_well_formed(&one);
    assert!(one.lines().any(|line| line == "own_gale: otter, seed 1"));
    assert!(one == page("1") && one != two);
}

#[test]
fn the_free_boat_is_that_of_the_trial() {
    for (name, seed) in [("fresh_breeze", "1"), ("bay_gale", "3"), ("tidal", "1")] {
        let dir = tempfile::tempdir().unwrap();
        let file = scenario(&format!("seas/{name}.toml"));
        let boat = scenario("boats/surveyor_m1_8.toml");
        let (text, _) = sea(&dir, &file, &["--seed", seed]);
        let trial = printed(
            &dir,
            &[
                "trial",
                &boat,
                "--manoeuvre",
                "drift",
                "--sea",
                &file,
                "--seed",
                seed,
            ],
        );
        let want = ["drift speed", "drift direction", "mean heading"]
            .map(|name| numbers(value(&trial, name))[0]);
        let got = numbers(value(&text, "free boat, simulated"));
        // Speeds are printed in hundredths, bearings in whole degrees.
        assert!(
            (got[0] - want[0]).abs() < 0.0051,
            "{name}: {got:?}, the trial {want:?}"
        );
        for i in [1, 2] {
            let off_deg = (got[i] - want[i] + 180.0).rem_euclid(360.0) - 180.0;
            assert!(off_deg.abs() < 0.51, "{name}: {got:?}, the trial {want:?}");
        }
    }
}

#[test]
fn in_a_steady_wind_the_free_boat_drifts_as_the_balance_of_forces_says() {
    /// Both values are printed in hundredths.
    const TOLERANCE_M_S: f64 = 0.011;
    for wind_m_s in [5.0, 12.0] {
        let dir = tempfile::tempdir().unwrap();
        let wind = format!("[wind]\nspeed_m_s = {wind_m_s}\nfrom_deg = 225\ngusts = \"none\"\n");
        std::fs::write(dir.path().join("wind.toml"), wind).unwrap();
        let (text, _) = sea(&dir, "wind.toml", &[]);
        let free = numbers(value(&text, "free boat, simulated"));
        let balance_m_s = numbers(value(&text, "wind drift, beam on"))[0];
        assert!(
            (free[0] - balance_m_s).abs() < TOLERANCE_M_S,
            "{wind_m_s}: {text}"
        );
        assert!(
            (free[1] - 45.0).abs() < 2.0,
            "{wind_m_s} m/s from 225°: {text}"
        );
        assert_eq!(value(&text, "waves"), "none");
    }
}

#[test]
fn a_stream_carries_the_free_boat_as_fast_as_it_runs() {
    let dir = tempfile::tempdir().unwrap();
    std::fs::write(
        dir.path().join("stream.toml"),
        "current = { speed_m_s = 0.4, toward_deg = 290 }\n",
    )
    .unwrap();
    let (text, _) = sea(&dir, "stream.toml", &[]);
    for name in ["current at the datum", "free boat, simulated"] {
        assert!(
            value(&text, name).starts_with("0.40 m/s towards 290°"),
            "{text}"
        );
    }
    assert!(
        (numbers(value(&text, "from its start"))[0] - 0.4 * 300.0).abs() < 5.0,
        "{text}"
    );
    let (text, _) = sea(&dir, &scenario("seas/calm.toml"), &[]);
    assert_eq!(value(&text, "free boat, simulated"), "stays");
}

#[test]
fn a_kinematic_boat_stays_in_a_gale_and_the_text_says_why() {
    let dir = tempfile::tempdir().unwrap();
    let boat = scenario("boats/heron_kinematic.toml");
    let text = printed(&dir, &["sea", &scenario("seas/gale.toml"), "--boat", &boat]);
    assert_eq!(value(&text, "free boat, simulated"), "stays");
    assert!(
        text.contains("only the current moves a kinematic boat"),
        "{text}"
    );
}

/// Heights of a receiver with a wave of 0.4 m and 4 s, while it drifts to the north.
#[test]
fn a_log_gives_a_sea_that_is_then_described() {
    let dir = tempfile::tempdir().unwrap();
    let mut log = String::new();
    for i in 0..1500_u32 {
        let at_s = 0.2 * f64::from(i);
        let height_m = 0.2 * primitives::math::sin_cos(std::f64::consts::TAU * at_s / 4.0).0;
        let minutes = 30.0 + 0.1 * at_s / 1852.0;
        let time = format!("12{:02}{:04.1}", (at_s / 60.0) as u32, at_s % 60.0);
        let gga = format!(
            "GPGGA,{time},54{minutes:010.7},N,01010.0,E,4,12,0.8,{:.3},M,40,M,,",
            3.0 + height_m
        );
        let sum = gga.bytes().fold(0, |sum, byte| sum ^ byte);
        log += &format!("${gga}*{sum:02X}\r\n");
    }
    std::fs::write(dir.path().join("buoy.nmea"), log).unwrap();
    let said = printed(&dir, &["sea", "--from", "buoy.nmea", "--plot", "page.svg"]);
    let observed = value(&said, "waves");
    let [hs_m, _, tp_s, ..] = numbers(observed)[..] else {
        panic!("{said}");
    };
    // 4 × 0.2 / √2.
    assert!(
        (hs_m - 0.57).abs() < 0.02 && (tp_s - 4.0).abs() < 0.1,
        "{said}"
    );
    assert!(
        value(&said, "drift").contains("0.10 ± 0.00 m/s towards 0°"),
        "{said}"
    );
    assert!(value(&said, "wind").starts_with("not determined"), "{said}");
    // The log has no motion along the waves.
    assert!(observed.ends_with("from not determined"), "{said}");
    assert!(
        said.contains("buoy_sea for the boat surveyor_m1_8"),
        "{said}"
    );
    assert_eq!(numbers(value(&said, "significant wave height")), [hs_m]);
    let svg = std::fs::read_to_string(dir.path().join("page.svg")).unwrap();
    assert_well_formed(&svg);
    assert!(svg.contains("measured"));
}
