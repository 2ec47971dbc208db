//! Our codec as a peer of `pynmea2_check.py`: `peer write` writes sentences of every kind with their values,
//! `peer read` prints the values that it reads in the lines of its input.
//!
//! The values of a sentence are a line of `name=value`, tab-separated; a missing value is empty.

use game::LatLon;
use gateway::nmea::{
    Attitude, Battery, BoatError, Command, ControlState, Date, Framer, Gga, Gll, Hdg, Hdt, MissionSettings, Mode, Mwv,
    Operator, Rmc, Sentence, SpeedUnit, Talker, TimeOfDay, Vhw, Vtg, Waypoint, WindReference, Zda,
};
use std::io::{BufRead, Write};

/// Sentences of each kind that `write` writes.
const ROUNDS: u32 = 200;

fn main() {
    match std::env::args().nth(1).as_deref() {
        Some("write") => write(),
        Some("read") => read(),
        _ => eprintln!("usage: peer write | peer read"),
    }
}

fn write() {
    let mut dice = Dice(0x5EA);
    let mut out = std::io::stdout().lock();
    for _ in 0..ROUNDS {
        for sentence in boat_sentences(&mut dice).into_iter().chain(standard_sentences(&mut dice)) {
            let mut wire = Vec::new();
            sentence.write(&mut wire);
            let wire = String::from_utf8(wire).expect("a sentence is ASCII");
            writeln!(out, "{}\t{}", wire.trim_end(), values(&sentence)).expect("standard output is open");
        }
    }
}

fn read() {
    let mut framer = Framer::new();
    for line in std::io::stdin().lock().lines() {
        let line = line.expect("lines of text come in") + "\r\n";
        let mut answer = "not a sentence".to_owned();
        framer.push(line.as_bytes(), &mut |body| {
            answer = Sentence::parse(body).map_or_else(|error| error.to_string(), |sentence| values(&sentence));
        });
        println!("{answer}");
    }
}

/// The values of a sentence.
fn values(sentence: &Sentence) -> String {
    let pairs: Vec<(&str, String)> = match sentence {
        Sentence::Command(c) => vec![
            ("mode", c.mode.letter().to_string()),
            ("heading", number(c.heading_deg)),
            ("thrust", number(c.thrust)),
            ("difference", number(c.difference)),
            ("words", c.words.clone()),
        ],
        Sentence::Attitude(a) => vec![
            ("pitch", number(a.pitch_deg)),
            ("roll", number(a.roll_deg)),
            ("heading", number(a.heading_deg)),
            ("box", number(a.box_c)),
            ("ahead", number(a.accel_ahead_g)),
            ("starboard", number(a.accel_starboard_g)),
            ("down", number(a.accel_down_g)),
            ("yaw_rate", number(a.yaw_rate_deg_s)),
        ],
        Sentence::Battery(b) => vec![
            ("volts", number(b.volts)),
            ("charge", number(b.charge)),
            ("amps", number(b.amps)),
            ("celsius", number(b.celsius)),
            ("charge_used", number(b.charge_used)),
            ("reset_time", b.reset_time.clone()),
            ("reset_date", b.reset_date.clone()),
            ("port_volts", number(b.port_volts)),
            ("system_amps", number(b.system_amps)),
            ("hours", number(b.hours)),
        ],
        Sentence::ControlState(s) => vec![
            ("mode", s.mode.letter().to_string()),
            ("heading", number(s.heading_deg)),
            ("thrust", number(s.thrust)),
            ("difference", number(s.difference)),
            ("words", s.words.clone()),
            ("transmission", s.transmission.map_or_else(String::new, String::from)),
            ("sent_to", s.sent_to.map_or_else(String::new, |number| number.to_string())),
            ("operator", s.operator.map_or_else(String::new, |operator| operator.number().to_string())),
        ],
        Sentence::BoatError(e) => vec![("code", e.code.clone())],
        Sentence::MissionSettings(m) => vec![("throttle", m.throttle_pct.to_string())],
        Sentence::Waypoint(w) => {
            vec![("lat", w.at.lat_deg.to_string()), ("lon", w.at.lon_deg.to_string()), ("index", w.index.to_string())]
        }
        other => standard_values(other),
    };
    pairs.iter().map(|(name, value)| format!("{name}={value}")).collect::<Vec<_>>().join("\t")
}

