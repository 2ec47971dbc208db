//! What is written is read back: to its printed resolution where it fits, and as nothing else where it does not.

use crate::{bodies, written};
use game::LatLon;
use gateway::nmea::{
    Attitude, Battery, BoatError, Command, ControlState, Date, EMITTED_MAX, Gga, Gll, Hdg, Hdt, MissionSettings, Mode,
    Mwv, Operator, ParseError, Rmc, Sentence, SpeedUnit, Talker, TimeOfDay, Vhw, Vtg, Waypoint, WindReference, Zda,
};
use proptest::option;
use proptest::prelude::*;
use proptest::sample::select;

type Numbers = BoxedStrategy<f64>;
type Texts = BoxedStrategy<String>;

/// Half of the last digit of a position, degrees.
const FIVE_DECIMALS_DEG: f64 = 0.000_005_01 / 60.0;
const FOUR_DECIMALS_DEG: f64 = 0.000_050_1 / 60.0;

/// Half of the last digit of numbers, and a little for the arithmetic.
const WHOLE: f64 = 0.5 + 1e-9;
const TENTH: f64 = 0.05 + 1e-9;
const HUNDREDTH: f64 = 0.005 + 1e-9;
const THOUSANDTH: f64 = 0.0005 + 1e-9;

/// By how much a number may differ after a round trip, and whether it is an angle, which may come back a turn away. What
/// is not in here is the same to the bit.
fn tolerance(sentence: &Sentence, field: &str) -> Option<(f64, bool)> {
    let mode = match sentence {
        Sentence::Command(command) => Some(command.mode),
        Sentence::ControlState(state) => Some(state.mode),
        _ => None,
    };
    Some(match (field, sentence) {
        ("lat_deg" | "lon_deg", Sentence::Waypoint(_)) => (FOUR_DECIMALS_DEG, false),
        ("lat_deg" | "lon_deg", _) => (FIVE_DECIMALS_DEG, false),
        // The number of lines of a file is in the heading's place.
        ("heading_deg", Sentence::Command(_)) if mode == Some(Mode::FileDownload) => (WHOLE, false),
        ("heading_deg", Sentence::Command(_)) if mode == Some(Mode::Thruster) => (WHOLE, true),
        ("heading_deg" | "heading_true_deg" | "heading_magnetic_deg", _) => (TENTH, true),
        ("course_deg" | "course_true_deg" | "course_magnetic_deg" | "angle_deg", _) => (TENTH, true),
        ("thrust", _) if mode == Some(Mode::Speed) => (THOUSANDTH, false),
        ("thrust" | "difference" | "charge" | "charge_used" | "hours" | "throttle_pct", _) => (WHOLE, false),
        ("accel_ahead_g" | "accel_starboard_g" | "accel_down_g" | "yaw_rate_deg_s", _) => (HUNDREDTH, false),
        ("hdop" | "speed_kn" | "speed_km_h", _) => (HUNDREDTH, false),
        ("speed_m_s", Sentence::Mwv(wind)) => (TENTH * wind.unit.m_s(), false),
        ("pitch_deg" | "roll_deg" | "box_c" | "altitude_m" | "geoid_m" | "deviation_deg" | "variation_deg", _) => {
            (TENTH, false)
        }
        (volts_or_amps, Sentence::Battery(_)) if volts_or_amps.ends_with("volts") => (TENTH, false),
        (volts_or_amps, Sentence::Battery(_)) if volts_or_amps.ends_with("amps") => (TENTH, false),
        ("celsius", _) => (TENTH, false),
        _ => return None,
    })
}

/// The values of a sentence as `Debug` prints them, each with the name of its field.
fn values(sentence: &Sentence) -> Vec<(String, String)> {
    let text = format!("{sentence:?}");
    let mut field = "";
    let mut values = Vec::new();
    for token in text.split([' ', ',', '(', ')', '{', '}', '[', ']']).filter(|token| !token.is_empty()) {
        match token.strip_suffix(':') {
            Some(name) => field = name,
            None => values.push((field.to_owned(), token.to_owned())),
        }
    }
    values
}

