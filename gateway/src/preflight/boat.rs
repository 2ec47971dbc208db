//! Pre-flight checks of a boat's own sentences.

use super::Check;
use super::fix_scatter::FixScatter;
use crate::config::Gateway;
use crate::geodesy::LocalFrame;
use crate::geofence::GeofenceArea;
use crate::nmea::{Mode, Operator};
use crate::sensor_check::{HostTime, SensorCheck};
use primitives::frame::LatLon;
use rules::Field;

/// Maximum scatter of the fixes of a boat at rest, m: the radius around their mean that contains 95
/// of 100 fixes, and the drift of that mean.
const SCATTER_MAX_M: f64 = 2.5;
/// Minimum time over which fixes are collected, s.
const SCATTER_S: f64 = 25.0;
/// The water on which the boat will drive.
pub struct Water {
    /// The field.
    pub field: Field,
    /// Where the boat may be.
    pub area: GeofenceArea,
}

/// Checks the data that a boat has sent so far. Its times are compared with the host's clock.
pub fn boat_checks(
    seen: &SensorCheck,
    host: HostTime,
    gateway: &Gateway,
    water: Option<&Water>,
) -> Vec<Check> {
    let missing = seen.missing();
    let sentences = if missing.is_empty() {
        "nothing is missing".to_owned()
    } else {
        missing.join("; ")
    };
    vec![
        Check::of("sentences", missing.is_empty(), sentences),
        fix(seen, gateway),
        scatter(seen),
        geofence(seen, water),
        compass(seen),
        control(seen, gateway),
        battery(seen, gateway),
        bilge(seen, gateway),
        clock(seen, host),
        error(seen),
    ]
}

fn fix(seen: &SensorCheck, gateway: &Gateway) -> Check {
    let Some(fix) = seen.fix else {
        return Check::not_done("fix", "received no fix that states its quality");
    };
    let nav = &gateway.nav;
    let satellites = fix
        .satellites
        .map_or("unknown".to_owned(), |count| count.to_string());
    let hdop = fix
        .hdop
        .map_or("unknown".to_owned(), |hdop| hdop.to_string());
    let quality = fix.quality.unwrap_or_default();
    let found = format!(
        "{}, {satellites} satellites, dilution {hdop}; expected quality {} or better, dilution up to {}",
        quality.in_words(),
        nav.quality_min,
        nav.hdop_max
    );
    let is_sharp = fix.hdop.is_none_or(|hdop| hdop <= nav.hdop_max);
    Check::of(
        "fix",
        fix.at.is_some() && quality.meets(nav.quality_min) && is_sharp,
        found,
    )
}

fn scatter(seen: &SensorCheck) -> Check {
    let fixes = &seen.fixes;
    let lasted_s = fixes
        .first()
        .zip(fixes.last())
        .map_or(0.0, |(first, last)| (last.0 - first.0).as_s());
    let places: Vec<LatLon> = fixes.iter().map(|(_, at)| *at).collect();
    // Drift of a fix shows over tens of seconds; a few good fixes do not reveal it.
    match FixScatter::of(&places).filter(|_| lasted_s >= SCATTER_S) {
        None => Check::not_done(
            "scatter",
            format!("{lasted_s:.0} s of fixes, expected {SCATTER_S}: use --for-s 30"),
        ),
        Some(FixScatter {
            radius_95_m,
            drift_m,
        }) => {
            let found = format!(
                "95 % within {radius_95_m:.2} m, drift {drift_m:.2} m in {lasted_s:.0} s; expected up to {SCATTER_MAX_M} m for a boat at rest"
            );
            Check::of(
                "scatter",
                radius_95_m <= SCATTER_MAX_M && drift_m <= SCATTER_MAX_M,
                found,
            )
        }
    }
}

fn geofence(seen: &SensorCheck, water: Option<&Water>) -> Check {
    let Some(water) = water else {
        return Check::not_done(
            "geofence",
            "the field is unknown without a game: use --vehicle NAME with --game",
        );
    };
    let Some((_, at)) = seen.fixes.last() else {
        return Check::not_done("geofence", "received no position");
    };
    let place = LocalFrame::new(water.field.plan.datum).ned(*at);
    let clearance_m = water.area.clearance_m(place);
    let on_field = if water.field.contains(place) {
        "on the field"
    } else {
        "off the field"
    };
    let found = format!(
        "x {:.1} m, y {:.1} m, {on_field}, {:.1} m {} the nearest edge of the geofence",
        place.east,
        place.north,
        clearance_m.abs(),
        if clearance_m > 0.0 {
            "inside"
        } else {
            "OUTSIDE"
        }
    );
    Check::of("geofence", clearance_m > 0.0, found)
}

