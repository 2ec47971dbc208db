//! Sentences that fit are read back to their printed resolution; sentences that do not fit are
//! never read as something else.

use crate::bodies;
use crate::sentences::{Domain, boat_sentences, on_the_globe, sentences, values};
use gateway::nmea::{Command, EMITTED_MAX, Mode, ParseError, Sentence};
use primitives::LatLon;
use proptest::prelude::*;
use proptest::sample::select;

/// Half of the last digit of a position, degrees.
const FIVE_DECIMALS_DEG: f64 = 0.000_005_01 / 60.0;
const FOUR_DECIMALS_DEG: f64 = 0.000_050_1 / 60.0;

/// Half of the last digit of a number, plus rounding error.
const WHOLE: f64 = 0.5 + 1e-9;
const TENTH: f64 = 0.05 + 1e-9;
const HUNDREDTH: f64 = 0.005 + 1e-9;
const THOUSANDTH: f64 = 0.0005 + 1e-9;

/// The tolerance of a number after a round trip, and whether it is an angle, which may differ by a
/// full turn. All other fields must be identical.
fn tolerance(sentence: &Sentence, field: &str) -> Option<(f64, bool)> {
    let mode = match sentence {
        Sentence::Command(command) => Some(command.mode),
        Sentence::ControlState(state) => Some(state.mode),
        _ => None,
    };
    Some(match (field, sentence) {
        ("lat_deg" | "lon_deg", Sentence::Waypoint(_)) => (FOUR_DECIMALS_DEG, false),
        ("lat_deg" | "lon_deg", _) => (FIVE_DECIMALS_DEG, false),
        // This field holds the number of lines of a file.
        ("heading_deg", Sentence::Command(_)) if mode == Some(Mode::FileDownload) => (WHOLE, false),
        ("heading_deg", Sentence::Command(_)) if mode == Some(Mode::Thruster) => (WHOLE, true),
        ("heading_deg", _) => (TENTH, true),
        ("course_deg" | "course_true_deg" | "course_magnetic_deg", _) => (TENTH, true),
        ("thrust", _) if mode == Some(Mode::Speed) => (THOUSANDTH, false),
        // The difference is reduced by one if rounding would take the sum above 100 %.
        ("difference", Sentence::Command(_)) => (1.0, false),
        ("thrust" | "difference" | "charge" | "charge_used" | "hours" | "throttle_pct", _) => {
            (WHOLE, false)
        }
        ("accel_ahead_g" | "accel_starboard_g" | "accel_down_g" | "yaw_rate_deg_s", _) => {
            (HUNDREDTH, false)
        }
        ("hdop" | "speed_kn" | "speed_km_h", _) => (HUNDREDTH, false),
        (
            "pitch_deg" | "roll_deg" | "box_c" | "altitude_m" | "geoid_m" | "deviation_deg"
            | "variation_deg",
            _,
        ) => (TENTH, false),
        (volts_or_amps, Sentence::Battery(_)) if volts_or_amps.ends_with("volts") => (TENTH, false),
        (volts_or_amps, Sentence::Battery(_)) if volts_or_amps.ends_with("amps") => (TENTH, false),
        ("celsius", _) => (TENTH, false),
        _ => return None,
    })
}

/// Whether a sentence came back unchanged, within half of its last digits.
fn same(sentence: &Sentence, back: &Sentence) -> bool {
    let mut sentence = sentence.clone();
    if let Sentence::Command(
        command @ Command {
            mode: Mode::FileDownload,
            ..
        },
    ) = &mut sentence
    {
        // An empty field means no lines.
        for number in [
            &mut command.heading_deg,
            &mut command.thrust,
            &mut command.difference,
        ] {
            number.get_or_insert(0.0);
        }
    }
    let want = values(&sentence);
    let got = values(back);
    let close = |(field, want): &(String, String), got: &str| match tolerance(&sentence, field) {
        Some((most, is_angle)) if want != "None" && want != "Some" => {
            let want = want.parse::<f64>().unwrap_or(f64::NAN);
            let got = got.parse::<f64>().unwrap_or(f64::NAN);
            let off = if is_angle {
                (want - got + 180.0).rem_euclid(360.0) - 180.0
            } else {
                want - got
            };
            off.abs() <= most
        }
        _ => want == got,
    };
    want.len() == got.len()
        && want
            .iter()
            .zip(&got)
            .all(|(want, (field, got))| want.0 == *field && close(want, got))
}

/// A domain with the same numbers in all fields, and every valid date and time.
fn domain(numbers: impl Strategy<Value = f64> + 'static, texts: BoxedStrategy<String>) -> Domain {
    let numbers = numbers.boxed();
    Domain {
        angles: numbers.clone(),
        sizes: numbers.clone(),
        signed: numbers,
        texts,
        places: on_the_globe(),
        years: 1980..2080,
        day_ms: 0..86_401_000,
    }
}