/// Whether a sentence came back as it was, within half of its last digits.
fn same(sentence: &Sentence, back: &Sentence) -> bool {
    let mut sentence = sentence.clone();
    if let Sentence::Command(command @ Command { mode: Mode::FileDownload, .. }) = &mut sentence {
        // Nothing there means no lines.
        for number in [&mut command.heading_deg, &mut command.thrust, &mut command.difference] {
            number.get_or_insert(0.0);
        }
    }
    let (want, got) = (values(&sentence), values(back));
    let close = |(field, want): &(String, String), got: &str| match tolerance(&sentence, field) {
        Some((most, is_angle)) if want != "None" && want != "Some" => {
            let (want, got) = (want.parse::<f64>().unwrap_or(f64::NAN), got.parse::<f64>().unwrap_or(f64::NAN));
            let off = if is_angle { (want - got + 180.0).rem_euclid(360.0) - 180.0 } else { want - got };
            off.abs() <= most
        }
        _ => want == got,
    };
    want.len() == got.len() && want.iter().zip(&got).all(|(want, (field, got))| want.0 == *field && close(want, got))
}

/// Sentences of every kind with numbers, texts and coordinates of some strategy.
fn sentences(numbers: &Numbers, texts: &Texts, places: BoxedStrategy<LatLon>) -> BoxedStrategy<Sentence> {
    let of_the_boat = boat_sentences(numbers, texts, places.clone());
    prop_oneof![of_the_boat, standard_sentences(numbers, places)].boxed()
}

fn boat_sentences(numbers: &Numbers, texts: &Texts, places: BoxedStrategy<LatLon>) -> BoxedStrategy<Sentence> {
    let number = || option::of(numbers.clone());
    let text = || texts.clone();
    let mode = || select(Mode::all().to_vec());
    let command =
        (mode(), number(), number(), number(), text()).prop_map(|(mode, heading_deg, thrust, difference, words)| {
            Sentence::Command(Command { mode, heading_deg, thrust, difference, words })
        });
    let attitude = prop::array::uniform8(number()).prop_map(|[a, b, c, d, e, f, g, h]| {
        Sentence::Attitude(Attitude {
            pitch_deg: a,
            roll_deg: b,
            heading_deg: c,
            heave_m: None,
            box_c: d,
            accel_ahead_g: e,
            accel_starboard_g: f,
            accel_down_g: g,
            yaw_rate_deg_s: h,
        })
    });
    let battery = (prop::array::uniform13(number()), text(), text()).prop_map(|(n, reset_time, reset_date)| {
        Sentence::Battery(Battery {
            volts: n[0],
            charge: n[1],
            amps: n[2],
            celsius: n[3],
            charge_used: n[4],
            reset_time,
            reset_date,
            port_volts: n[5],
            starboard_volts: n[6],
            system_amps: n[7],
            port_amps: n[8],
            starboard_amps: n[9],
            port_bilge_amps: n[10],
            starboard_bilge_amps: n[11],
            hours: n[12],
        })
    });
    let letters = option::of(select(vec!['T', 'F', 'R', 'N', '!', '9']));
    let operators = option::of(any::<u8>().prop_map(Operator::from_number));
    let state = (mode(), number(), number(), number(), text(), letters, option::of(any::<u8>()), operators).prop_map(
        |(mode, heading_deg, thrust, difference, words, transmission, sent_to, operator)| {
            Sentence::ControlState(ControlState {
                mode,
                heading_deg,
                thrust,
                difference,
                words,
                transmission,
                sent_to,
                operator,
            })
        },
    );
    prop_oneof![
        command,
        attitude,
        battery,
        state,
        text().prop_map(|code| Sentence::BoatError(BoatError { code })),
        numbers.clone().prop_map(|throttle_pct| Sentence::MissionSettings(MissionSettings { throttle_pct })),
        (places, any::<u16>()).prop_map(|(at, index)| Sentence::Waypoint(Waypoint { at, index })),
    ]
    .boxed()
}