fn compass(seen: &SensorCheck) -> Check {
    match seen.heading_deg() {
        Some(heading_deg) if (0.0..=360.0).contains(&heading_deg) => {
            Check::of("compass", true, seen.heading().unwrap_or_default())
        }
        Some(heading_deg) => Check::of(
            "compass",
            false,
            format!("heading {heading_deg}, expected 0 to 360"),
        ),
        None => Check::not_done("compass", "received no heading"),
    }
}

fn control(seen: &SensorCheck, gateway: &Gateway) -> Check {
    let Some(control) = seen.control else {
        let found = "the boat does not report who commands it";
        // For boats without such a sentence, the file may state who has control: then a person
        // takes responsibility.
        return Check::of(
            "control",
            gateway.control.assumed,
            format!("{found}; expected PSEAD, or control.assumed"),
        );
    };
    let mode = control.shown.mode;
    let is_ours = control
        .operator
        .is_none_or(|operator| operator == Operator::Secondary);
    let operator = control
        .operator
        .map_or("nobody identified".to_owned(), |operator| {
            format!("{operator:?}")
        });
    let found = format!(
        "mode {}, commanded by {operator}; expected {}, and Secondary",
        seen.mode_in_words(mode),
        seen.mode_in_words(Mode::Standby)
    );
    // A check must not take over a moving boat.
    Check::of("control", is_ours && mode == Mode::Standby, found)
}

fn battery(seen: &SensorCheck, gateway: &Gateway) -> Check {
    let least = gateway.battery.volts_min;
    match seen.power.volts {
        Some(volts) => Check::of(
            "battery",
            volts >= least,
            format!("{volts:.1} V, expected {least} or more"),
        ),
        None => Check::not_done("battery", "the boat does not report its battery"),
    }
}

fn bilge(seen: &SensorCheck, gateway: &Gateway) -> Check {
    let most_a = gateway.currents.bilge_a;
    let currents = seen.power.bilge_a;
    let amps = currents.iter().flatten().copied().reduce(f64::max);
    match amps {
        Some(amps) if most_a > 0.0 => {
            let found =
                format!("pumps draw {amps:.1} A, expected less than {most_a}: more is a leak");
            Check::of("bilge", amps < most_a, found)
        }
        _ => Check::not_done(
            "bilge",
            "the boat does not report its pumps, or they are not monitored",
        ),
    }
}

fn clock(seen: &SensorCheck, host: HostTime) -> Check {
    match (seen.clock_fault(host), seen.clock_behind_s(host)) {
        (Some(fault), _) => Check::of("clock", false, fault),
        (None, Some(behind_s)) => {
            let found =
                format!("fixes are {behind_s:.2} s behind this machine's clock, expected -1 to 5");
            Check::of("clock", true, found)
        }
        (None, None) => Check::not_done("clock", "received no time of day"),
    }
}

