//! Logs written by other programs: the recorder of `rosbags`, the writer of `mcap` (Python),
//! `pymavlink`, and the firmware ArduPilot Rover. In all except the firmware's, one boat turns to
//! starboard on a circle with a radius of 40 m, at 2 m/s. It starts with a heading of north at
//! 2026-05-01 12:00 UTC and drives for 20 s.

use import::{Format, Imported, Input, Map, Quantity};
use primitives::LatLon;
use primitives::math::sin_cos;
use recording::Recording;
use std::path::{Path, PathBuf};

const START_S: f64 = 1_777_636_800.0;
const RADIUS_M: f64 = 40.0;
const SPEED_M_S: f64 = 2.0;

fn log(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("tests/logs")
        .join(name)
}

fn input(path: PathBuf, boat: Option<&str>) -> Input {
    let boat = boat.map(str::to_owned);
    Input { path, boat }
}

fn read(name: &str) -> Imported {
    import::read(&[input(log(name), None)], None, None).unwrap_or_else(|e| panic!("{e}"))
}

fn read_text(name: &str, text: &str, map: Option<&str>) -> Result<Imported, String> {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join(name);
    std::fs::write(&path, text).expect("it is written");
    let map = map.map(|map| map.parse::<Map>().expect("a map"));
    let read = import::read(&[input(path, None)], map.as_ref(), None);
    read.map_err(|error| error.to_string())
}

/// Asserts that a value is close to the expected one.
#[track_caller]
fn near(found: Option<f64>, wanted: f64, tolerance: f64, what: &str) {
    let found = found.unwrap_or_else(|| panic!("{what} is missing"));
    assert!(
        (found - wanted).abs() <= tolerance,
        "{what}: {found}, expected {wanted}"
    );
}

/// Asserts that a boat drives on the circle; `place_m` is the resolution of its positions.
#[track_caller]
fn assert_circle(imported: &Imported, boat: &str, place_m: f64, velocity_m_s: f64) {
    let logs = &imported.logs;
    assert_eq!(logs.boats(), [boat]);
    for (at_s, x) in logs.series(boat, Quantity::X).expect("a track") {
        let turned_rad = SPEED_M_S / RADIUS_M * (at_s - START_S);
        let (sin, cos) = sin_cos(turned_rad);
        let value = |quantity| logs.at(boat, quantity, *at_s);
        near(Some(*x), RADIUS_M * (1.0 - cos), place_m, "x");
        near(value(Quantity::Y), RADIUS_M * sin, place_m, "y");
        near(
            value(Quantity::Heading),
            turned_rad.to_degrees(),
            0.02,
            "heading",
        );
        near(value(Quantity::Surge), SPEED_M_S, velocity_m_s, "surge");
    }
}

#[test]
fn a_bag_of_ros_2_in_either_compression_is_read() {
    for name in ["circle_zstd.mcap", "circle_lz4.mcap"] {
        let imported = read(name);
        assert_eq!(imported.formats, [Format::Mcap]);
        assert_circle(&imported, "wamv", 0.002, 1e-9);
        assert_motion_and_thrust(&imported);
    }
}

#[test]
fn a_bag_of_ros_1_in_either_compression_is_read() {
    for name in ["circle_bz2.bag", "circle_lz4.bag"] {
        let imported = read(name);
        assert_eq!(imported.formats, [Format::Bag1]);
        assert_circle(&imported, "wamv", 0.002, 1e-9);
        assert_motion_and_thrust(&imported);
    }
}

/// Checks measurements that only the bags contain. In bags, y velocity is to port and yaw is
/// anticlockwise.
#[track_caller]
fn assert_motion_and_thrust(imported: &Imported) {
    let at = |quantity| imported.logs.at("wamv", quantity, START_S + 7.0);
    near(at(Quantity::Sway), 0.25, 1e-9, "sway");
    let turn_deg_s = (SPEED_M_S / RADIUS_M).to_degrees();
    near(at(Quantity::YawRate), turn_deg_s, 1e-6, "yaw rate");
    near(at(Quantity::Port), 50.0, 1e-9, "port");
    near(at(Quantity::Starboard), 25.0, 1e-9, "starboard");
}

