//! Edge cases: what real peers send beyond their manuals, and what no peer should.

use crate::written;
use game::LatLon;
use gateway::nmea::{
    Attitude, Battery, Command, ControlState, Gga, Hdg, Mode, Operator, ParseError, Rmc, Sentence, SpeedUnit, Talker,
    TimeOfDay, Vhw, Vtg,
};

#[test]
fn a_blank_field_is_empty() {
    for body in
        ["PSEAA,-2.2,0.7,222.6, ,47.8,-0.04,-0.01,-1.00,-0.01", "PSEAA,-2.2,0.7, 222.6 ,,47.8,-0.04,-0.01,-1.00,-0.01"]
    {
        let Ok(Sentence::Attitude(Attitude { heading_deg, heave_m, box_c, .. })) = Sentence::parse(body) else {
            panic!("{body} is read");
        };
        assert_eq!((heading_deg, heave_m, box_c), (Some(222.6), None, Some(47.8)), "{body}");
    }
}

#[test]
fn heave_is_read_but_never_written() {
    let heaving = Attitude { heave_m: Some(0.3), ..Attitude::default() };
    assert_eq!(written(&Sentence::Attitude(heaving)), "$PSEAA,,,,,,,,,*6A\r\n");
    let Ok(Sentence::Attitude(read)) = Sentence::parse("PSEAA,1,2,3,0.3,5") else { panic!("five fields are read") };
    assert_eq!((read.heave_m, read.yaw_rate_deg_s), (Some(0.3), None));
}

#[test]
fn a_simulator_sends_four_fields_of_control_state() {
    let Ok(Sentence::ControlState(state)) = Sentence::parse("PSEAD,R,0,0,0") else { panic!("it is read") };
    assert_eq!((state.mode, state.heading_deg, state.operator), (Mode::StationKeep, Some(0.0), None));
    let Ok(Sentence::ControlState(state)) = Sentence::parse("PSEAD,G,58.7,1.5,,THR_ON,N,1,5,extra") else {
        panic!("a ninth field is no fault");
    };
    assert_eq!((state.thrust, state.operator, state.transmission), (Some(1.5), Some(Operator::Rc), Some('N')));
}

#[test]
fn a_battery_has_as_many_fields_as_it_likes() {
    let whole = "PSEAB,24.8,15433,1.3,22.3,42308,120000,201126,24.8,24.7,1.3,0.1,0.2,0.3,0.4,26,80,81";
    for count in 1..=17 {
        let body = whole.split(',').take(count + 1).collect::<Vec<_>>().join(",");
        let Ok(Sentence::Battery(battery)) = Sentence::parse(&body) else { panic!("{body} is read") };
        assert_eq!(battery.volts, Some(24.8), "{body}");
        assert_eq!(battery.hours, (count >= 15).then_some(26.0), "{body}");
    }
}

#[test]
fn a_full_battery_loses_its_longest_field_rather_than_the_line_its_length() {
    let battery = Battery {
        volts: Some(24.8),
        charge: Some(15433.0),
        amps: Some(11.3),
        celsius: Some(22.3),
        charge_used: Some(42308.0),
        reset_time: "120000".to_owned(),
        reset_date: "201126".to_owned(),
        port_volts: Some(24.8),
        starboard_volts: Some(24.7),
        system_amps: Some(1.3),
        port_amps: Some(10.0),
        starboard_amps: Some(10.0),
        port_bilge_amps: Some(0.0),
        starboard_bilge_amps: Some(0.0),
        hours: Some(26.0),
    };
    let line = written(&Sentence::Battery(battery));
    assert!(
        line.starts_with("$PSEAB,24.8,15433,11.3,22.3,42308,120000,,24.8,24.7,1.3,10.0,10.0,0.0,0.0,26*"),
        "{line}"
    );
}

#[test]
fn talkers_do_not_matter_and_are_kept() {
    for (body, talker) in [
        ("GNRMC,150502.00,A,4221.50616,N,07105.24688,W,2.10,045.0,201126,,,A", Talker::GN),
        ("GPRMC,150502,A,4221.50616,N,07105.24688,W,2.10,045.0,201126", Talker::GP),
    ] {
        let Ok(Sentence::Rmc(rmc)) = Sentence::parse(body) else { panic!("{body} is read") };
        assert_eq!((rmc.talker, rmc.time), (talker, Some(TimeOfDay(54_302_000))), "{body}");
    }
    let Ok(Sentence::Gll(gll)) = Sentence::parse("VCGLL,4221.50616,N,07105.24688,W,150502.00,A") else {
        panic!("the boat's own GLL is read");
    };
    assert_eq!(gll.talker.characters(), *b"VC");
    assert!(gll.valid);
    assert!(written(&Sentence::Gll(gll)).starts_with("$VCGLL,4221.50616,N,07105.24688,W,150502.00,A,A*"));
}

