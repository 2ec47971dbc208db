//! Tests the sensor check: missing data, and the reasons.

use super::*;
use crate::nmea::with_checksum;

const TELEMETRY: &str = "$GPGGA,150502.00,4221.50616,N,07105.24688,W,2,11,0.98,5.5,M,-33.2,M,,*62\r\n\
    $PSEAA,-2.2,0.7,222.6,,47.8,-0.04,-0.01,-1.00,-0.01*7A\r\n\
    $PSEAD,T,58.7,20,-10,,T,2,1*7A\r\n\
    $PTQM0,1*35\r\n";

/// The check after these sentences have arrived ten times; the time in a GGA advances each time.
fn checked(text: &str, hz: f64) -> SensorCheck {
    let mut check = SensorCheck::new(&crate::config::default_gateway());
    for i in 0..10 {
        let text = text.replace("150502.00", &format!("150502.{i}0"));
        // Only the time of day changes, by one digit.
        let text = text.replace("M,,*62", &format!("M,,*{:02X}", 0x62 ^ i));
        check.receive(SimTime::from_s(f64::from(i) / hz), text.as_bytes());
    }
    check
}

/// 15:05:03.30 on this day of November 2026, at time 0.
fn host(day: u64) -> HostTime {
    HostTime {
        now: SimTime::ZERO,
        utc_ns: (1_793_491_200 + 86_400 * (day - 1)) * 1_000_000_000 + 54_303_300_000_000,
    }
}

#[test]
fn sentences_are_counted_and_missing_ones_are_named() {
    let check = checked(TELEMETRY, 10.0);
    let gga = &check.received["GPGGA"];
    assert_eq!((gga.count, gga.unreadable), (10, 0));
    assert!((gga.rate_hz().unwrap_or(0.0) - 10.0).abs() < 1e-9);
    assert_eq!(check.received["PTQM0"].unreadable, 10);
    let missing = check.missing().join("\n");
    for want in ["VTG or RMC", "PSEAB", "the operator ashore must enable it"] {
        assert!(missing.contains(want), "{missing}");
    }
    assert!(
        !missing.contains("GGA") && !missing.contains("PSEAA"),
        "{missing}"
    );
}

#[test]
fn findings_are_in_words() {
    let host = host(20);
    let findings = checked(TELEMETRY, 10.0).findings(host).join("\n");
    for want in [
        "position: 42.358436, -71.087448, fix quality 2 (DGPS), dilution 0.98",
        "heading: 222.6 by its compass; no true heading",
        "control: mode T (Thruster), commanded by Primary",
        "clock: fixes are 1.30 s behind this host's clock; it sends no date",
    ] {
        assert!(findings.contains(want), "{want} is not in\n{findings}");
    }
    let with_true = format!("{TELEMETRY}$GPHDT,209.1,T*3F\r\n");
    assert!(
        checked(&with_true, 10.0)
            .findings(host)
            .join("\n")
            .contains("is relative to magnetic north")
    );
}