#[test]
fn a_telemetry_log_is_read_with_the_functions_and_limits_of_its_servos() {
    let imported = read("circle.tlog");
    assert_eq!(imported.formats, [Format::Tlog]);
    assert_circle(&imported, "boat_7", 0.02, 0.01);
    let at = |quantity| imported.logs.at("boat_7", quantity, START_S + 7.0);
    // Output 3 is the left thruster, which is reversed, at 50 %; output 1 is the right one at 25 %.
    near(at(Quantity::Port), 50.0, 1e-9, "port");
    near(at(Quantity::Starboard), 25.0, 1e-9, "starboard");
    let named = import::read(&[input(log("circle.tlog"), Some("blue_one"))], None, None);
    assert_eq!(named.expect("a log").logs.boats(), ["blue_one"]);
}

#[test]
fn sentences_are_timed_by_their_receiver_or_by_themselves() {
    let text = std::fs::read_to_string(log("circle.nmea")).expect("a log");
    let imported = read("circle.nmea");
    assert_eq!(imported.formats, [Format::Nmea]);
    assert_circle(&imported, "circle", 0.002, 0.001);
    let at = |imported: &Imported, quantity| imported.logs.at("circle", quantity, START_S + 7.0);
    near(at(&imported, Quantity::Port), 50.0, 1e-9, "port");
    near(at(&imported, Quantity::Starboard), 30.0, 1e-9, "starboard");
    // Four sentences a second, received with a delay of 0.25 s, with the time in three formats.
    let received = |stamp: fn(usize) -> String| {
        let lines = text.lines().enumerate();
        lines
            .map(|(i, line)| format!("{}{line}\n", stamp(i / 4)))
            .collect::<String>()
    };
    for received in [
        received(|i| format!("{:.2} ", START_S + i as f64 + 0.25)),
        received(|i| format!("[{}] ", (START_S as u64 + i as u64) * 1000 + 250)),
        received(|i| format!("2026-05-01T12:00:{i:02}.25Z,")),
    ] {
        let imported = read_text("circle.txt", &received, None).unwrap_or_else(|e| panic!("{e}"));
        let first = imported
            .logs
            .series("circle", Quantity::X)
            .expect("a track")[0];
        assert_eq!(first.0, START_S + 0.25, "{}", &received[..40]);
    }
    // A log across midnight that includes a sentence with a wrong checksum.
    let night = "$GPGGA,235959.00,4221.5,N,07105.2,W,4,12,0.7,1.0,M,-33.0,M,,*53\n\
                 $GPGGA,000001.00,4221.5,N,07105.2,W,4,12,0.7,1.0,M,-33.0,M,,*53\n\
                 $GPGGA,000002.00,4221.5,N,07105.2,W,4,12,0.7,1.0,M,-33.0,M,,*50\n\
                 $GPGGA,000003.00,4221.5,N,07105.2,W,4,12,0.7,1.0,M,-33.0,M,,*00\n";
    let imported = read_text("night.nmea", night, None).expect("a log");
    let track = imported.logs.series("night", Quantity::X).expect("a track");
    assert_eq!(track.last().expect("positions").0 - track[0].0, 3.0);
    assert!(
        imported.notes[0].contains("1 sentences rejected"),
        "{:?}",
        imported.notes
    );
}

