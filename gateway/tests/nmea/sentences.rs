//! Random sentences of every kind, for these tests and for comparisons with other codecs.

use gateway::nmea::{
    Attitude, Battery, BoatError, Command, ControlState, Date, Gga, Hdg, Hdt, MissionSettings,
    Mode, Operator, Rmc, Sentence, Talker, TimeOfDay, Vtg, Waypoint, Zda,
};
use primitives::LatLon;
use proptest::option;
use proptest::prelude::*;
use proptest::sample::select;
use std::ops::Range;

/// The value ranges of a sentence's fields.
pub(crate) struct Domain {
    /// Headings, courses and other bearings, degrees.
    pub(crate) angles: BoxedStrategy<f64>,
    /// Quantities that are never negative in reality.
    pub(crate) sizes: BoxedStrategy<f64>,
    /// Quantities that may be negative.
    pub(crate) signed: BoxedStrategy<f64>,
    pub(crate) texts: BoxedStrategy<String>,
    pub(crate) places: BoxedStrategy<LatLon>,
    /// Years of dates.
    pub(crate) years: Range<u16>,
    /// Times of day, ms.
    pub(crate) day_ms: Range<u32>,
}

/// The values of a sentence as `Debug` prints them, each with its field name.
pub(crate) fn values(sentence: &Sentence) -> Vec<(String, String)> {
    let text = format!("{sentence:?}");
    let mut field = "";
    let mut values = Vec::new();
    for token in text
        .split([' ', ',', '(', ')', '{', '}', '[', ']'])
        .filter(|token| !token.is_empty())
    {
        match token.strip_suffix(':') {
            Some(name) => field = name,
            None => values.push((field.to_owned(), token.to_owned())),
        }
    }
    values
}

pub(crate) fn on_the_globe() -> BoxedStrategy<LatLon> {
    (-90.0..=90.0, -180.0..=180.0)
        .prop_map(|(lat_deg, lon_deg)| LatLon { lat_deg, lon_deg })
        .boxed()
}

/// Sentences of every kind.
pub(crate) fn sentences(domain: &Domain) -> BoxedStrategy<Sentence> {
    prop_oneof![boat_sentences(domain), standard_sentences(domain)].boxed()
}

pub(crate) fn boat_sentences(domain: &Domain) -> BoxedStrategy<Sentence> {
    let angle = || option::of(domain.angles.clone());
    let signed = || option::of(domain.signed.clone());
    let text = || domain.texts.clone();
    let mode = || select(Mode::all().to_vec());
    let command = (mode(), angle(), signed(), signed(), text()).prop_map(
        |(mode, heading_deg, thrust, difference, words)| {
            Sentence::Command(Command {
                mode,
                heading_deg,
                thrust,
                difference,
                words,
            })
        },
    );
    let attitude = (angle(), prop::array::uniform7(signed())).prop_map(
        |(heading_deg, [a, b, c, d, e, f, g])| {
            Sentence::Attitude(Attitude {
                pitch_deg: a,
                roll_deg: b,
                heading_deg,
                heave_m: None,
                box_c: c,
                accel_ahead_g: d,
                accel_starboard_g: e,
                accel_down_g: f,
                yaw_rate_deg_s: g,
            })
        },
    );
    let sizes = prop::array::uniform13(option::of(domain.sizes.clone()));
    let battery = (sizes, text(), text()).prop_map(|(n, reset_time, reset_date)| {
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
    let state = (
        mode(),
        angle(),
        signed(),
        signed(),
        text(),
        letters,
        option::of(any::<u8>()),
        operators,
    )
        .prop_map(
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
        domain
            .sizes
            .clone()
            .prop_map(|throttle_pct| Sentence::MissionSettings(MissionSettings { throttle_pct })),
        (domain.places.clone(), any::<u16>())
            .prop_map(|(at, index)| Sentence::Waypoint(Waypoint { at, index })),
    ]
    .boxed()
}

pub(crate) fn standard_sentences(domain: &Domain) -> BoxedStrategy<Sentence> {
    let angle = || option::of(domain.angles.clone());
    let size = || option::of(domain.sizes.clone());
    let signed = || option::of(domain.signed.clone());
    let at = || option::of(domain.places.clone());
    let talker = || select(vec![Talker::GP, Talker::HC]);
    let time = || option::of(domain.day_ms.clone().prop_map(TimeOfDay));
    let date = || {
        let dates = (domain.years.clone(), 1..=12_u8, 1..=31_u8);
        let dates = dates.prop_map(|(year, month, day)| Date { year, month, day });
        option::of(dates.prop_filter("a valid date", |date| date.is_valid()))
    };
    let gga = (
        talker(),
        time(),
        at(),
        0..9_u8,
        option::of(0..99_u8),
        size(),
        signed(),
        signed(),
    )
        .prop_map(
            |(talker, time, at, quality, satellites, hdop, altitude_m, geoid_m)| {
                Sentence::Gga(Gga {
                    talker,
                    time,
                    at,
                    quality,
                    satellites,
                    hdop,
                    altitude_m,
                    geoid_m,
                })
            },
        );
    let rmc = (
        talker(),
        time(),
        any::<bool>(),
        at(),
        size(),
        angle(),
        date(),
    )
        .prop_map(|(talker, time, valid, at, speed_kn, course_deg, date)| {
            Sentence::Rmc(Rmc {
                talker,
                time,
                valid,
                at,
                speed_kn,
                course_deg,
                date,
            })
        });
    let vtg = (talker(), angle(), angle(), size(), size(), any::<bool>()).prop_map(
        |(talker, course_true_deg, course_magnetic_deg, speed_kn, speed_km_h, with_mode)| {
            Sentence::Vtg(Vtg {
                talker,
                course_true_deg,
                course_magnetic_deg,
                speed_kn,
                speed_km_h,
                with_mode,
            })
        },
    );
    let hdg = (talker(), angle(), signed(), signed()).prop_map(
        |(talker, heading_deg, deviation_deg, variation_deg)| {
            Sentence::Hdg(Hdg {
                talker,
                heading_deg,
                deviation_deg,
                variation_deg,
            })
        },
    );
    prop_oneof![
        gga,
        rmc,
        vtg,
        hdg,
        (talker(), angle()).prop_map(|(talker, heading_deg)| Sentence::Hdt(Hdt {
            talker,
            heading_deg
        })),
        (talker(), time(), date()).prop_map(|(talker, time, date)| Sentence::Zda(Zda {
            talker,
            time,
            date
        })),
    ]
    .boxed()
}
