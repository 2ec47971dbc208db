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

/// One thing that a sentence says.
#[derive(Debug)]
enum Said {
    Number(Option<f64>, f64),
    /// An angle, which may come back a turn away.
    Compass(Option<f64>, f64),
    Word(String),
}

use Said::{Compass, Number, Word};

fn word(word: impl std::fmt::Debug) -> Said {
    Word(format!("{word:?}"))
}

fn place(at: Option<LatLon>, tolerance_deg: f64) -> [Said; 2] {
    [Number(at.map(|at| at.lat_deg), tolerance_deg), Number(at.map(|at| at.lon_deg), tolerance_deg)]
}

fn said(sentence: &Sentence) -> Vec<Said> {
    match sentence {
        Sentence::Command(c) => {
            let thrust = if c.mode == Mode::Speed { THOUSANDTH } else { WHOLE };
            // The number of lines of a file is in the heading's place, and nothing there means none.
            if c.mode == Mode::FileDownload {
                let number = |number: Option<f64>| Number(Some(number.unwrap_or_default()), WHOLE);
                return vec![word(c.mode), number(c.heading_deg), number(c.thrust), number(c.difference)];
            }
            let heading = if c.mode == Mode::Thruster { WHOLE } else { TENTH };
            let numbers = [Compass(c.heading_deg, heading), Number(c.thrust, thrust), Number(c.difference, WHOLE)];
            numbers.into_iter().chain([word(c.mode), word(&c.words)]).collect()
        }
        Sentence::Attitude(a) => {
            let tenths = [a.pitch_deg, a.roll_deg, a.box_c].map(|number| Number(number, TENTH));
            let parts = [a.accel_ahead_g, a.accel_starboard_g, a.accel_down_g, a.yaw_rate_deg_s];
            let hundredths = parts.map(|number| Number(number, HUNDREDTH));
            tenths.into_iter().chain(hundredths).chain([Compass(a.heading_deg, TENTH)]).collect()
        }
        Sentence::Battery(b) => {
            let volts = [b.volts, b.port_volts, b.starboard_volts];
            let thrusters = [b.port_amps, b.starboard_amps, b.port_bilge_amps, b.starboard_bilge_amps];
            let tenths = volts.into_iter().chain(thrusters).chain([b.amps, b.celsius, b.system_amps]);
            let wholes = [b.charge, b.charge_used, b.hours].map(|number| Number(number, WHOLE));
            let words = [word(&b.reset_time), word(&b.reset_date)];
            tenths.map(|number| Number(number, TENTH)).chain(wholes).chain(words).collect()
        }
        Sentence::ControlState(s) => {
            let thrust = if s.mode == Mode::Speed { THOUSANDTH } else { WHOLE };
            let words = [word(s.mode), word(&s.words), word(s.transmission), word(s.sent_to), word(s.operator)];
            let numbers = [Compass(s.heading_deg, TENTH), Number(s.thrust, thrust), Number(s.difference, WHOLE)];
            numbers.into_iter().chain(words).collect()
        }
        Sentence::BoatError(error) => vec![word(&error.code)],
        Sentence::MissionSettings(settings) => vec![Number(Some(settings.throttle_pct), WHOLE)],
        Sentence::Waypoint(w) => place(Some(w.at), FOUR_DECIMALS_DEG).into_iter().chain([word(w.index)]).collect(),
        _ => said_by_the_standard(sentence),
    }
}

fn said_by_the_standard(sentence: &Sentence) -> Vec<Said> {
    match sentence {
        Sentence::Gga(g) => {
            let numbers =
                [Number(g.hdop, HUNDREDTH), Number(g.altitude_m, TENTH), Number(g.geoid_m, TENTH), word(g.time)];
            let words = [word(g.talker), word(g.quality), word(g.satellites)];
            place(g.at, FIVE_DECIMALS_DEG).into_iter().chain(numbers).chain(words).collect()
        }
        Sentence::Rmc(r) => {
            let words = [word(r.talker), word(r.time), word(r.valid), word(r.date)];
            let numbers = [Number(r.speed_kn, HUNDREDTH), Compass(r.course_deg, TENTH)];
            place(r.at, FIVE_DECIMALS_DEG).into_iter().chain(numbers).chain(words).collect()
        }
        Sentence::Vtg(v) => vec![
            word((v.talker, v.with_mode)),
            Compass(v.course_true_deg, TENTH),
            Compass(v.course_magnetic_deg, TENTH),
            Number(v.speed_kn, HUNDREDTH),
            Number(v.speed_km_h, HUNDREDTH),
        ],
        Sentence::Hdt(h) => vec![word(h.talker), Compass(h.heading_deg, TENTH)],
        Sentence::Hdg(h) => vec![
            word(h.talker),
            Compass(h.heading_deg, TENTH),
            Number(h.deviation_deg, TENTH),
            Number(h.variation_deg, TENTH),
        ],
        Sentence::Zda(z) => vec![word((z.talker, z.time, z.date))],
        Sentence::Gll(g) => {
            let words = [word(g.talker), word(g.time), word(g.valid)];
            place(g.at, FIVE_DECIMALS_DEG).into_iter().chain(words).collect()
        }
        Sentence::Mwv(m) => vec![
            word((m.talker, m.reference, m.unit, m.valid)),
            Compass(m.angle_deg, TENTH),
            Number(m.speed_m_s, TENTH * m.unit.m_s()),
        ],
        Sentence::Vhw(v) => vec![
            word(v.talker),
            Compass(v.heading_true_deg, TENTH),
            Compass(v.heading_magnetic_deg, TENTH),
            Number(v.speed_kn, HUNDREDTH),
        ],
        other => panic!("{other:?} is no sentence of the standard"),
    }
}

fn same(a: &Said, b: &Said) -> bool {
    let turned = |a: f64, b: f64| ((a - b + 180.0).rem_euclid(360.0) - 180.0).abs();
    match (a, b) {
        (Word(a), Word(b)) => a == b,
        (Number(None, _), Number(None, _)) | (Compass(None, _), Compass(None, _)) => true,
        (Number(Some(a), tolerance), Number(Some(b), _)) => (a - b).abs() <= *tolerance,
        (Compass(Some(a), tolerance), Compass(Some(b), _)) => turned(*a, *b) <= *tolerance,
        _ => false,
    }
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
    let wide = wide.prop_filter("a battery is told of below", |s| !matches!(s, Sentence::Battery(_)));
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
        let (want, got) = (said(&sentence), said(&back));
        prop_assert_eq!(want.len(), got.len());
        for (want, got) in want.iter().zip(&got) {
            prop_assert!(same(want, got), "{want:?} came back as {got:?}: {line}");
        }
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