/// Expects the last message of each kind to have the values that pymavlink's `DFReader` reads.
#[test]
fn a_log_of_the_real_firmware_is_read() {
    let imported = read("rover.bin");
    assert_eq!(
        (imported.formats[0], imported.notes.len()),
        (Format::Dataflash, 0)
    );
    let logs = &imported.logs;
    let last = |quantity| {
        *logs
            .series("rover", quantity)
            .and_then(|all| all.last())
            .expect("values")
    };
    let near_at = |quantity, at_s: f64, wanted, what| {
        near(Some(last(quantity).0), at_s, 1e-3, what);
        near(Some(last(quantity).1), wanted, 1e-4, what);
    };
    near_at(
        Quantity::Heading,
        1_795_826_112.700_2,
        227.650_65,
        "heading",
    );
    near_at(Quantity::North, 1_795_826_112.700_2, -0.866_181_6, "north");
    near_at(Quantity::East, 1_795_826_112.700_2, -1.082_077_7, "east");
    near_at(
        Quantity::YawRate,
        1_795_826_112.700_2,
        -5.358_910,
        "yaw rate",
    );
    near_at(Quantity::Port, 1_795_826_112.760_2, 19.0, "port");
    near_at(Quantity::Starboard, 1_795_826_112.760_2, 55.6, "starboard");
    // The position estimated by the filter, north and east of its origin.
    let datum = logs.datum.expect("a datum");
    let moved = [Quantity::X, Quantity::Y].map(last);
    let metres_per_deg = 111_073.0;
    let lat_deg = datum.lat_deg + moved[1].1 / metres_per_deg;
    near(Some(lat_deg), 41.355_109_2, 1e-7, "latitude");
}

#[test]
fn tables_of_loggers_are_read_by_the_names_and_units_of_their_columns() {
    let mapped = "epoch_ms;Lat;Long;SOG;COG;HDT\n\
                  1777636800000;42,3584;-71,0874;3,888;0;0\n\
                  1777636801000;42,35841800;-71,0874;3,888;0;0\n\
                  1777636802000;42,35843600;-71,0874;3,888;0;350\n";
    let map = "t=epoch_ms,speed=SOG:kn,heading=HDT:deg";
    let imported = read_text("track.csv", mapped, Some(map)).unwrap_or_else(|e| panic!("{e}"));
    let at = |quantity, s| imported.logs.at("track", quantity, START_S + s);
    near(at(Quantity::Y, 2.0), 4.0, 0.01, "north");
    near(at(Quantity::Surge, 1.0), 2.0, 0.001, "surge");
    // The heading is interpolated through north, not back through south.
    near(at(Quantity::Heading, 1.5), -5.0, 1e-9, "heading");
    let named = "timestamp,boat,x_m,y_m,yaw_rad,speed_kn\n\
                 2026-05-01 12:00:00,Blue One,0,0,1.5707963,1\n\
                 2026-05-01 12:00:00,Red,9,9,0,1\n\
                 2026-05-01 12:00:01,Blue One,1,0,1.5707963,N/A\n";
    let imported = read_text("track.csv", named, None).unwrap_or_else(|e| panic!("{e}"));
    assert_eq!(imported.logs.boats(), ["blue_one", "red"]);
    let at = |quantity| imported.logs.at("blue_one", quantity, START_S + 1.0);
    near(at(Quantity::Heading), 90.0, 1e-4, "heading");
    near(at(Quantity::Speed), 1852.0 / 3600.0, 1e-9, "speed");
}

#[test]
fn errors_name_file_place_and_what_is_possible() {
    for (text, map, want) in [
        (
            "a,b\n1,2\n",
            None,
            ":1: no time column; name one with --map t=COLUMN; columns found: a, b",
        ),
        (
            "t,x,y\nnoon,1,2\n",
            None,
            ":2: t is \"noon\", expected a number, or a date and time",
        ),
        ("t,x,y\n1,east,2\n", None, ":2: x is east, expected"),
        (
            "t,x,y\n1,1,2\n",
            Some("speed=SOG"),
            ":1: no column \"SOG\" for speed; columns found: t, x, y",
        ),
        ("t,heading\n1,2\n", None, "no boat positions found"),
        ("", None, "the file is empty"),
        ("SQLite format 3\0", None, "rosbags-convert"),
    ] {
        let error = read_text("log", text, map).expect_err("it is wrong");
        assert!(error.contains(want), "{error:?} lacks {want:?}");
    }
    for (map, want) in [
        (
            "velocity=SOG",
            "unknown meaning \"velocity\"; expected t, boat, lat",
        ),
        ("speed=SOG:mph", "unknown unit \"mph\"; expected s, ms"),
        ("SOG", "expected MEANING=COLUMN"),
    ] {
        let error = map.parse::<Map>().expect_err("it is wrong");
        assert!(error.contains(want), "{error:?} lacks {want:?}");
    }
}

