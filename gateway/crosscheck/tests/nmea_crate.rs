//! Checks our codec against the nmea crate: both must read the same values from our sentences and
//! from those of other devices.
//!
//! The crate has no writer. The sentences of the second test are therefore assembled in this file,
//! with the variations found among devices: leading zeros, more or fewer decimal places, and empty
//! fields.

#[allow(dead_code, reason = "the tests of the codec use more of it")]
#[path = "../../tests/nmea/sentences.rs"]
mod sentences;

use chrono::{Datelike, Timelike};
use gateway::nmea::{Date, Framer, Sentence, TimeOfDay, Vtg, with_checksum};
use nmea::ParseResult;
use nmea::sentences::rmc::RmcStatusOfFix;
use primitives::LatLon;
use proptest::prelude::*;
use proptest::sample::select;
use sentences::{Domain, on_the_globe, standard_sentences};

/// Half of our last digit, plus a small margin, because the crate computes most numbers in single
/// precision.
const TENTH: f64 = 0.0501;
const HUNDREDTH: f64 = 0.00502;
const POSITION_DEG: f64 = 0.000_005_01 / 60.0;

fn near(what: &str, ours: Option<f64>, theirs: Option<f64>, tolerance: f64) {
    let close = match (ours, theirs) {
        (Some(ours), Some(theirs)) => (ours - theirs).abs() <= tolerance,
        (ours, theirs) => ours.is_none() && theirs.is_none(),
    };
    assert!(close, "{what}: {ours:?} here, {theirs:?} there");
}

fn near_place(ours: Option<LatLon>, lat_deg: Option<f64>, lon_deg: Option<f64>) {
    near("latitude", ours.map(|at| at.lat_deg), lat_deg, POSITION_DEG);
    near(
        "longitude",
        ours.map(|at| at.lon_deg),
        lon_deg,
        POSITION_DEG,
    );
}

/// Whether two times are equal to within the rounding of a floating-point second.
fn same_time(ours: Option<TimeOfDay>, theirs: Option<chrono::NaiveTime>) {
    let ms = |time: chrono::NaiveTime| {
        f64::from(time.num_seconds_from_midnight()) * 1e3 + f64::from(time.nanosecond()) / 1e6
    };
    near(
        "time",
        ours.map(|time| f64::from(time.0)),
        theirs.map(ms),
        1.001,
    );
}

fn same_date(ours: Option<Date>, theirs: Option<chrono::NaiveDate>) {
    let theirs = theirs.map(|date| (date.year(), date.month(), date.day()));
    let ours = ours.map(|date| {
        (
            i32::from(date.year),
            u32::from(date.month),
            u32::from(date.day),
        )
    });
    assert_eq!(ours, theirs);
}

/// Checks that both readers give the same values.
fn agree(ours: &Sentence, theirs: &ParseResult) {
    match (ours, theirs) {
        (Sentence::Gga(a), ParseResult::GGA(b)) => {
            same_time(a.time, b.fix_time);
            near_place(a.at, b.latitude, b.longitude);
            let quality = char::from(b'0' + a.quality);
            assert_eq!(Some(nmea::sentences::FixType::from(quality)), b.fix_type);
            assert_eq!(a.satellites.map(u32::from), b.fix_satellites);
            near("hdop", a.hdop, b.hdop.map(f64::from), HUNDREDTH);
            near("altitude", a.altitude_m, b.altitude.map(f64::from), TENTH);
            near("geoid", a.geoid_m, b.geoid_separation.map(f64::from), TENTH);
        }
        (Sentence::Rmc(a), ParseResult::RMC(b)) => {
            same_time(a.time, b.fix_time);
            same_date(a.date, b.fix_date);
            near_place(a.at, b.lat, b.lon);
            assert_eq!(a.valid, b.status_of_fix != RmcStatusOfFix::Invalid);
            near(
                "speed",
                a.speed_kn,
                b.speed_over_ground.map(f64::from),
                HUNDREDTH,
            );
            near("course", a.course_deg, b.true_course.map(f64::from), TENTH);
        }
        (Sentence::Vtg(a), ParseResult::VTG(b)) => {
            near(
                "course",
                a.course_true_deg,
                b.true_course.map(f64::from),
                TENTH,
            );
            near(
                "speed",
                a.speed_kn,
                b.speed_over_ground.map(f64::from),
                HUNDREDTH,
            );
        }
        (Sentence::Hdt(a), ParseResult::HDT(b)) => {
            near("heading", a.heading_deg, b.heading.map(f64::from), TENTH)
        }
        (Sentence::Zda(a), ParseResult::ZDA(b)) => {
            same_time(a.time, b.utc_time);
            same_date(a.date, b.utc_date());
        }
        (ours, theirs) => panic!("{ours:?} here but {theirs:?} there"),
    }
}

/// The crate's interpretation of a line.
fn theirs(line: &str) -> ParseResult {
    nmea::parse_str(line.trim_end()).unwrap_or_else(|e| panic!("the crate rejects {line}: {e:?}"))
}