#[test]
fn what_came_but_cannot_be_used_is_missing_with_the_reason() {
    for (body, want) in [
        (
            "GPGGA,150503.00,4121.2880,N,7403.3060,W,1,12,0.9,12.0,M,-33.2,M,,",
            "a position: GPGGA field 4 is \"7403.3060\", expected dddmm.mmmm up to 180 degrees",
        ),
        (
            "GPGGA,150503.00,4121.2880,N,07403.3060,W,1,12,.9,12.0,M,-33.2,M,,",
            "a position: GPGGA field 8 is \".9\", expected a number or an empty field",
        ),
        (
            "GPGGA,150503.00,,,,,1,12,0.9,12.0,M,-33.2,M,,",
            "a position: its fix has quality 1",
        ),
        (
            "GPGGA,150503.00,0000.00000,N,00000.00000,E,1,12,0.9,1,M,1,M,,",
            "a position: missing in GPGGA",
        ),
        // The receiver's time does not advance.
        (
            "GPGGA,150503.00,4121.2880,N,07403.3060,W,1,12,0.9,12.0,M,-33.2,M,,",
            "GGA or RMC bring new data only 0.00 times",
        ),
        (
            "PSEAA,-2.2,0.7,,,47.8,-0.04,-0.01,-1.00,-0.01",
            "a heading: missing in PSEAA",
        ),
        (
            "PSEAA,-2.2,0.7,400,,47.8,-0.04,-0.01,-1.00,-0.01",
            "a heading: missing in PSEAA",
        ),
        ("GPVTG,,T,,M,,N,,K", "a velocity: missing in GPVTG"),
        (
            "PSEAB,,98,1.2,24.0,10,,,26.4,26.4,1.0,0.1,0.1,0.0,0.0,12",
            "a voltage: missing in PSEAB",
        ),
    ] {
        let missing = checked(&with_checksum(body), 10.0).missing().join("\n");
        assert!(missing.contains(want), "{body}: {missing}");
    }
}

#[test]
fn a_link_without_sentences_says_what_came() {
    for (stream, want) in [
        (
            "$PSEAG,N\r\n",
            "received 10 lines, none of them a valid sentence: $PSEAG,N has no checksum",
        ),
        (
            "$PSEAG,N*23\r\n",
            "received 10 lines, none of them a valid sentence: $PSEAG,N*23 has a wrong checksum",
        ),
        (
            "\u{1}\u{2}",
            "received 20 bytes, none of them readable: check the protocol and the baud rate",
        ),
        ("", "received nothing"),
    ] {
        let check = checked(stream, 10.0);
        assert!(
            check.received.is_empty() && check.unread() == want,
            "{}",
            check.unread()
        );
    }
    let gateway = crate::config::default_gateway();
    let mut check = SensorCheck::new(&Gateway {
        protocol: BoatProtocol::Mavlink,
        ..gateway
    });
    check.receive(SimTime::ZERO, TELEMETRY.as_bytes());
    assert!(
        check
            .unread()
            .contains("bytes of NMEA sentences, expected MAVLink"),
        "{}",
        check.unread()
    );
}

#[test]
fn a_date_that_is_not_the_hosts_is_a_fault_and_midnight_is_none() {
    let zda = |date: &str| with_checksum(&format!("GPZDA,150502.00,{date},00,00"));
    let fault = |date: &str, host| checked(&zda(date), 10.0).clock_fault(host);
    assert_eq!(fault("20,11,2026", host(20)), None);
    for (date, want) in [
        (
            "06,04,2007",
            "the date is 7168 days behind this host's, as after a GPS week rollover (7168 days)",
        ),
        (
            "18,04,2005",
            "the date is 7886 days behind this host's, as after a GPS week rollover",
        ),
        (
            "19,11,2026",
            "the date is 1 day behind this host's: one of the two is wrong",
        ),
        (
            "21,11,2026",
            "the date is 1 day AHEAD of this host's: one of the two is wrong",
        ),
    ] {
        let found = fault(date, host(20)).unwrap_or_default();
        assert!(found.starts_with(want), "{found}");
    }
    // Two seconds after midnight, a fix from the evening before is merely delayed.
    let midnight = HostTime {
        utc_ns: host(21).utc_ns - 54_303_300_000_000 + 2_000_000_000,
        ..host(21)
    };
    assert_eq!(fault("20,11,2026", midnight), None);
    let gga = checked(TELEMETRY, 10.0);
    let late = HostTime {
        utc_ns: host(20).utc_ns + 7_000_000_000,
        ..host(20)
    };
    assert!(
        gga.clock_fault(late)
            .is_some_and(|fault| fault.contains("behind this host's clock: one of"))
    );
}

#[test]
fn a_low_rate_is_reported() {
    assert!(
        checked(TELEMETRY, 0.5)
            .missing()
            .join("\n")
            .contains("GGA or RMC bring new data only 0.50 times a second")
    );
}
