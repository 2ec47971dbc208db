//! Sentences as real programs and manuals have them, to the byte.

use crate::{bodies, written};
use game::LatLon;
use gateway::nmea::{
    Attitude, Battery, BoatError, Command, ControlState, Date, Gga, Gll, Hdg, Hdt, MissionSettings, Mode, Mwv,
    Operator, Rmc, Sentence, SpeedUnit, Talker, TimeOfDay, Vhw, Vtg, Waypoint, WindReference, Zda,
};

/// 15:05:02.
const TIME: Option<TimeOfDay> = Some(TimeOfDay(54_302_000));

/// The pavilion from which MIT's missions are measured.
const PAVILION: LatLon = LatLon { lat_deg: 42.358436, lon_deg: -71.087448 };

const DATE: Option<Date> = Some(Date { year: 2026, month: 11, day: 20 });

/// What we read and write alike.
fn both_ways() -> Vec<(&'static str, Sentence)> {
    let mut goldens = commands();
    goldens.extend(of_the_boat());
    goldens.extend(fixes());
    goldens.extend(headings_and_wind());
    goldens
}

fn commands() -> Vec<(&'static str, Sentence)> {
    let zero = Some(0.0);
    vec![
        ("$PSEAC,L,0,0,0,*14", command(Mode::Standby, [zero, zero, zero], "")),
        ("$PSEAC,T,0,20,-10,*22", command(Mode::Thruster, [zero, Some(20.0), Some(-10.0)], "")),
        ("$PSEAC,T,,20,-10,THR_ON*02", command(Mode::Thruster, [None, Some(20.0), Some(-10.0)], "THR_ON")),
        ("$PSEAC,C,270,35,,*18", command(Mode::Heading, [Some(270.0), Some(35.0), None], "")),
        ("$PSEAC,R,,,,*3A", command(Mode::StationKeep, [None; 3], "")),
        ("$PSEAC,W,0,0,0,*0F", command(Mode::Waypoint, [zero; 3], "")),
        ("$PSEAC,H,0,0,0,*10", command(Mode::GoToErp, [zero; 3], "")),
        ("$PSEAC,F,4,000,000,*1A", command(Mode::FileDownload, [Some(4.0), zero, zero], "")),
        ("$PSEAC,L,0,0,0,GPS_ON*0E", command(Mode::Standby, [zero; 3], "GPS_ON")),
        ("$PSEAC,L,0,0,0,SONAR_ON*0B", command(Mode::Standby, [zero; 3], "SONAR_ON")),
        ("$PSEAR,0,000,20,0,000*7B", Sentence::MissionSettings(MissionSettings { throttle_pct: 20.0 })),
        ("$PSEAR,0,000,10,0,000*78", Sentence::MissionSettings(MissionSettings { throttle_pct: 10.0 })),
        (
            "$OIWPL,2545.4912,N,08022.4373,W,1*7A",
            Sentence::Waypoint(Waypoint {
                at: LatLon { lat_deg: 25.0 + 45.4912 / 60.0, lon_deg: -(80.0 + 22.4373 / 60.0) },
                index: 1,
            }),
        ),
    ]
}

fn of_the_boat() -> Vec<(&'static str, Sentence)> {
    let attitude = Attitude {
        pitch_deg: Some(-2.2),
        roll_deg: Some(0.7),
        heading_deg: Some(222.6),
        box_c: Some(47.8),
        accel_ahead_g: Some(-0.04),
        accel_starboard_g: Some(-0.01),
        accel_down_g: Some(-1.0),
        yaw_rate_deg_s: Some(-0.01),
        ..Attitude::default()
    };
    let battery = Battery {
        volts: Some(24.8),
        charge: Some(15433.0),
        amps: Some(1.3),
        celsius: Some(22.3),
        charge_used: Some(42308.0),
        port_volts: Some(24.8),
        system_amps: Some(1.3),
        port_amps: Some(0.0),
        starboard_amps: Some(0.0),
        hours: Some(26.0),
        ..Battery::default()
    };
    let state = ControlState {
        mode: Mode::Thruster,
        heading_deg: Some(58.7),
        thrust: Some(20.0),
        difference: Some(-10.0),
        words: String::new(),
        transmission: Some('T'),
        sent_to: Some(2),
        operator: Some(Operator::Secondary),
    };
    vec![
        ("$PSEAA,-2.2,0.7,222.6,,47.8,-0.04,-0.01,-1.00,-0.01*7A", Sentence::Attitude(attitude)),
        ("$PSEAB,24.8,15433,1.3,22.3,42308,,,24.8,,1.3,0.0,0.0,,,26*7D", Sentence::Battery(battery)),
        ("$PSEAD,T,58.7,20,-10,,T,2,2*79", Sentence::ControlState(state)),
        ("$PSEAG,N*22", Sentence::BoatError(BoatError { code: "N".to_owned() })),
    ]
}

