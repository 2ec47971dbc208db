//! Identification recovers known parameters from noisy data, and detects logs that do not determine
//! them.

use primitives::SimTime;
use primitives::stream::Stream;
use scenario::boat::{Boat, Drive};
use scenario::sea::{Gusts, Sea, Wind};
use std::path::Path;
use trial::identify::{self, Fit, Log, NoFit, Setting};
use trial::{Engine, Orders, Sheet, Start, TrialBoat};

const TICK: SimTime = SimTime(50_000_000);
/// Standard deviation of the noise on each measured column of a trial: x, y, heading, surge, sway,
/// yaw rate.
const NOISE: [f64; 6] = [0.3, 0.3, 1.0, 0.05, 0.05, 0.5];

fn boat() -> Boat {
    let path =
        Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenarios/boats/surveyor_m1_8.toml");
    scenario::load_file(&path).unwrap_or_else(|e| panic!("{e}"))
}

/// The initial guess of the search: 15 to 60 % off in every parameter.
fn wrong(truth: &Boat) -> Boat {
    let mut boat = truth.clone();
    boat.hull.surge_linear_kg_s *= 1.6;
    boat.hull.surge_quadratic_kg_m *= 0.7;
    boat.hull.sway_linear_kg_s *= 1.5;
    boat.hull.yaw_linear_kg_m2_s *= 1.5;
    boat.hull.yaw_quadratic_kg_m2 *= 0.65;
    boat.hull.yaw_lift_kg_m *= 1.5;
    let Drive::Thrusters { thruster, .. } = &mut boat.drive else {
        panic!("it has thrusters")
    };
    thruster.flaws.gain = (1.15, 0.9);
    thruster.lag_s = 0.4;
    boat
}

/// Commands for four minutes, each for a few seconds, with both thrusters equal or different.
fn orders_csv(stream: &mut Stream) -> String {
    let mut text = "t_s,port_pct,starboard_pct\n".to_owned();
    let mut t_s = 0.0;
    while t_s < 240.0 {
        let port = stream.between(-60.0, 100.0);
        let starboard = if stream.between(0.0, 1.0) < 0.4 {
            port
        } else {
            stream.between(-60.0, 100.0)
        };
        text += &format!("{t_s},{port:.2},{starboard:.2}\n");
        t_s += stream.between(3.0, 8.0).round();
    }
    text + "245,0,0\n"
}

/// A log of `boat` under those commands, with `noise` times [`NOISE`], whose correlation from one
/// row to the next is `correlation`.
fn log_csv(
    boat: &Boat,
    orders_csv: &str,
    noise: f64,
    correlation: f64,
    stream: &mut Stream,
) -> String {
    log_in(
        &trial::still_sea(),
        boat,
        orders_csv,
        (noise, correlation),
        stream,
    )
}

/// Like [`log_csv`], but in a sea.
fn log_in(
    sea: &Sea,
    boat: &Boat,
    orders_csv: &str,
    (noise, correlation): (f64, f64),
    stream: &mut Stream,
) -> String {
    let sheet = Sheet::read("orders.csv", orders_csv.as_bytes()).expect("it is CSV");
    let orders = Orders::of_sheet(&sheet, &Engine::new(boat)).expect("it understands them");
    let mut trial_boat = TrialBoat::new(boat, sea, TICK, 1, &Start::default());
    let mut samples =
        trial::replay(&mut trial_boat, &orders, orders.end()).expect("its state stays finite");
    let mut errors = NOISE.map(|sigma| noise * sigma * stream.normal());
    let fresh = (1.0 - correlation * correlation).sqrt();
    for sample in &mut samples {
        for (error, sigma) in errors.iter_mut().zip(NOISE) {
            *error = correlation * *error + fresh * noise * sigma * stream.normal();
        }
        let [x, y, heading, surge, sway, yaw] = errors;
        (sample.at.east, sample.at.north) = (sample.at.east + x, sample.at.north + y);
        sample.psi_rad += heading.to_radians();
        sample.nu = sim::hull::Planar {
            surge: sample.nu.surge + surge,
            sway: sample.nu.sway + sway,
            yaw: sample.nu.yaw + yaw.to_radians(),
        };
    }
    let mut text = vec![];
    trial::write_csv(&samples, true, &mut text).expect("writing to a vector cannot fail");
    String::from_utf8(text).expect("text")
}

fn setting() -> Setting {
    Setting {
        sea: trial::still_sea(),
        seed: 1,
        tick: TICK,
        segment: SimTime::from_s(20.0),
    }
}