fn standard_sentences(numbers: &Numbers, places: BoxedStrategy<LatLon>) -> BoxedStrategy<Sentence> {
    let number = || option::of(numbers.clone());
    let at = || option::of(places.clone());
    let talker = || select(vec![Talker::GP, Talker::GN, Talker::HC, Talker::WI, Talker::VW]);
    let time = || option::of((0..86_401_000_u32).prop_map(TimeOfDay));
    let date = || {
        let dates = (1980..2080_u16, 1..=12_u8, 1..=31_u8).prop_map(|(year, month, day)| Date { year, month, day });
        option::of(dates.prop_filter("a date of the calendar", |date| date.is_valid()))
    };
    let gga = (talker(), time(), at(), 0..9_u8, option::of(0..99_u8), number(), number(), number()).prop_map(
        |(talker, time, at, quality, satellites, hdop, altitude_m, geoid_m)| {
            Sentence::Gga(Gga { talker, time, at, quality, satellites, hdop, altitude_m, geoid_m })
        },
    );
    let rmc = (talker(), time(), any::<bool>(), at(), number(), number(), date()).prop_map(
        |(talker, time, valid, at, speed_kn, course_deg, date)| {
            Sentence::Rmc(Rmc { talker, time, valid, at, speed_kn, course_deg, date })
        },
    );
    let vtg =
        (talker(), prop::array::uniform4(number()), any::<bool>()).prop_map(|(talker, [a, b, c, d], with_mode)| {
            Sentence::Vtg(Vtg {
                talker,
                course_true_deg: a,
                course_magnetic_deg: b,
                speed_kn: c,
                speed_km_h: d,
                with_mode,
            })
        });
    let units =
        vec![SpeedUnit::MetresPerSecond, SpeedUnit::KilometresPerHour, SpeedUnit::Knots, SpeedUnit::MilesPerHour];
    let references = select(vec![WindReference::Relative, WindReference::Theoretical]);
    let mwv = (talker(), number(), references, number(), select(units), any::<bool>()).prop_map(
        |(talker, angle_deg, reference, speed_m_s, unit, valid)| {
            Sentence::Mwv(Mwv { talker, angle_deg, reference, speed_m_s, unit, valid })
        },
    );
    let hdg =
        (talker(), number(), number(), number()).prop_map(|(talker, heading_deg, deviation_deg, variation_deg)| {
            Sentence::Hdg(Hdg { talker, heading_deg, deviation_deg, variation_deg })
        });
    let vhw = (talker(), number(), number(), number()).prop_map(
        |(talker, heading_true_deg, heading_magnetic_deg, speed_kn)| {
            Sentence::Vhw(Vhw { talker, heading_true_deg, heading_magnetic_deg, speed_kn })
        },
    );
    prop_oneof![
        gga,
        rmc,
        vtg,
        mwv,
        hdg,
        vhw,
        (talker(), number()).prop_map(|(talker, heading_deg)| Sentence::Hdt(Hdt { talker, heading_deg })),
        (talker(), time(), date()).prop_map(|(talker, time, date)| Sentence::Zda(Zda { talker, time, date })),
        (talker(), at(), time(), any::<bool>()).prop_map(|(talker, at, time, valid)| Sentence::Gll(Gll {
            talker,
            at,
            time,
            valid
        })),
    ]
    .boxed()
}

fn on_the_globe() -> BoxedStrategy<LatLon> {
    (-90.0..=90.0, -180.0..=180.0).prop_map(|(lat_deg, lon_deg)| LatLon { lat_deg, lon_deg }).boxed()
}