fn standard_values(sentence: &Sentence) -> Vec<(&'static str, String)> {
    let lat = |at: Option<LatLon>| ("lat", number(at.map(|at| at.lat_deg)));
    let lon = |at: Option<LatLon>| ("lon", number(at.map(|at| at.lon_deg)));
    let time = |time: Option<TimeOfDay>| ("time", number(time.map(|time| f64::from(time.0))));
    let date = |date: Option<Date>| {
        ("date", date.map_or_else(String::new, |d| format!("{:04}-{:02}-{:02}", d.year, d.month, d.day)))
    };
    match sentence {
        Sentence::Gga(g) => vec![
            time(g.time),
            lat(g.at),
            lon(g.at),
            ("quality", g.quality.to_string()),
            ("satellites", g.satellites.map_or_else(String::new, |number| number.to_string())),
            ("hdop", number(g.hdop)),
            ("altitude", number(g.altitude_m)),
            ("geoid", number(g.geoid_m)),
        ],
        Sentence::Rmc(r) => vec![
            time(r.time),
            ("valid", r.valid.to_string()),
            lat(r.at),
            lon(r.at),
            ("speed", number(r.speed_kn)),
            ("course", number(r.course_deg)),
            date(r.date),
        ],
        Sentence::Vtg(v) => vec![
            ("true", number(v.course_true_deg)),
            ("magnetic", number(v.course_magnetic_deg)),
            ("knots", number(v.speed_kn)),
            ("km_h", number(v.speed_km_h)),
        ],
        Sentence::Hdt(h) => vec![("heading", number(h.heading_deg))],
        Sentence::Hdg(h) => vec![
            ("heading", number(h.heading_deg)),
            ("deviation", number(h.deviation_deg)),
            ("variation", number(h.variation_deg)),
        ],
        Sentence::Zda(z) => vec![time(z.time), date(z.date)],
        Sentence::Gll(g) => vec![lat(g.at), lon(g.at), time(g.time), ("valid", g.valid.to_string())],
        Sentence::Mwv(m) => vec![
            ("angle", number(m.angle_deg)),
            ("reference", if m.reference == WindReference::Relative { "R" } else { "T" }.to_owned()),
            ("m_s", number(m.speed_m_s)),
            ("valid", m.valid.to_string()),
        ],
        Sentence::Vhw(v) => vec![
            ("true", number(v.heading_true_deg)),
            ("magnetic", number(v.heading_magnetic_deg)),
            ("knots", number(v.speed_kn)),
        ],
        other => panic!("{other:?} is no sentence of the standard"),
    }
}

fn number(number: Option<f64>) -> String {
    number.map_or_else(String::new, |number| number.to_string())
}

/// xorshift64*.
struct Dice(u64);

impl Dice {
    fn roll(&mut self) -> u64 {
        self.0 ^= self.0 >> 12;
        self.0 ^= self.0 << 25;
        self.0 ^= self.0 >> 27;
        self.0.wrapping_mul(0x2545_F491_4F6C_DD1D) >> 16
    }

    fn among<T: Copy>(&mut self, all: &[T]) -> T {
        all[self.roll() as usize % all.len()]
    }

    fn whole(&mut self, end: u64) -> u64 {
        self.roll() % end
    }

    fn real(&mut self, from: f64, to: f64) -> f64 {
        from + (to - from) * (self.whole(1 << 40) as f64 / (1_u64 << 40) as f64)
    }

    /// One in eight is missing.
    fn maybe(&mut self, from: f64, to: f64) -> Option<f64> {
        let real = self.real(from, to);
        (self.whole(8) > 0).then_some(real)
    }

    fn at(&mut self) -> LatLon {
        LatLon { lat_deg: self.real(-90.0, 90.0), lon_deg: self.real(-180.0, 180.0) }
    }

    fn time(&mut self) -> TimeOfDay {
        TimeOfDay(self.whole(86_400_000) as u32)
    }

    fn date(&mut self) -> Date {
        Date { year: 2000 + self.whole(60) as u16, month: 1 + self.whole(12) as u8, day: 1 + self.whole(28) as u8 }
    }
}