#[test]
fn other_sentences_of_boats_and_gpsd_are_unknown() {
    for address in [
        "PSEAE", "PSEAF", "PSEAJ", "PSEAX", "OIVCQ", "PTQM0", "DEBUG", "PGRMCE", "GPWPL", "GPGSV", "PAGGA", "gpgga", "",
    ] {
        let got = Sentence::parse(&format!("{address},1,2,3"));
        assert_eq!(got, Err(ParseError::Unknown { address: address.to_owned() }));
    }
    for odd in ["GP", "GPGGAX", "ÄGGA", "GÄGA", "$GPGGA"] {
        assert_eq!(Sentence::parse(odd), Err(ParseError::Unknown { address: odd.to_owned() }));
    }
}

#[test]
fn a_receiver_without_a_fix_has_no_position() {
    let Ok(Sentence::Gga(gga)) = Sentence::parse("GPGGA,,,,,,0,,,,,,,,") else { panic!("it is read") };
    let nothing = Gga::default();
    assert_eq!(gga, nothing);
    let Ok(Sentence::Rmc(Rmc { valid, at, date, .. })) = Sentence::parse("GPRMC,,V,,,,,,,,,,N") else {
        panic!("it is read");
    };
    assert_eq!((valid, at, date), (false, None, None));
    let Ok(Sentence::Vtg(Vtg { course_true_deg, speed_kn, with_mode, .. })) =
        Sentence::parse("GPVTG,,T,,M,0.260,N,0.481,K,A")
    else {
        panic!("it is read");
    };
    assert_eq!((course_true_deg, speed_kn, with_mode), (None, Some(0.26), true));
    let quiet = Vtg { with_mode: true, ..Vtg::default() };
    assert!(written(&Sentence::Vtg(quiet)).starts_with("$GPVTG,,T,,M,,N,,K,N*"));
}

#[test]
fn a_wide_rtk_fix_is_read() {
    let body = "GNGGA,150502.000,4221.5061634,N,07105.2468842,W,4,22,0.51,5.512,M,-33.201,M,1.0,0031";
    let Ok(Sentence::Gga(gga)) = Sentence::parse(body) else { panic!("it is read") };
    let at = gga.at.unwrap();
    assert!((at.lat_deg - 42.358_436_056_7).abs() < 1e-10 && (at.lon_deg + 71.087_448_07).abs() < 1e-10, "{at:?}");
    assert_eq!((gga.quality, gga.satellites), (4, Some(22)));
}

#[test]
fn units_decide() {
    let Ok(Sentence::Mwv(wind)) = Sentence::parse("WIMWV,041.1,R,18.0,K,A") else { panic!("it is read") };
    assert_eq!((wind.unit, wind.speed_m_s), (SpeedUnit::KilometresPerHour, Some(5.0)));
    assert!(written(&Sentence::Mwv(wind)).starts_with("$WIMWV,041.1,R,18.0,K,A*"));
    let Ok(Sentence::Mwv(still)) = Sentence::parse("WIMWV,,R,,,V") else { panic!("a dead sensor is read") };
    assert_eq!((still.valid, still.speed_m_s), (false, None));
    let Ok(Sentence::Vhw(Vhw { speed_kn: Some(speed_kn), .. })) = Sentence::parse("VWVHW,,T,,M,,N,3.704,K") else {
        panic!("km/h alone are read");
    };
    assert!((speed_kn - 2.0).abs() < 1e-12);
    let Ok(Sentence::Hdg(Hdg { deviation_deg, variation_deg, .. })) = Sentence::parse("HCHDG,98.3,0.4,E,12.6,W") else {
        panic!("it is read");
    };
    assert_eq!((deviation_deg, variation_deg), (Some(0.4), Some(-12.6)));
}