/// Sentences that fit: no field has to be left out.
fn tame() -> BoxedStrategy<Sentence> {
    let text = "[A-Z_]{0,6}".boxed();
    let wide = sentences(&(-359.0..359.0).boxed(), &text, on_the_globe());
    let wide = wide.prop_filter("a battery with such numbers is too long", |s| !matches!(s, Sentence::Battery(_)));
    let narrow = boat_sentences(&(0.0..9.9).boxed(), &text, on_the_globe());
    prop_oneof![3 => wide, 1 => narrow].boxed()
}

/// Sentences that somebody filled with anything at all.
fn wild() -> BoxedStrategy<Sentence> {
    let number = prop_oneof![proptest::num::f64::ANY, -1e9..1e9, select(vec![1e300, -1e300, 1e17, f64::NAN])];
    let number = number.boxed();
    let text = prop_oneof!["\\PC{0,100}", "[ -~\\x00-\\x1f]{0,100}", "[A-Z]{60,90}"].boxed();
    let place = (number.clone(), number.clone()).prop_map(|(lat_deg, lon_deg)| LatLon { lat_deg, lon_deg });
    sentences(&number, &text, prop_oneof![place, on_the_globe()].boxed())
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 1000, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn what_fits_comes_back(sentence in tame()) {
        let line = written(&sentence);
        prop_assert!(line.len() <= EMITTED_MAX, "{line}");
        let found = bodies(line.as_bytes());
        prop_assert_eq!(found.len(), 1);
        let back = Sentence::parse(&found[0]);
        prop_assert!(back.is_ok(), "{line}: {back:?}");
        let back = back.unwrap();
        prop_assert!(same(&sentence, &back), "{sentence:?} came back as {back:?}: {line}");
        let (second, third) = (written(&back), &written(&back)[1..]);
        let again = Sentence::parse(&third[..third.len() - 5]);
        prop_assert_eq!(again.map(|again| written(&again)), Ok(second), "written again");
    }

    #[test]
    fn what_does_not_fit_is_left_out(sentence in wild()) {
        let line = written(&sentence);
        prop_assert!(line.len() <= EMITTED_MAX, "{} bytes: {line}", line.len());
        let found = bodies(line.as_bytes());
        prop_assert_eq!(found.len(), 1, "one sentence: {}", line);
        prop_assert_eq!(&line[1..line.len() - 5], found[0].as_str());
        for field in found[0].split(',').skip(1) {
            prop_assert!(!["nan", "inf"].contains(&field.to_lowercase().trim_matches('-')) || is_text(&sentence));
        }
        match Sentence::parse(&found[0]) {
            Ok(back) => prop_assert_eq!(std::mem::discriminant(&back), std::mem::discriminant(&sentence)),
            // A waypoint that is nowhere and a throttle that is none cannot be read back, and must not be.
            Err(ParseError::Field { field, .. }) => prop_assert!(
                matches!((&sentence, field), (Sentence::Waypoint(_), 1) | (Sentence::MissionSettings(_), 3)), "{line}"),
            Err(error) => prop_assert!(false, "{line}: {error}"),
        }
    }

    #[test]
    fn what_is_read_can_be_written_and_read_again(body in "(PSEA[ABCDGR]|OIWPL|GP(GGA|RMC|VTG|HDT|HDG|ZDA|GLL|MWV|VHW))(,[TLCGNSEWAVMK]|,[0-9]{0,6}|,-?[0-9]{1,4}\\.[0-9]{1,4}){0,16}") {
        if let Ok(sentence) = Sentence::parse(&body) {
            let line = written(&sentence);
            let again = Sentence::parse(&line[1..line.len() - 5]);
            prop_assert!(again.is_ok(), "{body} -> {line}: {again:?}");
            // Sizes that are worked out from others (km/h) are settled after the first time.
            let (second, body) = (written(&again.unwrap()), written(&sentence));
            let settled = Sentence::parse(&second[1..second.len() - 5]).map(|settled| written(&settled));
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
    matches!(sentence, Sentence::BoatError(_) | Sentence::Command(_) | Sentence::ControlState(_) | Sentence::Battery(_))
}
