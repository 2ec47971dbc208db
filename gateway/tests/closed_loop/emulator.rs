//! Tests the emulated boat alone: what it ignores and what it sends. The other tests are in
//! `scenarios/emulator.txt`.

use crate::boat::emulated;
use crate::rig::datum;
use crate::script::played;
use gateway::emulator::{self, Emulator, Extra, FrontSeat, Port};
use gateway::nmea::{Sentence, with_checksum};
use messages::Order;
use primitives::SimTime;

fn boat(change: impl FnOnce(&mut emulator::Plan)) -> Emulator {
    let mut plan = emulated(datum(), 0.0);
    change(&mut plan);
    Emulator::new(plan)
}

fn send(boat: &mut Emulator, body: &str) {
    boat.receive(
        SimTime::ZERO,
        Port::Secondary,
        with_checksum(body).as_bytes(),
    );
    // The boat does nothing without a position.
    let own = messages::picture::OwnBoat::new(
        primitives::VehicleId(0),
        messages::picture::Nav::default(),
    );
    boat.observe(SimTime::ZERO, &own);
}

fn thrust(port: f64, starboard: f64) -> Order {
    Order::Thrust { port, starboard }
}

#[test]
fn invalid_commands_change_nothing() {
    let mut boat = boat(|_| ());
    send(&mut boat, "PSEAC,T,0,20,0,");
    for bytes in [
        &b"$PSEAC,T,0,90,0,*00\r\n"[..],
        b"$PSEAC,X,0,90,0,*27\r\n",
        b"$PGRMCE*0E\r\n$PSRF100,1*0E\r\n\x8e\xff\x00",
        b"PSEAC,T,0,90,0,\r\n",
    ] {
        boat.receive(SimTime::ZERO, Port::Secondary, bytes);
        assert_eq!(boat.order(SimTime::ZERO), thrust(0.2, 0.2), "{bytes:?}");
    }
}

#[test]
fn telemetry_is_what_the_strictest_known_reader_takes_even_in_standby() {
    let rig = played("boat\nrun 1\nexpect mode = L");
    let mut burst = vec![];
    rig.emulator.telemetry(rig.now, &mut burst);
    let text = String::from_utf8(burst).expect("text");
    let fields = |name: &str| {
        let line = text
            .lines()
            .find(|line| line.starts_with(name))
            .unwrap_or_else(|| panic!("no {name} in {text}"));
        let (body, sum) = line[1..].split_once('*').expect("a checksum");
        assert_eq!(
            sum,
            format!("{:02X}", body.bytes().fold(0, |a, b| a ^ b)),
            "{line}"
        );
        assert!(
            (10..=80).contains(&line.len()) && line.as_bytes()[6] == b',',
            "{line}"
        );
        body.split(',')
            .skip(1)
            .map(str::to_owned)
            .collect::<Vec<_>>()
    };
    let gga = fields("$GPGGA");
    assert_eq!(
        (gga.len(), gga[5].as_str(), gga[13].as_str()),
        (14, "2", ""),
        "the last field is empty: {gga:?}"
    );
    assert_eq!(fields("$GPVTG").len(), 8, "new boats omit the mode");
    let attitude = fields("$PSEAA");
    assert_eq!(
        (attitude.len(), attitude[3].as_str()),
        (9, ""),
        "no heave: {attitude:?}"
    );
    assert_eq!((fields("$PSEAB").len(), fields("$PSEAD").len()), (15, 8));
    assert_eq!(fields("$PSEAD")[7], "2");
    assert_eq!(fields("$PSEAG"), ["N"]);
    assert_eq!(text.lines().count(), 6);
}

#[test]
fn extra_sentences_agree_with_the_others() {
    let mut boat = boat(|plan| {
        plan.declination_rad = (-12.5_f64).to_radians();
        plan.extra = vec![Extra::Rmc, Extra::Hdt, Extra::Hdg, Extra::Zda];
    });
    send(&mut boat, "PSEAC,L,0,0,0,");
    let mut burst = vec![];
    boat.telemetry(SimTime::from_s(1.0), &mut burst);
    let text = String::from_utf8(burst).expect("text");
    let sentences: Vec<Sentence> = text
        .lines()
        .map(|line| {
            Sentence::parse(line[1..].split('*').next().expect("a body"))
                .unwrap_or_else(|e| panic!("{e}"))
        })
        .collect();
    let find =
        |pick: fn(&Sentence) -> Option<f64>| sentences.iter().find_map(pick).expect("it is sent");
    let hdt = find(|s| {
        if let Sentence::Hdt(hdt) = s {
            hdt.heading_deg
        } else {
            None
        }
    });
    let hdg = find(|s| {
        if let Sentence::Hdg(hdg) = s {
            hdg.heading_deg
        } else {
            None
        }
    });
    let compass = find(|s| {
        if let Sentence::Attitude(attitude) = s {
            attitude.heading_deg
        } else {
            None
        }
    });
    assert!(
        hdt.abs() < 0.05 && (hdg - 12.5).abs() < 0.05 && (compass - 12.5).abs() < 0.05,
        "{hdt} {hdg} {compass}"
    );
    assert!(
        text.contains("$GPRMC,")
            && text.contains(",201126,")
            && text.contains("$GPZDA,150503.00,20,11,2026"),
        "{text}"
    );
}
