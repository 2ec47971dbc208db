//! Addresses as people type them.

use gateway::link::HostPort;
use gateway::link::LinkAddress::{self, Pty, Serial, Tcp, Udp};
use gateway::link::Side::{Connects, Listens};

fn at(host: &str, port: u16) -> HostPort {
    HostPort { host: host.to_owned(), port }
}

fn serial(path: &str, baud: u32) -> LinkAddress {
    Serial { path: path.into(), baud }
}

#[test]
fn what_a_client_may_connect_to_is_read_and_printed_again() {
    for (text, want) in [
        ("tcp://192.168.1.11:8003", Tcp(Connects, at("192.168.1.11", 8003))),
        ("tcp://boat-1.local:1", Tcp(Connects, at("boat-1.local", 1))),
        ("tcp://[::1]:65535", Tcp(Connects, at("::1", 65535))),
        ("udp://127.0.0.1:10110", Udp(Connects, at("127.0.0.1", 10110))),
        ("udp://[fe80::1%eth0]:7", Udp(Connects, at("fe80::1%eth0", 7))),
        ("serial:///dev/ttyUSB0?baud=38400", serial("/dev/ttyUSB0", 38400)),
        ("serial:///dev/pts/3?baud=4800", serial("/dev/pts/3", 4800)),
        ("serial:///dev/ttyS0?baud=115200", serial("/dev/ttyS0", 115_200)),
    ] {
        let got = LinkAddress::to_connect(text).unwrap();
        assert_eq!(got, want, "{text}");
        assert_eq!(got.to_string(), text);
    }
    assert_eq!(LinkAddress::to_connect("serial:///dev/ttyACM0").unwrap(), serial("/dev/ttyACM0", 38400));
}

#[test]
fn what_a_server_may_listen_on_is_read_and_printed_again() {
    for (text, want) in [
        ("tcp://0.0.0.0:8003", Tcp(Listens, at("0.0.0.0", 8003))),
        ("tcp://127.0.0.1:0", Tcp(Listens, at("127.0.0.1", 0))),
        ("tcp://[::]:8003", Tcp(Listens, at("::", 8003))),
        ("udp://127.0.0.1:0", Udp(Listens, at("127.0.0.1", 0))),
        ("serial:///dev/ttyUSB1?baud=9600", serial("/dev/ttyUSB1", 9600)),
        ("pty", Pty { link: None }),
        ("pty:///tmp/boat", Pty { link: Some("/tmp/boat".into()) }),
    ] {
        let got = LinkAddress::to_listen(text).unwrap();
        assert_eq!(got, want, "{text}");
        assert_eq!(got.to_string(), text);
    }
}

#[test]
fn what_is_no_address_is_refused_with_what_was_found_and_what_is_allowed() {
    let both = [LinkAddress::to_connect, LinkAddress::to_listen];
    for (text, found, allowed) in [
        ("", "no `://`", "tcp://HOST:PORT"),
        ("192.168.1.11:8003", "no `://`", "tcp://HOST:PORT"),
        ("/dev/ttyUSB0", "no `://`", "serial:///dev"),
        ("TCP://a:1", "the scheme is \"TCP\"", "tcp://HOST:PORT"),
        ("http://a:1", "the scheme is \"http\"", "udp://HOST:PORT"),
        ("tcp://", "no port", "HOST:PORT"),
        ("tcp://boat", "no port", "HOST:PORT"),
        ("tcp://[::1]", "no port", "HOST:PORT"),
        ("tcp://:8003", "the host is \"\"", "0.0.0.0"),
        ("tcp://[]:8003", "the host is \"[]\"", "IPv6"),
        ("tcp://::1:8003", "the host is \"::1\"", "brackets"),
        ("tcp://a b:8003", "the host is \"a b\"", "a name"),
        ("tcp://me@boat:8003", "the host is \"me@boat\"", "a name"),
        ("tcp://boat:", "the port is \"\"", "65535"),
        ("tcp://boat:65536", "the port is \"65536\"", "65535"),
        ("tcp://boat:-1", "the port is \"-1\"", "65535"),
        ("tcp://boat:+80", "the port is \"+80\"", "65535"),
        ("tcp://boat:8003/", "the port is \"8003/\"", "65535"),
        ("udp://boat:eight", "the port is \"eight\"", "65535"),
        ("serial://", "the path is \"\"", "three slashes"),
        ("serial:///", "the path is \"/\"", "three slashes"),
        ("serial://ttyUSB0", "the path is \"ttyUSB0\"", "three slashes"),
        ("serial:///dev/ttyUSB0?baud=38401", "baud is \"38401\"", "4800, 9600, 19200, 38400, 57600, 115200"),
        ("serial:///dev/ttyUSB0?baud=+9600", "baud is \"+9600\"", "9600"),
        ("serial:///dev/ttyUSB0?baud=", "baud is \"\"", "9600"),
        ("serial:///dev/ttyUSB0?", "\"\" follows", "baud=38400"),
        ("serial:///dev/ttyUSB0?parity=even", "\"parity=even\" follows", "baud=38400"),
    ] {
        for parse in both {
            let error = parse(text).unwrap_err().to_string();
            assert!(error.contains(&format!("{text:?}")), "{text}: {error}");
            assert!(error.contains(found), "{text} should name {found}: {error}");
            assert!(error.contains(allowed), "{text} should allow {allowed}: {error}");
        }
    }
}

#[test]
fn some_are_right_for_one_side_only() {
    for (text, found) in [
        ("tcp://boat:0", "the port is \"0\", allowed: 1 to 65535"),
        ("udp://boat:0", "the port is \"0\", allowed: 1 to 65535"),
        ("pty", "no `://`"),
        ("pty:///tmp/boat", "a pty can only be listened on"),
    ] {
        assert!(LinkAddress::to_listen(text).is_ok(), "{text}");
        let error = LinkAddress::to_connect(text).unwrap_err().to_string();
        assert!(error.contains(found), "{text} should say {found}: {error}");
    }
    let error = LinkAddress::to_listen("pty://tmp").unwrap_err().to_string();
    assert!(error.contains("the path is \"tmp\""), "{error}");
}