#[test]
fn logs_of_several_boats_become_one_game_that_can_be_read_again() {
    let inputs = [
        input(log("circle.tlog"), Some("red_one")),
        input(log("circle.nmea"), Some("blue_one")),
    ];
    let datum = LatLon {
        lat_deg: 42.3584,
        lon_deg: -71.0880,
    };
    let imported = import::read(&inputs, None, Some(datum)).unwrap_or_else(|e| panic!("{e}"));
    let game =
        Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenarios/games/pav01_vs_pav01.toml");
    let game = scenario::load(&game).unwrap_or_else(|e| panic!("{e}"));
    let bytes = imported.logs.recording(game, false).expect("one game");
    let recording = Recording::of(bytes.clone()).expect("a recording");
    assert_eq!(
        recording.header().began_utc_ns,
        START_S as u64 * 1_000_000_000
    );
    let frame = recording.frames().nth(70).expect("20 s").expect("sound");
    for boat in &frame.vehicles {
        // The circle starts 49.45 m east of the datum. After 7 s, the boat is 2.43 m further east.
        near(Some(boat.nav.east_m), 49.45 + 2.43, 0.1, "east");
        near(Some(boat.nav.surge_m_s), 2.0, 0.01, "surge");
    }
    let names: Vec<&str> = recording
        .scenario()
        .vehicles
        .iter()
        .map(|vehicle| vehicle.name.as_str())
        .collect();
    assert_eq!(names, ["blue_one", "red_one"]);
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("game.mcap");
    std::fs::write(&path, bytes).expect("it is written");
    let again = import::read(&[input(path, None)], None, None).unwrap_or_else(|e| panic!("{e}"));
    assert_eq!(again.formats, [Format::Squall]);
    for boat in ["blue_one", "red_one"] {
        for quantity in [Quantity::X, Quantity::Heading, Quantity::Port] {
            let before = imported.logs.newest(boat, quantity, START_S + 7.0);
            let now = again.logs.newest(boat, quantity, 7.0);
            near(now, before.expect("a value"), 0.1, boat);
        }
    }
    let table = import::table(&again.logs, "red_one");
    let mut lines = table.lines();
    let heads = "t_s,x_m,y_m,heading_deg,surge_m_s,sway_m_s,yaw_rate_deg_s,port_pct,starboard_pct";
    assert_eq!(lines.next(), Some(heads));
    assert_eq!(lines.count(), 201);
}

#[test]
fn damaged_logs_end_early_or_are_refused_and_do_no_harm() {
    let folder = tempfile::tempdir().expect("a folder");
    for name in [
        "circle_zstd.mcap",
        "circle_bz2.bag",
        "circle.tlog",
        "circle.nmea",
        "rover.bin",
    ] {
        let whole = std::fs::read(log(name)).expect("a log");
        for part in 1..24 {
            let mut bytes = whole[..whole.len() * part / 24].to_vec();
            if part % 2 == 0 {
                let middle = bytes.len() / 2;
                bytes[middle] ^= 0x55;
            }
            let path = folder.path().join(name);
            std::fs::write(&path, bytes).expect("it is written");
            match import::read(&[input(path, None)], None, None) {
                Ok(imported) => assert!(!imported.logs.boats().is_empty()),
                Err(error) => assert!(error.to_string().contains(name), "{error}"),
            }
        }
    }
}