fn fitted(start: &Boat, csv: &str, names: &[&str]) -> Result<Fit, NoFit> {
    let sheet = Sheet::read("log.csv", csv.as_bytes()).expect("it is CSV");
    let log = Log::of_sheet(&sheet, start).unwrap_or_else(|e| panic!("{e}"));
    let names: Vec<String> = names.iter().map(|name| (*name).to_owned()).collect();
    identify::fit(
        start,
        &log,
        &setting(),
        &identify::parameters(&names, start)?,
        &|_| {},
    )
}

#[test]
fn known_parameters_come_back_within_their_stated_confidence() {
    let truth = boat();
    let mut all = 0;
    let mut within = 0;
    for seed in 1..=4 {
        let mut stream = Stream::new(seed, "test");
        let orders = orders_csv(&mut stream);
        let fit = fitted(
            &wrong(&truth),
            &log_csv(&truth, &orders, 1.0, 0.0, &mut stream),
            &[],
        )
        .unwrap_or_else(|e| panic!("{e}"));
        assert_eq!(fit.estimates.len(), 9, "seed {seed}");
        for estimate in &fit.estimates {
            let want = estimate.parameter.value(&truth).expect("it has it");
            let off = (estimate.value - want).abs() / estimate.plus_minus;
            let name = estimate.parameter.name;
            assert!(
                estimate.plus_minus < 0.35 * want,
                "seed {seed}: {name} ± {}",
                estimate.plus_minus
            );
            assert!(
                off < 2.0,
                "seed {seed}: {name} {want} is {} ± {}",
                estimate.value,
                estimate.plus_minus
            );
            (all, within) = (all + 1, within + i32::from(off <= 1.0));
        }
        for quality in &fit.qualities {
            assert!(quality.r_squared > 0.6, "seed {seed}: {quality:?}");
        }
        assert!(
            (fit.qualities[3].rms - 0.05).abs() < 0.005,
            "what is left is the noise: {:?}",
            fit.qualities
        );
    }
    // 95 % of 36 is 34; fewer than 31 would occur with a probability of one in a hundred.
    assert!(within >= 31, "{within} of {all} within their 95 %");
}

/// The errors of receivers and compasses last for seconds. Intervals for white noise then contain
/// less than half of the true values.
#[test]
fn intervals_hold_for_errors_that_last() {
    let truth = boat();
    let mut within = 0;
    for seed in 11..=16 {
        let mut stream = Stream::new(seed, "test");
        let orders = orders_csv(&mut stream);
        let csv = log_csv(&truth, &orders, 1.0, 0.95, &mut stream);
        let fit = fitted(&wrong(&truth), &csv, &[]).unwrap_or_else(|e| panic!("{e}"));
        for estimate in &fit.estimates {
            let want = estimate.parameter.value(&truth).expect("it has it");
            within += i32::from((estimate.value - want).abs() <= estimate.plus_minus);
        }
    }
    // 95 % of 54 is 51; fewer than 46 would occur with a probability of one in a hundred.
    assert!(within >= 46, "{within} of 54 within their 95 %");
}

/// A log from water that nobody measured: the fit finds the current and the boat's parameters.
#[test]
fn an_unknown_current_is_found_with_the_boat() {
    let truth = boat();
    let mut sea = trial::still_sea();
    trial::set_mean_current(&mut sea, 0.5, 120.0);
    let mut stream = Stream::new(21, "test");
    let orders = orders_csv(&mut stream);
    let csv = log_in(&sea, &truth, &orders, (1.0, 0.0), &mut stream);
    let of_boat = identify::parameters(&[], &truth).expect("the usual ones");
    let mut names: Vec<&str> = of_boat.iter().map(|parameter| parameter.name).collect();
    names.extend(identify::CURRENT);
    let fit = fitted(&wrong(&truth), &csv, &names).unwrap_or_else(|e| panic!("{e}"));
    let (east, north) = (0.5 * 0.866_025_4, -0.25);
    for estimate in &fit.estimates {
        let name = estimate.parameter.name;
        let want = match name {
            "current_east" => east,
            "current_north" => north,
            _ => estimate.parameter.value(&truth).expect("it has it"),
        };
        let error = (estimate.value - want).abs();
        assert!(
            error < 2.0 * estimate.plus_minus,
            "{name} {want} is {} ± {}",
            estimate.value,
            estimate.plus_minus
        );
    }
    let (speed_m_s, toward_deg) = fit.current().expect("it was fitted");
    assert!((speed_m_s - 0.5).abs() < 0.01 && (toward_deg - 120.0).abs() < 1.0);
    let water = &fit.estimates[of_boat.len()..];
    assert!(
        water[..2].iter().all(|current| current.plus_minus < 0.05),
        "{water:?}"
    );
}