#[test]
fn a_wrong_field_is_named() {
    for (body, want) in [
        ("PSEAC,X,0,0,0,", "PSEAC field 1 is \"X\", expected the letter of a control mode"),
        ("PSEAC,TT,0,0,0,", "PSEAC field 1 is \"TT\", expected the letter of a control mode"),
        ("PSEAC,,0,0,0,", "PSEAC field 1 is \"\", expected the letter of a control mode"),
        ("PSEAC,T,0,nan,0,", "PSEAC field 3 is \"nan\", expected a number or nothing"),
        ("PSEAC,T,0,20,inf,", "PSEAC field 4 is \"inf\", expected a number or nothing"),
        ("PSEAC,T,1e2,20,0,", "PSEAC field 2 is \"1e2\", expected a number or nothing"),
        ("PSEAC,T,0,20", "PSEAC has 3 data fields, expected 4 or more"),
        ("PSEAC", "PSEAC has 0 data fields, expected 4 or more"),
        ("PSEAD,1.5,T,2.5,0.5", "PSEAD field 1 is \"1.5\", expected the letter of a control mode"),
        ("PSEAD,T,,,,,T,2,-2", "PSEAD field 8 is \"-2\", expected a small whole number or nothing"),
        ("PSEAD,T,,,,,T,2,300", "PSEAD field 8 is \"300\", expected a small whole number or nothing"),
        ("PSEAR,0,000,,0,000", "PSEAR field 3 is \"\", expected a throttle in percent"),
        ("OIWPL,,,,,1", "OIWPL field 1 is \"\", expected a latitude"),
        ("OIWPL,2545.4912,N,08022.4373,W,", "OIWPL field 5 is \"\", expected the waypoint's number"),
        (
            "OIWPL,2545.4912,N,08022.4373,W,65536",
            "OIWPL field 5 is \"65536\", expected a small whole number or nothing",
        ),
        ("OIWPL,9545.4912,N,08022.4373,W,1", "OIWPL field 1 is \"9545.4912\", expected ddmm.mmmm up to 90 degrees"),
        ("OIWPL,2560.0000,N,08022.4373,W,1", "OIWPL field 1 is \"2560.0000\", expected ddmm.mmmm up to 90 degrees"),
        ("OIWPL,2545.4912,N,18000.0001,W,1", "OIWPL field 3 is \"18000.0001\", expected dddmm.mmmm up to 180 degrees"),
        ("OIWPL,2545.4912,X,08022.4373,W,1", "OIWPL field 2 is \"X\", expected N or S"),
        ("OIWPL,2545.4912,N,08022.4373,,1", "OIWPL field 4 is \"\", expected E or W"),
        ("GPGGA,150502.00,4221.5,N,,,2,11", "GPGGA field 4 is \"\", expected dddmm.mmmm up to 180 degrees"),
        ("GPGGA,250502.00,,,,,0", "GPGGA field 1 is \"250502.00\", expected a time hhmmss.ss or nothing"),
        ("GPGGA,150502,,,,,0,,,5.5,F", "GPGGA field 10 is \"F\", expected M"),
        ("GPRMC,150502,A,,,,,,,311126", "GPRMC field 9 is \"311126\", expected a date ddmmyy or nothing"),
        ("GPRMC,150502,1,,,,,,,", "GPRMC field 2 is \"1\", expected A, D, V or nothing"),
        ("GPVTG,045.0,T,2.10,N,3.89,K,A,", "GPVTG field 4 is \"N\", expected M"),
        ("GPVTG,045.0,T,059.5,M", "GPVTG has 4 data fields, expected 8 or more"),
        ("HCHDG,58.7,,,14.5,", "HCHDG field 5 is \"\", expected E or W"),
        ("GPZDA,150502,29,02,2026,00,00", "GPZDA field 2 is \"29\", expected a date of the calendar"),
        ("GPZDA,150502,20,,2026,00,00", "GPZDA field 2 is \"20\", expected a day, month and year, or none of them"),
        ("WIMWV,214.8,R,5.1,,A", "WIMWV field 4 is \"\", expected K, M, N or S"),
        ("WIMWV,214.8,X,5.1,M,A", "WIMWV field 2 is \"X\", expected R or T"),
    ] {
        let error = Sentence::parse(body).map_err(|error| error.to_string());
        assert_eq!(error, Err(want.to_owned()), "{body}");
    }
}

#[test]
fn years_of_two_digits_are_of_1980_to_2079() {
    for (text, year) in [("010100", 2000), ("010179", 2079), ("010180", 1980), ("010199", 1999)] {
        let Ok(Sentence::Rmc(rmc)) = Sentence::parse(&format!("GPRMC,,V,,,,,,,{text}")) else { panic!("it is read") };
        assert_eq!(rmc.date.map(|date| date.year), Some(year), "{text}");
        assert!(written(&Sentence::Rmc(rmc)).contains(text), "{text} is written as it was read");
    }
}

#[test]
fn a_non_finite_number_leaves_its_field_empty() {
    for number in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        let at = LatLon { lat_deg: number, lon_deg: 1.0 };
        let some = Some(number);
        let mode = Mode::Thruster;
        let command = Command { mode, heading_deg: some, thrust: some, difference: some, ..Command::default() };
        assert_eq!(written(&Sentence::Command(command)), "$PSEAC,T,,,,*3C\r\n");
        let state = ControlState {
            mode: Mode::Speed,
            heading_deg: some,
            thrust: some,
            difference: some,
            transmission: Some('é'),
            ..ControlState::default()
        };
        assert!(written(&Sentence::ControlState(state)).starts_with("$PSEAD,G,,,,,,,*"));
        let hdg = Hdg { talker: Talker::HC, heading_deg: some, deviation_deg: some, variation_deg: some };
        assert!(written(&Sentence::Hdg(hdg)).starts_with("$HCHDG,,,,,*"));
        let waypoint = gateway::nmea::Waypoint { at, index: 3 };
        assert!(written(&Sentence::Waypoint(waypoint)).starts_with("$OIWPL,,,,,3*"));
    }
}