fn fixes() -> Vec<(&'static str, Sentence)> {
    let (talker, time, at) = (Talker::GP, TIME, Some(PAVILION));
    let gga = Gga {
        talker,
        time,
        at,
        quality: 2,
        satellites: Some(11),
        hdop: Some(0.98),
        altitude_m: Some(5.5),
        geoid_m: Some(-33.2),
    };
    let rmc = Rmc { talker, time, valid: true, at, speed_kn: Some(2.1), course_deg: Some(45.0), date: DATE };
    let vtg = |with_mode| {
        Sentence::Vtg(Vtg {
            talker,
            course_true_deg: Some(45.0),
            course_magnetic_deg: Some(59.5),
            speed_kn: Some(2.1),
            speed_km_h: Some(3.89),
            with_mode,
        })
    };
    vec![
        ("$GPGGA,150502.00,4221.50616,N,07105.24688,W,2,11,0.98,5.5,M,-33.2,M,,*62", Sentence::Gga(gga)),
        ("$GPRMC,150502.00,A,4221.50616,N,07105.24688,W,2.10,045.0,201126,,,A*79", Sentence::Rmc(rmc)),
        ("$GPVTG,045.0,T,059.5,M,2.10,N,3.89,K,A*2A", vtg(true)),
        ("$GPVTG,045.0,T,059.5,M,2.10,N,3.89,K*47", vtg(false)),
        ("$GPZDA,150502.00,20,11,2026,00,00*61", Sentence::Zda(Zda { talker, time, date: DATE })),
        ("$GPGLL,4221.50616,N,07105.24688,W,150502.00,A,A*7A", Sentence::Gll(Gll { talker, at, time, valid: true })),
    ]
}

fn headings_and_wind() -> Vec<(&'static str, Sentence)> {
    let wind = |reference, speed_m_s, unit| {
        Sentence::Mwv(Mwv {
            talker: Talker::WI,
            angle_deg: Some(214.8),
            reference,
            speed_m_s: Some(speed_m_s),
            unit,
            valid: true,
        })
    };
    let (hdt, hdg) = (
        Hdt { talker: Talker::GP, heading_deg: Some(44.2) },
        Hdg { talker: Talker::HC, heading_deg: Some(58.7), deviation_deg: None, variation_deg: Some(-14.5) },
    );
    let vhw =
        Vhw { talker: Talker::VW, heading_true_deg: Some(44.2), heading_magnetic_deg: Some(58.7), speed_kn: Some(2.0) };
    vec![
        ("$GPHDT,044.2,T*37", Sentence::Hdt(hdt)),
        ("$HCHDG,058.7,,,14.5,W*01", Sentence::Hdg(hdg)),
        ("$WIMWV,214.8,R,5.1,M,A*2B", wind(WindReference::Relative, 5.1, SpeedUnit::MetresPerSecond)),
        ("$WIMWV,214.8,T,9.9,N,A*2A", wind(WindReference::Theoretical, 9.9 * 1852.0 / 3600.0, SpeedUnit::Knots)),
        ("$VWVHW,044.2,T,058.7,M,2.00,N,3.70,K*5A", Sentence::Vhw(vhw)),
    ]
}

/// What we read but write otherwise: more or fewer fields, other zeros.
fn read_only() -> Vec<(&'static str, Sentence)> {
    let zero = Some(0.0);
    let vtg = Vtg {
        talker: Talker::GP,
        course_true_deg: zero,
        course_magnetic_deg: Some(12.7),
        speed_kn: Some(0.08),
        speed_km_h: Some(0.14),
        with_mode: false,
    };
    let hdg = Hdg { talker: Talker::HC, heading_deg: Some(58.7), deviation_deg: None, variation_deg: Some(-14.5) };
    vec![
        ("$PSEAC,L,0,0,,,*08", command(Mode::Standby, [zero, zero, None], "")),
        ("$PSEAC,T,90,40,14.16667,,*06", command(Mode::Thruster, [Some(90.0), Some(40.0), Some(14.16667)], "")),
        ("$PSEAC,G,90,1.943844,,,*13", command(Mode::Speed, [Some(90.0), Some(1.943844), None], "")),
        ("$PSEAC,F,000,000,000*32", command(Mode::FileDownload, [zero; 3], "")),
        ("$GPVTG,000.0,T,012.7,M,000.08,N,0000.14,K*77", Sentence::Vtg(vtg)),
        ("$HCHDG,58.7,,,14.5,W*31", Sentence::Hdg(hdg)),
    ]
}