/// One log turns to both sides at one speed, the other drives straight at several.
#[test]
fn two_logs_determine_together_what_neither_does_alone() {
    let truth = boat();
    let logs = [
        "t_s,port_pct,starboard_pct\n0,80,20\n20,20,80\n40,80,20\n60,20,80\n80,20,80\n",
        "t_s,port_pct,starboard_pct\n0,30,30\n30,100,100\n60,60,60\n90,0,0\n120,0,0\n",
    ];
    let logs = logs.map(|orders| {
        let csv = log_csv(&truth, orders, 1.0, 0.0, &mut Stream::new(5, "test"));
        let sheet = Sheet::read("log.csv", csv.as_bytes()).expect("it is CSV");
        Log::of_sheet(&sheet, &truth).unwrap_or_else(|e| panic!("{e}"))
    });
    let names = ["surge_linear", "surge_quadratic", "yaw_quadratic"];
    let names = names.map(str::to_owned);
    let parameters = identify::parameters(&names, &truth).expect("known names");
    let mut start = truth.clone();
    start.hull.surge_linear_kg_s *= 1.5;
    start.hull.surge_quadratic_kg_m *= 0.8;
    start.hull.yaw_quadratic_kg_m2 *= 0.8;
    let fit = |log: &Log| identify::fit(&start, log, &setting(), &parameters, &|_| {});
    let mut both = logs[0].clone();
    both.append(&logs[1], setting().segment);
    let together = fit(&both).unwrap_or_else(|e| panic!("{e}"));
    assert_eq!(together.segments, 4 + 6);
    for estimate in &together.estimates {
        let want = estimate.parameter.value(&truth).expect("it has it");
        let error = (estimate.value - want).abs();
        assert!(error < 2.0 * estimate.plus_minus, "{want}: {estimate:?}");
        assert!(estimate.plus_minus < 0.5 * want, "{want}: {estimate:?}");
    }
    for log in &logs {
        let is_worse = fit(log).map_or(true, |fit| {
            let mut pairs = fit.estimates.iter().zip(&together.estimates);
            pairs.any(|(alone, together)| alone.plus_minus > 2.0 * together.plus_minus)
        });
        assert!(is_worse);
    }
}

#[test]
fn without_noise_they_come_back_to_four_places() {
    let truth = boat();
    let mut stream = Stream::new(9, "test");
    let csv = log_csv(&truth, &orders_csv(&mut stream), 0.0, 0.0, &mut stream);
    let fit = fitted(&wrong(&truth), &csv, &[]).unwrap_or_else(|e| panic!("{e}"));
    for estimate in &fit.estimates {
        let want = estimate.parameter.value(&truth).expect("it has it");
        let name = estimate.parameter.name;
        assert!(
            (estimate.value - want).abs() < 1e-4 * want,
            "{name} {want} is {}",
            estimate.value
        );
    }
}

#[test]
fn what_the_log_cannot_tell_is_said() {
    let truth = boat();
    // Straight ahead at one speed, thrust and resistance cannot be separated.
    let straight = "t_s,port_pct,starboard_pct\n0,60,60\n120,60,60\n";
    let csv = log_csv(&truth, straight, 1.0, 0.0, &mut Stream::new(1, "test"));
    let fit = fitted(
        &truth,
        &csv,
        &["surge_linear", "surge_quadratic", "yaw_linear"],
    )
    .unwrap_or_else(|e| panic!("{e}"));
    let pair = ["surge_linear", "surge_quadratic"];
    assert!(
        fit.confused.iter().any(|confused| confused.names == pair),
        "{:?}",
        fit.confused
    );
    let yaw = fit
        .estimates
        .iter()
        .find(|estimate| estimate.parameter.name == "yaw_linear")
        .expect("it was fitted");
    assert!(yaw.plus_minus > 0.5 * yaw.value, "nothing turned: {yaw:?}");
    assert!(matches!(fitted(&truth, &csv, &["keel"]), Err(NoFit::Unknown(name)) if name == "keel"));
}