fn error(seen: &SensorCheck) -> Check {
    match &seen.error {
        None => Check::of("error", true, "the boat reports none".to_owned()),
        Some(error) => Check::of("error", false, format!("the boat reports error {error:?}")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::nmea::with_checksum;
    use crate::preflight::Verdict;
    use primitives::SimTime;
    use primitives::frame::Ned;

    fn water() -> Water {
        let game = std::path::Path::new(env!("CARGO_MANIFEST_DIR"))
            .join("../scenarios/games/pav01_vs_pav01.toml");
        let field = scenario::load(&game)
            .unwrap_or_else(|problems| panic!("{problems}"))
            .field;
        let area = GeofenceArea::new(&field, &crate::config::default_gateway().geofence);
        Water { field, area }
    }

    /// The sentences of a boat that stays near this point of the field for a minute: its GGA from
    /// the fifth field on, and its other sentences.
    fn seen(water: &Water, [x, y]: [f64; 2], fix: &str, more: &[&str]) -> SensorCheck {
        let frame = LocalFrame::new(water.field.plan.datum);
        let mut check = SensorCheck::new(&crate::config::default_gateway());
        for i in 0..120_u32 {
            let at = frame.lat_lon(Ned::from_xy(x + 0.1 * f64::from(i % 3), y));
            let minutes = |deg: f64| (deg.abs().trunc(), deg.abs().fract() * 60.0);
            let (lat, lat_min) = minutes(at.lat_deg);
            let (lon, lon_min) = minutes(at.lon_deg);
            let gga = format!(
                "GPGGA,1505{:02}.00,{lat:02}{lat_min:08.5},N,{lon:03}{lon_min:08.5},W,{fix},5.5,M,-33.2,M,,",
                i / 2
            );
            for body in [gga.as_str()].iter().chain(more) {
                let now = SimTime::from_s(0.5 * f64::from(i));
                check.receive(now, with_checksum(body).as_bytes());
            }
        }
        check
    }

    const SOUND: [&str; 4] = [
        "PSEAA,-2.2,0.7,222.6,,47.8,-0.04,-0.01,-1.00,-0.01",
        "PSEAD,L,0.0,0,0,,T,2,2",
        "PSEAB,24.8,15433,1.3,22.3,42308,,,24.8,,1.3,0.0,0.0,0.0,0.0,26",
        "GPVTG,000.0,T,012.7,M,000.08,N,0000.14,K",
    ];

    #[test]
    fn each_thing_that_is_wrong_fails_its_own_check() {
        let water = water();
        let sound = |at: usize, body: &'static str| {
            let mut sentences = SOUND;
            sentences[at] = body;
            sentences
        };
        let home = [80.0, 40.0];
        let fix = "4,11,0.98";
        for (place, fix, more, failed, found) in [
            (home, fix, SOUND, "", ""),
            (home, "0,11,0.98", SOUND, "fix", "no fix, 11 satellites"),
            (
                home,
                "6,11,0.98",
                SOUND,
                "fix",
                "dead reckoning, 11 satellites",
            ),
            (home, "7,11,0.98", SOUND, "fix", "manual input"),
            (home, "8,11,0.98", SOUND, "fix", "simulator"),
            (home, "9,11,0.98", SOUND, "fix", "an unknown quality"),
            (
                home,
                "5,4,7.50",
                SOUND,
                "fix",
                "RTK float, 4 satellites, dilution 7.5",
            ),
            (
                [80.0, 400.0],
                fix,
                SOUND,
                "geofence",
                "off the field, 290.0 m OUTSIDE",
            ),
            (
                home,
                fix,
                sound(0, "PSEAA,-2.2,0.7,400000,,47.8,-0.04,-0.01,-1.00,-0.01"),
                "compass",
                "heading 400000",
            ),
            (
                home,
                fix,
                sound(1, "PSEAD,T,0.0,20,0,,T,2,2"),
                "control",
                "mode T",
            ),
            (
                home,
                fix,
                sound(1, "PSEAD,L,0.0,0,0,,T,2,5"),
                "control",
                "commanded by Rc",
            ),
            (
                home,
                fix,
                sound(
                    2,
                    "PSEAB,21.0,15433,1.3,22.3,42308,,,24.8,,1.3,0.0,0.0,,,26",
                ),
                "battery",
                "21.0 V",
            ),
            (
                home,
                fix,
                sound(
                    2,
                    "PSEAB,24.8,15433,1.3,22.3,42308,,,24.8,,1.3,0.0,0.0,,0.9,26",
                ),
                "bilge",
                "0.9 A",
            ),
            (home, fix, sound(3, "PSEAG,E"), "error", "error \"E\""),
        ] {
            let seen = seen(&water, place, fix, &more);
            let host = HostTime {
                now: SimTime::from_s(59.5),
                utc_ns: 54_360_000_000_000,
            };
            let checks = boat_checks(&seen, host, &crate::config::default_gateway(), Some(&water));
            let wrong: Vec<_> = checks
                .iter()
                .filter(|check| check.verdict != Verdict::Passed)
                .collect();
            if failed.is_empty() {
                assert!(wrong.is_empty(), "{wrong:?}");
            } else {
                assert!(
                    wrong
                        .iter()
                        .any(|check| check.name == failed && check.found.contains(found)),
                    "{failed}: {wrong:?}"
                );
            }
        }
    }

    #[test]
    fn what_a_short_look_cannot_tell_is_not_checked() {
        let mut check = SensorCheck::new(&crate::config::default_gateway());
        check.receive(
            SimTime::ZERO,
            b"$GPGGA,150502.00,4221.50616,N,07105.24688,W,2,11,0.98,5.5,M,-33.2,M,,*62\r\n",
        );
        let host = HostTime {
            now: SimTime::ZERO,
            utc_ns: 54_302_400_000_000,
        };
        let checks = boat_checks(&check, host, &crate::config::default_gateway(), None);
        let not_checked = checks
            .iter()
            .filter(|check| check.verdict == Verdict::NotChecked);
        let names: Vec<&str> = not_checked.map(|check| check.name.as_str()).collect();
        assert_eq!(
            names,
            ["scatter", "geofence", "compass", "battery", "bilge"],
            "{checks:?}"
        );
    }
}