/// Sentences that fit without omitting a field.
fn tame() -> BoxedStrategy<Sentence> {
    let texts = "[A-Z_]{0,6}".boxed();
    let wide = sentences(&domain(-359.0..359.0, texts.clone()));
    let wide = wide.prop_filter("a battery with such numbers is too long", |s| {
        !matches!(s, Sentence::Battery(_))
    });
    prop_oneof![3 => wide, 1 => boat_sentences(&domain(0.0..9.9, texts))].boxed()
}

/// Sentences with arbitrary values.
fn wild() -> BoxedStrategy<Sentence> {
    let number = prop_oneof![
        proptest::num::f64::ANY,
        -1e9..1e9,
        select(vec![1e300, -1e300, 1e17, f64::NAN])
    ];
    let number = number.boxed();
    let texts = prop_oneof!["\\PC{0,100}", "[ -~\\x00-\\x1f]{0,100}", "[A-Z]{60,90}"].boxed();
    let place =
        (number.clone(), number.clone()).prop_map(|(lat_deg, lon_deg)| LatLon { lat_deg, lon_deg });
    let places = prop_oneof![place, on_the_globe()].boxed();
    sentences(&Domain {
        places,
        day_ms: 0..u32::MAX,
        ..domain(number, texts)
    })
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 1000, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn what_fits_comes_back(sentence in tame()) {
        let line = sentence.line();
        prop_assert!(line.len() <= EMITTED_MAX, "{line}");
        let found = bodies(line.as_bytes());
        prop_assert_eq!(found.len(), 1);
        let back = Sentence::parse(&found[0]);
        prop_assert!(back.is_ok(), "{line}: {back:?}");
        let back = back.unwrap();
        prop_assert!(same(&sentence, &back), "{sentence:?} came back as {back:?}: {line}");
        let second = back.line();
        let third = &back.line()[1..];
        let again = Sentence::parse(&third[..third.len() - 5]);
        prop_assert_eq!(again.map(|again| again.line()), Ok(second), "written again");
    }

    #[test]
    fn what_does_not_fit_is_left_out(sentence in wild()) {
        let line = sentence.line();
        prop_assert!(line.len() <= EMITTED_MAX, "{} bytes: {line}", line.len());
        let found = bodies(line.as_bytes());
        prop_assert_eq!(found.len(), 1, "one sentence: {}", line);
        prop_assert_eq!(&line[1..line.len() - 5], found[0].as_str());
        for field in found[0].split(',').skip(1) {
            prop_assert!(!["nan", "inf"].contains(&field.to_lowercase().trim_matches('-')) || is_text(&sentence));
        }
        match Sentence::parse(&found[0]) {
            Ok(back) => prop_assert_eq!(std::mem::discriminant(&back), std::mem::discriminant(&sentence)),
            // An invalid waypoint and a non-finite throttle must not be readable.
            Err(ParseError::Field { field, .. }) => prop_assert!(
                matches!((&sentence, field), (Sentence::Waypoint(_), 1) | (Sentence::MissionSettings(_), 3)), "{line}"),
            Err(error) => prop_assert!(false, "{line}: {error}"),
        }
    }

    #[test]
    fn what_is_read_can_be_written_and_read_again(body in "(PSEA[ABCDGR]|OIWPL|GP(GGA|RMC|VTG|HDT|HDG|ZDA))(,[TLCGNSEWAVMK]|,[0-9]{0,6}|,-?[0-9]{1,4}\\.[0-9]{1,4}){0,16}") {
        if let Ok(sentence) = Sentence::parse(&body) {
            let line = sentence.line();
            let again = Sentence::parse(&line[1..line.len() - 5]);
            prop_assert!(again.is_ok(), "{body} -> {line}: {again:?}");
            // Derived values (km/h) are stable only after the first round trip.
            let second = again.unwrap().line();
            let body = sentence.line();
            let settled = Sentence::parse(&second[1..second.len() - 5]).map(|settled| settled.line());
            prop_assert_eq!(settled, Ok(second), "{}", body);
        }
    }

    #[test]
    fn no_text_at_all_makes_it_panic(body in "\\PC{0,120}", address in "(PSEA[ABCDGR]|OIWPL|GPGGA|GPRMC|)") {
        let _ = Sentence::parse(&body);
        let _ = Sentence::parse(&format!("{address},{body}"));
    }
}

fn is_text(sentence: &Sentence) -> bool {
    matches!(
        sentence,
        Sentence::BoatError(_)
            | Sentence::Command(_)
            | Sentence::ControlState(_)
            | Sentence::Battery(_)
    )
}