#[test]
fn a_log_that_lacks_columns_is_refused() {
    let rows = |row: &str| (0..30).map(|i| format!("{i},{row}\n")).collect::<String>();
    for (head, row, want) in [
        (
            "t_s,port_pct,starboard_pct",
            "0,0",
            "log.csv:1: missing column heading_deg",
        ),
        (
            "t_s,heading_deg,surge_m_s,yaw_rate_deg_s",
            "0,0,0",
            "log.csv:1: no command columns",
        ),
        (
            "t_s,port_pct,starboard_pct,heading_deg,surge_m_s,yaw_rate_deg_s,x_m",
            "0,0,0,0,0,0",
            "one of the columns x_m",
        ),
        (
            "t_s,port_pct,starboard_pct,heading_deg,surge_m_s,yaw_rate_deg_s",
            "0,0,0,fast,0",
            "log.csv:2: surge_m_s is fast",
        ),
    ] {
        let sheet =
            Sheet::read("log.csv", format!("{head}\n{}", rows(row)).as_bytes()).expect("it is CSV");
        let error = Log::of_sheet(&sheet, &boat()).expect_err(head).to_string();
        assert!(error.contains(want), "{error}");
    }
}

/// A boat in 7 m/s of wind from 230°, the search for it and for the drag, and its result.
fn found_in_wind(orders: &str) -> Result<Fit, NoFit> {
    let truth = boat();
    let wind = Wind {
        speed_10m_m_s: 7.0,
        from_rad: 230.0_f64.to_radians(),
        profile_exponent: 0.12,
        gusts: Gusts::None,
    };
    let sea = Sea {
        wind: Some(wind),
        ..trial::still_sea()
    };
    let csv = log_in(
        &sea,
        &truth,
        orders,
        (1.0, 0.0),
        &mut Stream::new(1, "wind"),
    );
    let sheet = Sheet::read("log.csv", csv.as_bytes()).expect("it is CSV");
    let log = Log::of_sheet(&sheet, &truth).unwrap_or_else(|e| panic!("{e}"));
    let start = Boat {
        hull: scenario::boat::Hull {
            surge_quadratic_kg_m: 0.7 * truth.hull.surge_quadratic_kg_m,
            ..truth.hull.clone()
        },
        ..truth
    };
    let names = ["surge_quadratic", identify::WIND[0], identify::WIND[1]];
    let parameters = identify::parameters(&names.map(str::to_owned), &start)?;
    identify::fit(&start, &log, &setting(), &parameters, &|_| {})
}

#[test]
fn a_wind_comes_back_unless_the_log_leaves_several() {
    let fit = found_in_wind(&orders_csv(&mut Stream::new(1, "test")));
    let fit = fit.unwrap_or_else(|e| panic!("{e}"));
    let (speed_m_s, from_deg) = fit.wind().expect("it was fitted");
    assert!((speed_m_s - 7.0).abs() < 0.1, "{speed_m_s}");
    assert!((from_deg - 230.0).abs() < 1.0, "{from_deg}");
    let drag = fit.estimates[0];
    assert!(
        (drag.value - 13.0).abs() < 2.0 * drag.plus_minus,
        "{drag:?}"
    );

    // Straight ahead at one speed, less drag and more wind are the same.
    let text = found_in_wind("t_s,port_pct,starboard_pct\n0,60,60\n80,60,60\n");
    let text = text.expect_err("it is ambiguous").to_string();
    assert!(text.contains("the log does not determine"), "{text}");
}

/// For twelve seconds in the middle, the commands and the boat's motion are unknown.
#[test]
fn what_happens_in_a_gap_of_the_log_is_not_guessed() {
    let mut truth = boat();
    let Drive::Thrusters { thruster, .. } = &mut truth.drive else {
        panic!("it has thrusters")
    };
    // The state of the thrusters after the gap is unknown, so make it irrelevant.
    (thruster.slew_per_s, thruster.lag_s) = (10.0, 0.05);
    let csv = log_csv(
        &truth,
        &orders_csv(&mut Stream::new(3, "test")),
        1.0,
        0.0,
        &mut Stream::new(3, "noise"),
    );
    let is_known = |line: &&str| {
        let at_s = line
            .split(',')
            .next()
            .and_then(|cell| cell.parse::<f64>().ok());
        at_s.is_none_or(|at_s| !(83.0..95.0).contains(&at_s))
    };
    let with_gap: Vec<&str> = csv.lines().filter(is_known).collect();
    let names = ["surge_quadratic", "yaw_quadratic"];
    let whole = fitted(&truth, &csv, &names).unwrap_or_else(|e| panic!("{e}"));
    let parts = fitted(&truth, &with_gap.join("\n"), &names).unwrap_or_else(|e| panic!("{e}"));
    // A segment begins after the gap, so only the noise is left.
    for (whole, parts) in whole.qualities.iter().zip(&parts.qualities) {
        assert!(parts.rms < 1.1 * whole.rms, "{whole:?}, {parts:?}");
    }
}
