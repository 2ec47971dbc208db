//! Edge cases: undocumented content that real peers send, and content that no peer should send.

use gateway::nmea::{Command, ControlState, Hdg, Mode, Sentence, Talker};
use primitives::LatLon;

#[test]
fn a_battery_has_as_many_fields_as_it_likes() {
    let whole =
        "PSEAB,24.8,15433,1.3,22.3,42308,120000,201126,24.8,24.7,1.3,0.1,0.2,0.3,0.4,26,80,81";
    for count in 1..=17 {
        let body = whole
            .split(',')
            .take(count + 1)
            .collect::<Vec<_>>()
            .join(",");
        let Ok(Sentence::Battery(battery)) = Sentence::parse(&body) else {
            panic!("{body} is read")
        };
        assert_eq!(battery.volts, Some(24.8), "{body}");
        assert_eq!(battery.hours, (count >= 15).then_some(26.0), "{body}");
    }
}

#[test]
fn a_position_that_satellites_did_not_make_is_not_valid() {
    for (mode, want) in [
        ("A", true),
        ("D", true),
        ("F", true),
        ("R", true),
        ("", true),
    ]
    .into_iter()
    .chain(["E", "M", "S", "N"].map(|mode| (mode, false)))
    {
        let rmc =
            format!("GNRMC,150502.00,A,4221.50616,N,07105.24688,W,2.10,045.0,201126,,,{mode}");
        let Ok(Sentence::Rmc(rmc)) = Sentence::parse(&rmc) else {
            panic!("{rmc} is read")
        };
        assert_eq!(rmc.valid, want, "mode {mode:?}");
    }
}

#[test]
fn a_non_finite_number_leaves_its_field_empty() {
    for number in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        let at = LatLon {
            lat_deg: number,
            lon_deg: 1.0,
        };
        let some = Some(number);
        let mode = Mode::Thruster;
        let command = Command {
            mode,
            heading_deg: some,
            thrust: some,
            difference: some,
            ..Command::default()
        };
        assert_eq!(Sentence::Command(command).line(), "$PSEAC,T,,,,*3C\r\n");
        let state = ControlState {
            mode: Mode::Speed,
            heading_deg: some,
            thrust: some,
            difference: some,
            transmission: Some('é'),
            ..ControlState::default()
        };
        assert!(
            Sentence::ControlState(state)
                .line()
                .starts_with("$PSEAD,G,,,,,,,*")
        );
        let hdg = Hdg {
            talker: Talker::HC,
            heading_deg: some,
            deviation_deg: some,
            variation_deg: some,
        };
        assert!(Sentence::Hdg(hdg).line().starts_with("$HCHDG,,,,,*"));
        let waypoint = gateway::nmea::Waypoint { at, index: 3 };
        assert!(
            Sentence::Waypoint(waypoint)
                .line()
                .starts_with("$OIWPL,,,,,3*")
        );
    }
}