/// Our interpretation of a line.
fn ours(line: &str) -> Sentence {
    let mut found = Vec::new();
    Framer::new().push(line.as_bytes(), &mut |body| {
        found.push(Sentence::parse(body))
    });
    assert_eq!(found.len(), 1, "{line} is a single sentence");
    found
        .remove(0)
        .unwrap_or_else(|e| panic!("we reject {line}: {e}"))
}

/// Sentences that the crate can read: it has no magnetic heading, and requires some of the numbers.
fn sentence() -> impl Strategy<Value = Sentence> {
    let domain = Domain {
        angles: (0.0..359.9).boxed(),
        sizes: (0.0..99.0).boxed(),
        signed: (-99.0..999.0).boxed(),
        texts: "".boxed(),
        places: on_the_globe(),
        // The crate takes the years 80 to 82 as years of this century.
        years: 1983..2080,
        day_ms: 0..86_400_000,
    };
    standard_sentences(&domain).prop_filter_map("the crate needs it", |sentence| match sentence {
        // The crate computes one speed from the other.
        Sentence::Vtg(v) => Some(Sentence::Vtg(Vtg {
            speed_km_h: Some(v.speed_kn? * 1.852),
            ..v
        })),
        Sentence::Hdt(h) => h.heading_deg.map(|_| Sentence::Hdt(h)),
        Sentence::Hdg(_) => None,
        other => Some(other),
    })
}

/// Lines in the format of other devices.
fn foreign() -> BoxedStrategy<String> {
    let number = || {
        select(vec![
            "0", "0.0", "000.1", "7", "08.25", "45.1", "123.456", "359.9",
        ])
    };
    let maybe = || prop_oneof![number(), Just("")];
    let time = || select(vec!["000000", "235959.999", "150502.00", "120000.5", ""]);
    let place = || {
        select(vec![
            "4221.50616,N,07105.24688,W",
            "3507.5600,S,15042.6600,E",
            "0000.0000,N,00000.0000,W",
            "8959.999999,S,17959.999999,E",
            "4221.5,N,07105.2,W",
            ",,,",
        ])
    };
    let status = || select(vec!["A", "V"]);
    let body = prop_oneof![
        (
            time(),
            place(),
            0..9_u8,
            0..24_u8,
            maybe(),
            maybe(),
            maybe()
        )
            .prop_map(|(t, p, q, n, h, a, g)| format!(
                "GNGGA,{t},{p},{q},{n:02},{h},{a},M,{g},M,1.2,0031"
            )),
        (
            time(),
            status(),
            place(),
            maybe(),
            maybe(),
            select(vec!["010100", "201126", "311299", "290224", ""])
        )
            .prop_map(|(t, s, p, v, c, d)| format!("GPRMC,{t},{s},{p},{v},{c},{d},14.5,W,A")),
        (maybe(), maybe(), number())
            .prop_map(|(c, m, v)| format!("GPVTG,{c},T,{m},M,{v},N,0000.14,K")),
        number().prop_map(|h| format!("HEHDT,{h},T")),
        (time(), 1..=28_u8, 1..=12_u8, 1983..2100_u16)
            .prop_map(|(t, d, m, y)| format!("GPZDA,{t},{d:02},{m:02},{y},-05,00")),
    ];
    body.prop_map(|body| with_checksum(&body)).boxed()
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 4000, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn it_reads_what_we_write(sentence in sentence()) {
        agree(&sentence, &theirs(&sentence.line()));
    }

    #[test]
    fn we_read_what_it_reads(line in foreign()) {
        agree(&ours(&line), &theirs(&line));
    }
}

#[test]
fn goldens_mean_the_same_to_both() {
    for line in [
        "$GPGGA,150502.00,4221.50616,N,07105.24688,W,2,11,0.98,5.5,M,-33.2,M,,*62",
        "$GPRMC,150502.00,A,4221.50616,N,07105.24688,W,2.10,045.0,201126,,,A*79",
        "$GPVTG,045.0,T,059.5,M,2.10,N,3.89,K,A*2A",
        "$GPVTG,045.0,T,059.5,M,2.10,N,3.89,K*47",
        "$GPVTG,000.0,T,012.7,M,000.08,N,0000.14,K*77",
        "$GPHDT,044.2,T*37",
        "$GPZDA,150502.00,20,11,2026,00,00*61",
    ] {
        agree(&ours(&format!("{line}\r\n")), &theirs(line));
    }
}

#[test]
fn what_it_cannot_read_is_why_there_is_a_codec_of_ours() {
    for line in [
        "$PSEAD,T,58.7,20,-10,,T,2,2*79",
        "$HCHDG,058.7,,,14.5,W*01",
        "$OIWPL,2545.4912,N,08022.4373,W,1*7A",
    ] {
        ours(&format!("{line}\r\n"));
        assert!(
            !matches!(nmea::parse_str(line), Ok(found) if !matches!(found, ParseResult::Unsupported(_))),
            "{line}"
        );
    }
}
