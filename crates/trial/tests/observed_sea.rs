//! A boat's heights and velocities reveal the sea that moved it.

use primitives::stream::Stream;
use primitives::{Ned, math};
use scenario::sea::{Spreading, Waves};
use sim::sea::WaveField;
use std::f64::consts::TAU;
use trial::{NoSea, ObservedSea, Track};

/// Receiver: period, s, and standard deviation of the noise of heights, m.
const PERIOD_S: f64 = 0.2;
const NOISE_M: f64 = 0.01;

/// Heights, and velocities north and east.
type Motion = [Vec<(f64, f64)>; 3];

/// A log of this length: `at` gives height, velocity north and velocity east.
fn motion(length_s: f64, mut at: impl FnMut(f64) -> [f64; 3]) -> Motion {
    let mut motion = Motion::default();
    for i in 0..(length_s / PERIOD_S) as usize {
        let at_s = i as f64 * PERIOD_S;
        for (series, value) in motion.iter_mut().zip(at(at_s)) {
            series.push((at_s, value));
        }
    }
    motion
}

fn observed([height, north, east]: &Motion) -> Result<ObservedSea, NoSea> {
    ObservedSea::of(&Track {
        height,
        north,
        east,
        thrusts: [&[]; 2],
    })
}

/// A boat that follows the surface of this sea, and drifts with 0.3 m/s to the east.
fn afloat(waves: &Waves, seed: u64) -> Motion {
    let field = WaveField::new(waves, None, seed);
    let mut stream = Stream::new(seed, "noise");
    motion(600.0, |at_s| {
        let mut moved = [
            NOISE_M * stream.normal(),
            0.05 * stream.normal(),
            0.3 + 0.05 * stream.normal(),
        ];
        // The drift is that of the water, which carries the waves too.
        for wave in field.components() {
            let phase = wave.phase_rad - wave.omega_rad_s * at_s;
            let height_m = wave.amplitude_m * math::sin_cos(phase).1;
            let (sin, cos) = math::sin_cos(wave.toward_rad);
            moved[0] += height_m;
            moved[1] += wave.omega_rad_s * height_m * cos;
            moved[2] += wave.omega_rad_s * height_m * sin;
        }
        moved
    })
}

/// The reference is `scipy.signal.welch(height, 5, nperseg=300, detrend="linear")` for this
/// closed form: 4 √m0 over 0.05 to 2 Hz is 0.7071 m, as is 4 √((0.2² + 0.15²) / 2); the peak is at
/// 0.25 Hz.
#[test]
fn two_sines_are_measured_as_scipy_measures_them() {
    let toward = Ned::toward_deg(120.0);
    let motion = motion(600.0, |t_s| {
        let long = 0.2 * math::sin_cos(TAU * 0.25 * t_s).1;
        let short = 0.15 * math::sin_cos(TAU * 0.61 * t_s).0;
        let velocity = toward.scaled(TAU * (0.25 * long + 0.61 * short));
        [long + short, velocity.north, velocity.east]
    });
    let sea = observed(&motion).expect("it has waves");
    // The sines count as separate waves, and the first is 4 × 0.2 / √2 high.
    let [waves, short] = sea.waves[..] else {
        panic!("two peaks: {sea:?}");
    };
    let all_m = math::length(waves.hs_m.value, short.hs_m.value);
    let exact_m = 4.0 * (0.5 * (0.04 + 0.0225_f64)).sqrt();
    assert!((all_m - exact_m).abs() < 0.005, "{all_m}");
    assert!((short.hs_m.value - 0.424).abs() < 0.004, "{short:?}");
    assert!((short.tp_s.value - 1.0 / 0.61).abs() < 0.01, "{short:?}");
    assert!((waves.hs_m.value - 0.566).abs() < 0.006, "{waves:?}");
    assert!((waves.tp_s.value - 4.0).abs() < 0.05, "{waves:?}");
    let from = waves.from_deg.expect("it is determined");
    assert!((from.value - 300.0).abs() < 1.0, "{from:?}");
    assert_eq!(sea.drift, None, "it only swings");
}

#[test]
fn intervals_cover_the_sea_that_the_boat_was_in() {
    let waves = Waves {
        hs_m: 0.4,
        tp_s: 3.0,
        gamma: 3.3,
        from_rad: 225.0_f64.to_radians(),
        spreading: Spreading::CosineSquared,
        components: 256,
        drift_factor: 1.0,
    };
    let mut covered = [0; 4];
    const LOGS: u64 = 50;
    for seed in 1..=LOGS {
        let sea = observed(&afloat(&waves, seed)).unwrap_or_else(|e| panic!("{e}"));
        let [found] = sea.waves[..] else {
            panic!("{seed}: one peak: {sea:?}");
        };
        let drift = sea.drift.expect("it drifts");
        let from = found.from_deg.expect("it is determined");
        let errors = [
            (found.hs_m, 0.4),
            (found.tp_s, 3.0),
            (from, 225.0),
            (drift.speed_m_s, 0.3),
        ];
        for (covered, (found, truth)) in covered.iter_mut().zip(errors) {
            *covered += u32::from((found.value - truth).abs() <= found.plus_minus);
        }
        // The shortest waves count as noise.
        assert!((sea.noise_m / NOISE_M - 1.1).abs() < 0.2, "{}", sea.noise_m);
        assert!((found.hs_m.value / 0.4 - 1.0).abs() < 0.15, "{found:?}");
    }
    // Of 50 intervals of 95 %, fewer than 43 cover the truth once in a thousand times.
    assert!(covered.iter().all(|count| *count >= 43), "{covered:?}");
}

#[test]
fn calm_water_moving_boats_and_short_logs_give_no_waves() {
    let mut stream = Stream::new(1, "calm");
    let mut walk = 0.0;
    let calm = motion(600.0, |_| {
        walk += 0.002 * stream.normal();
        [walk + NOISE_M * stream.normal(), 0.0, 0.0]
    });
    let sea = observed(&calm).unwrap_or_else(|e| panic!("{e}"));
    assert_eq!((sea.waves, sea.drift), (vec![], None));

    let under_way = motion(600.0, |_| [NOISE_M * stream.normal(), 1.5, 0.0]);
    let text = observed(&under_way)
        .expect_err("it is under way")
        .to_string();
    assert!(text.starts_with("the boat moves at 1.5 m/s"), "{text}");

    let none = observed(&Motion::default()).expect_err("there are no heights");
    assert_eq!(none, NoSea::Missing);

    let short = motion(100.0, |_| [0.0; 3]);
    let text = observed(&short).expect_err("it is short").to_string();
    assert!(text.starts_with("500 heights, one every 0.2 s"), "{text}");
}

#[test]
fn a_written_sea_is_a_valid_file() {
    let waves = Waves {
        hs_m: 0.4,
        tp_s: 3.0,
        gamma: 3.3,
        from_rad: 1.0,
        spreading: Spreading::CosineSquared,
        components: 64,
        drift_factor: 1.0,
    };
    let sea = observed(&afloat(&waves, 1)).unwrap_or_else(|e| panic!("{e}"));
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("seen.toml");
    std::fs::write(&file, sea.written("a.txt", Ned::default())).expect("it is written");
    let read = scenario::load_file::<scenario::sea::Sea>(&file).unwrap_or_else(|e| panic!("{e}"));
    let east_m_s = read.current.mean_m_s.east;
    assert!((east_m_s - 0.3).abs() < 0.03, "{east_m_s}");
    let waves = read.waves.expect("it has waves");
    assert!((waves.hs_m - 0.4).abs() < 0.06 && (waves.tp_s - 3.0).abs() < 0.3);
}