fn command(mode: Mode, numbers: [Option<f64>; 3], words: &str) -> Sentence {
    let [heading_deg, thrust, difference] = numbers;
    Sentence::Command(Command { mode, heading_deg, thrust, difference, words: words.to_owned() })
}

#[test]
fn goldens_are_read_to_the_last_field() {
    for (line, want) in both_ways().into_iter().chain(read_only()) {
        let found = bodies(format!("{line}\r\n").as_bytes());
        assert_eq!(found.len(), 1, "{line} is a sentence");
        let got = Sentence::parse(&found[0]);
        let got = got.unwrap_or_else(|e| panic!("{line}: {e}"));
        // Minutes are no round fraction of a degree: the last bit may differ from what a person wrote.
        assert_eq!(printed(&got), printed(&want), "{line}");
    }
}

#[test]
fn goldens_are_written_to_the_byte() {
    for (line, sentence) in both_ways() {
        assert_eq!(written(&sentence), format!("{line}\r\n"));
    }
}

#[test]
fn what_we_write_in_our_own_way() {
    for (sentence, want) in [
        (command(Mode::Speed, [Some(90.0), Some(1.943_844), None], ""), "$PSEAC,G,90,1.944,,*"),
        (command(Mode::Speed, [Some(359.96), Some(2.0), Some(0.0)], ""), "$PSEAC,G,0,2,0,*"),
        (command(Mode::Heading, [Some(270.25), Some(34.6), None], ""), "$PSEAC,C,270.2,35,,*"),
        (command(Mode::Heading, [Some(-90.0), Some(-0.4), None], ""), "$PSEAC,C,270,0,,*"),
        (command(Mode::Thruster, [Some(359.5), Some(49.5), Some(-50.5)], ""), "$PSEAC,T,0,50,-50,*"),
        (command(Mode::Thruster, [Some(90.0), Some(40.0), Some(14.166_67)], ""), "$PSEAC,T,90,40,14,*"),
        (command(Mode::FileDownload, [None; 3], ""), "$PSEAC,F,000,000,000,*"),
        (command(Mode::FileDownload, [Some(12.0), None, None], ""), "$PSEAC,F,12,000,000,*"),
        (command(Mode::BootLoader, [None; 3], ""), "$PSEAC,!,,,,*"),
        (command(Mode::Standby, [Some(0.0); 3], "A,B*00\r\n$PSEAC"), "$PSEAC,L,0,0,0,*"),
        (command(Mode::Standby, [Some(0.0); 3], "A,B"), "$PSEAC,L,0,0,0,*"),
        (command(Mode::Standby, [Some(0.0); 3], "A*B"), "$PSEAC,L,0,0,0,*"),
        (command(Mode::Standby, [Some(0.0); 3], "$A"), "$PSEAC,L,0,0,0,*"),
        (command(Mode::Standby, [Some(0.0); 3], "A\n"), "$PSEAC,L,0,0,0,*"),
        (Sentence::BoatError(BoatError { code: "Ü".to_owned() }), "$PSEAG,*"),
    ] {
        let got = written(&sentence);
        assert!(got.starts_with(want), "{sentence:?} is {got:?}, expected {want:?}");
    }
}

#[test]
fn samples_that_circulate_with_a_wrong_checksum_are_refused() {
    for line in [
        "$PSEAR,0,000,10,0,000*7F",
        "$PSEAB,24.8,15433,1.3,22.3,42308,,,24.8,,1.3,0.0,0.0,,,26*71",
        "$PSEAD,1.5,T,2.5,0.5*7A",
        "$PSEAC,T,0,20,-10,*23",
        // The sum of a heading of 058.7.
        "$HCHDG,58.7,,,14.5,W*01",
    ] {
        assert_eq!(bodies(format!("{line}\r\n").as_bytes()), Vec::<String>::new(), "{line}");
    }
}

/// A sentence with its numbers to ten digits.
fn printed(sentence: &Sentence) -> String {
    format!("{sentence:.10?}")
}