fn boat_sentences(dice: &mut Dice) -> Vec<Sentence> {
    let words = ["", "THR_ON", "GPS_ON"];
    vec![
        Sentence::Command(Command {
            mode: dice.among(&[Mode::Thruster, Mode::Heading, Mode::Speed, Mode::Standby, Mode::BootLoader]),
            heading_deg: dice.maybe(0.0, 359.4),
            thrust: dice.maybe(-50.0, 50.0),
            difference: dice.maybe(-50.0, 50.0),
            words: dice.among(&words).to_owned(),
        }),
        Sentence::Attitude(Attitude {
            pitch_deg: dice.maybe(-9.0, 9.0),
            roll_deg: dice.maybe(-9.0, 9.0),
            heading_deg: dice.maybe(0.0, 359.9),
            heave_m: None,
            box_c: dice.maybe(-20.0, 80.0),
            accel_ahead_g: dice.maybe(-2.0, 2.0),
            accel_starboard_g: dice.maybe(-2.0, 2.0),
            accel_down_g: dice.maybe(-2.0, 2.0),
            yaw_rate_deg_s: dice.maybe(-30.0, 30.0),
        }),
        Sentence::Battery(Battery {
            volts: dice.maybe(20.0, 29.0),
            charge: dice.maybe(0.0, 50_000.0),
            amps: dice.maybe(0.0, 9.0),
            celsius: dice.maybe(-9.0, 60.0),
            charge_used: dice.maybe(0.0, 50_000.0),
            reset_time: dice.among(&["", "120000"]).to_owned(),
            reset_date: String::new(),
            port_volts: dice.maybe(20.0, 29.0),
            system_amps: dice.maybe(0.0, 9.0),
            hours: dice.maybe(0.0, 9000.0),
            ..Battery::default()
        }),
        Sentence::ControlState(ControlState {
            mode: dice.among(&[Mode::Thruster, Mode::Heading, Mode::Speed, Mode::Waypoint]),
            heading_deg: dice.maybe(0.0, 359.9),
            thrust: dice.maybe(-50.0, 50.0),
            difference: dice.maybe(-50.0, 50.0),
            words: dice.among(&words).to_owned(),
            transmission: Some(dice.among(&['T', 'F', 'R', 'N'])),
            sent_to: Some(dice.whole(7) as u8),
            operator: Some(Operator::from_number(dice.whole(7) as u8)),
        }),
        Sentence::BoatError(BoatError { code: dice.among(&["N", "L", "42"]).to_owned() }),
        Sentence::MissionSettings(MissionSettings { throttle_pct: dice.real(0.0, 70.0) }),
        Sentence::Waypoint(Waypoint { at: dice.at(), index: dice.whole(65_536) as u16 }),
    ]
}

fn standard_sentences(dice: &mut Dice) -> Vec<Sentence> {
    let talker = dice.among(&[Talker::GP, Talker::GN, Talker::HC, Talker::WI]);
    let fixed = dice.whole(8) > 0;
    let knots = dice.maybe(0.0, 30.0);
    let (at, time, date) = (fixed.then(|| dice.at()), fixed.then(|| dice.time()), fixed.then(|| dice.date()));
    vec![
        Sentence::Gga(Gga {
            talker,
            time,
            at,
            quality: dice.whole(9) as u8,
            satellites: Some(dice.whole(40) as u8),
            hdop: dice.maybe(0.5, 20.0),
            altitude_m: dice.maybe(-90.0, 900.0),
            geoid_m: dice.maybe(-90.0, 90.0),
        }),
        Sentence::Rmc(Rmc {
            talker,
            time,
            valid: fixed,
            at,
            speed_kn: knots,
            course_deg: dice.maybe(0.0, 359.9),
            date,
        }),
        Sentence::Vtg(Vtg {
            talker,
            course_true_deg: dice.maybe(0.0, 359.9),
            course_magnetic_deg: dice.maybe(0.0, 359.9),
            speed_kn: knots,
            speed_km_h: knots.map(|knots| knots * 1.852),
            with_mode: fixed,
        }),
        Sentence::Hdt(Hdt { talker, heading_deg: dice.maybe(0.0, 359.9) }),
        Sentence::Hdg(Hdg {
            talker,
            heading_deg: dice.maybe(0.0, 359.9),
            deviation_deg: dice.maybe(-9.0, 9.0),
            variation_deg: dice.maybe(-30.0, 30.0),
        }),
        Sentence::Zda(Zda { talker, time, date }),
        Sentence::Gll(Gll { talker, at, time, valid: fixed }),
        Sentence::Mwv(Mwv {
            talker,
            angle_deg: dice.maybe(0.0, 359.9),
            reference: dice.among(&[WindReference::Relative, WindReference::Theoretical]),
            speed_m_s: dice.maybe(0.0, 40.0),
            unit: dice.among(&[
                SpeedUnit::MetresPerSecond,
                SpeedUnit::KilometresPerHour,
                SpeedUnit::Knots,
                SpeedUnit::MilesPerHour,
            ]),
            valid: fixed,
        }),
        Sentence::Vhw(Vhw {
            talker,
            heading_true_deg: dice.maybe(0.0, 359.9),
            heading_magnetic_deg: dice.maybe(0.0, 359.9),
            speed_kn: knots,
        }),
    ]
}
