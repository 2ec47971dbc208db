//! A boat compared with runs of its own model lies anywhere in their spread. A different boat does
//! not, and the comparison names the number that differs.

use primitives::SimTime;
use primitives::stream::Stream;
use scenario::Boat;
use std::fmt::Write;
use std::path::Path;
use trial::identify::{Change, Frames, Log, Setting, changes};
use trial::{Command, Sheet, Start, TrialBoat};

fn load<T: scenario::ScenarioFile>(path: &str) -> T {
    let scenarios = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenarios");
    scenario::load_file(&scenarios.join(path)).unwrap_or_else(|e| panic!("{e}"))
}

fn setting(sea: &str, seed: u64) -> Setting {
    Setting {
        sea: load(&format!("seas/{sea}.toml")),
        seed,
        tick: SimTime::from_s(0.05),
        segment: SimTime::from_s(20.0),
    }
}

/// Three minutes of this boat, as its sensors see them every 0.2 s.
fn log(boat: &Boat, setting: &Setting) -> Log {
    let mut stream = Stream::new(setting.seed, "commands");
    let mut trial_boat = TrialBoat::new(
        boat,
        &setting.sea,
        setting.tick,
        setting.seed,
        &Start::default(),
    );
    let mut text =
        "t_s,x_m,y_m,heading_deg,surge_m_s,sway_m_s,yaw_rate_deg_s,port_pct,starboard_pct\n"
            .to_owned();
    let mut thrusts = [0.0; 2];
    for tick in 0..3600 {
        if tick % 100 == 0 {
            thrusts = [stream.between(-0.3, 1.0), stream.between(-0.3, 1.0)];
        }
        let [port, starboard] = thrusts;
        if tick % 4 == 0 && tick > 0 {
            let nav = trial_boat.reading().expect("it has sensors");
            let _ = writeln!(
                text,
                "{:.3},{},{},{},{},{},{},{},{}",
                trial_boat.now().as_s(),
                nav.east_m,
                nav.north_m,
                nav.psi_rad.to_degrees(),
                nav.surge_m_s,
                nav.sway_m_s,
                nav.yaw_rate_rad_s.to_degrees(),
                100.0 * port,
                100.0 * starboard
            );
        }
        trial_boat.step(Command::Thrust { port, starboard });
    }
    let sheet = Sheet::read("log.csv", text.as_bytes()).expect("it is CSV");
    Log::of_sheet(&sheet, boat).unwrap_or_else(|e| panic!("{e}"))
}

#[test]
fn a_sound_model_puts_the_boat_evenly_within_the_spread() {
    let boat: Boat = load("boats/surveyor_afloat.toml");
    let mut inside = vec![];
    let mut ranks = vec![];
    for seed in 1001..=1008 {
        let log = log(&boat, &setting("moderate_breeze", seed));
        let of = |seed| setting("moderate_breeze", seed);
        let frames = Frames::new(&log, &of(1)).expect("it has segments");
        let runs = (1..=60).map(|seed| frames.run(&boat, &of(seed)));
        let runs: Vec<_> = runs.map(|run| run.expect("it is sound")).collect();
        let gap = frames.compare(&runs);
        let names: Vec<&str> = gap.places.iter().map(|place| place.name.as_str()).collect();
        assert_eq!(names[..3], ["speed", "yaw rate", "sideslip"], "{names:?}");
        inside.push(
            gap.places
                .iter()
                .map(|place| place.inside)
                .collect::<Vec<_>>(),
        );
        ranks.push(
            gap.places
                .iter()
                .map(|place| place.rank)
                .collect::<Vec<_>>(),
        );
    }
    for quantity in 0..6 {
        let mean =
            |all: &[Vec<f64>]| all.iter().map(|of| of[quantity]).sum::<f64>() / all.len() as f64;
        let (inside, rank) = (mean(&inside), mean(&ranks));
        // Expected: 95 % and one half, apart from chance over eight logs of nine segments.
        assert!((0.88..=0.99).contains(&inside), "{quantity}: {inside}");
        assert!((0.4..=0.6).contains(&rank), "{quantity}: {rank}");
    }
}

#[test]
fn the_number_that_differs_is_named() {
    let model: Boat = load("boats/surveyor_afloat.toml");
    let mut real = model.clone();
    real.hull.surge_quadratic_kg_m = 1.4 * model.hull.surge_quadratic_kg_m;
    let calm = setting("calm", 1);
    let log = log(&real, &calm);
    let frames = Frames::new(&log, &calm).expect("it has segments");
    let runs: Vec<_> = (1..=30)
        .filter_map(|seed| frames.run(&model, &setting("calm", seed)))
        .collect();
    let gap = frames.compare(&runs);
    let speed = &gap.places[0];
    assert!(speed.off + speed.plus_minus < 0.0, "{speed:?}");
    assert!(speed.inside < 0.6 && speed.rank < 0.3, "{speed:?}");

    let changes = changes(&model, &log, &calm).expect("it can be fitted");
    let Change { estimate, explains } = changes[0];
    assert_eq!(estimate.parameter.name, "surge_quadratic");
    let off = (estimate.value - real.hull.surge_quadratic_kg_m).abs();
    assert!(off < 2.0 * estimate.plus_minus, "{estimate:?}");
    assert!((0.05..0.9).contains(&explains), "{explains}");
}
