//! The port of a payload as users type it: `NAME=URL[,listen=HOST:PORT][,exo2[=http]]`.

use crate::link::LinkAddress;
use std::net::{Ipv4Addr, SocketAddr};
use std::str::FromStr;
use thiserror::Error;

const FORM: &str = "NAME=URL[,listen=HOST:PORT][,exo2|,exo2=http]";
const NAMES: &str = "1 to 32 letters, digits and _, a letter first";
/// Maximum length of a name.
const NAME_MAX: usize = 32;
/// Each payload has its own threads.
const PORTS_MAX: usize = 8;

/// A payload: its address, and where its clients connect.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct PayloadPort {
    /// Its name, which is part of topics.
    pub name: String,
    /// Its address.
    pub address: LinkAddress,
    /// Where clients connect; port 0 means any free port.
    pub listen: SocketAddr,
    /// The protocol of its EXO2 sonde, if it is one whose values are recorded.
    pub exo2: Option<Exo2Port>,
}

/// How an EXO2 sonde is queried.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Exo2Port {
    /// By its commands, one per line: its signal output adapter, directly or over a serial server.
    Lines,
    /// By HTTP: a server at the sonde accepts `GET /data`, and `POST /data` with a command as the
    /// body.
    Http,
}

/// An invalid payload port.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[error("{text:?}: {found}, allowed: {allowed}")]
pub struct PayloadPortError {
    /// The port as typed.
    pub text: String,
    /// The fault.
    pub found: String,
    /// The values allowed.
    pub allowed: String,
}

/// The fault, and the values allowed.
type Fault = (String, String);

impl FromStr for PayloadPort {
    type Err = PayloadPortError;

    fn from_str(text: &str) -> Result<PayloadPort, PayloadPortError> {
        parse(text).map_err(|(found, allowed)| PayloadPortError {
            text: text.to_owned(),
            found,
            allowed,
        })
    }
}

impl PayloadPort {
    /// Checks all of them together.
    ///
    /// # Errors
    /// [`PayloadPortError`] for a duplicate name, or too many payloads.
    pub fn check(ports: &[PayloadPort]) -> Result<(), PayloadPortError> {
        let error = |text: &str, found: &str, allowed: String| {
            Err(PayloadPortError {
                text: text.to_owned(),
                found: found.to_owned(),
                allowed,
            })
        };
        for (i, port) in ports.iter().enumerate() {
            if ports[..i].iter().any(|other| other.name == port.name) {
                return error(
                    &port.name,
                    "two payloads have this name",
                    "a name for each".to_owned(),
                );
            }
        }
        match ports.get(PORTS_MAX) {
            Some(surplus) => error(
                &surplus.name,
                "one payload too many",
                format!("up to {PORTS_MAX}"),
            ),
            None => Ok(()),
        }
    }
}

fn parse(text: &str) -> Result<PayloadPort, Fault> {
    let mut parts = text.split(',');
    let Some((name, url)) = parts.next().and_then(|first| first.split_once('=')) else {
        return Err(("it has no `=`".to_owned(), FORM.to_owned()));
    };
    let is_plain = name
        .bytes()
        .all(|byte| byte.is_ascii_alphanumeric() || byte == b'_');
    if !is_plain || !name.starts_with(|c: char| c.is_ascii_alphabetic()) || name.len() > NAME_MAX {
        return Err((format!("the name is {name:?}"), NAMES.to_owned()));
    }
    let address = LinkAddress::to_connect(url).map_err(|e| {
        (
            format!("the URL is {url:?}: {}", e.found),
            e.allowed.to_owned(),
        )
    })?;
    // Loopback by default: anybody who reaches this port reaches the payload, without a token.
    let any = SocketAddr::from((Ipv4Addr::LOCALHOST, 0));
    let mut port = PayloadPort {
        name: name.to_owned(),
        address,
        listen: any,
        exo2: None,
    };
    parts.try_for_each(|option| set(&mut port, option))?;
    match (&port.address, port.exo2) {
        (LinkAddress::Tcp(..), _) | (_, None | Some(Exo2Port::Lines)) => Ok(port),
        _ => Err((
            "exo2=http requires a TCP address".to_owned(),
            "exo2=http with tcp://HOST:PORT".to_owned(),
        )),
    }
}

fn set(port: &mut PayloadPort, option: &str) -> Result<(), Fault> {
    match option.split_once('=').unwrap_or((option, "")) {
        ("listen", address) => {
            port.listen = address.parse().map_err(|_| {
                let allowed = "an address of this machine and a port, as 127.0.0.1:5000; port 0 is any free one";
                (format!("listen is {address:?}"), allowed.to_owned())
            })?;
        }
        ("exo2", "") if option == "exo2" => port.exo2 = Some(Exo2Port::Lines),
        ("exo2", "http") => port.exo2 = Some(Exo2Port::Http),
        _ => return Err((format!("an option is {option:?}"), FORM.to_owned())),
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ports_are_understood_with_all_their_options() {
        let read = |text: &str| {
            text.parse::<PayloadPort>()
                .unwrap_or_else(|e| panic!("{e}"))
        };
        let camera = read("camera=tcp://192.168.1.23:5001");
        assert_eq!(
            camera.address,
            LinkAddress::to_connect("tcp://192.168.1.23:5001").expect("an address")
        );
        assert_eq!(
            (camera.name.as_str(), camera.listen.to_string().as_str()),
            ("camera", "127.0.0.1:0")
        );
        assert_eq!(camera.exo2, None);
        let sonde = read("sonde_2=tcp://[::1]:5000,exo2=http,listen=0.0.0.0:5000");
        assert_eq!(
            (sonde.exo2, sonde.listen.to_string().as_str()),
            (Some(Exo2Port::Http), "0.0.0.0:5000")
        );
        let serial = read("s=serial:///dev/ttyUSB0?baud=9600,exo2");
        assert_eq!(
            (serial.exo2, serial.address.to_string().as_str()),
            (Some(Exo2Port::Lines), "serial:///dev/ttyUSB0?baud=9600")
        );
    }

    #[test]
    fn what_is_wrong_is_told_with_what_is_allowed() {
        for (text, found, allowed) in [
            ("tcp://1.2.3.4:5", "it has no `=`", "NAME=URL"),
            ("=tcp://1.2.3.4:5", "the name is \"\"", "a letter first"),
            (
                "a/b=tcp://1.2.3.4:5",
                "the name is \"a/b\"",
                "letters, digits and _",
            ),
            (
                "2nd=tcp://1.2.3.4:5",
                "the name is \"2nd\"",
                "a letter first",
            ),
            ("cam=tcp://1.2.3.4", "it has no port", "HOST:PORT"),
            (
                "cam=http://1.2.3.4:80",
                "the scheme is \"http\"",
                "tcp://HOST:PORT",
            ),
            ("cam=pty", "it has no `://`", "tcp://HOST:PORT"),
            (
                "cam=tcp://1.2.3.4:5,listen=5000",
                "listen is \"5000\"",
                "127.0.0.1:5000",
            ),
            (
                "cam=tcp://1.2.3.4:5,exo=1",
                "an option is \"exo=1\"",
                "exo2=http",
            ),
            (
                "cam=tcp://1.2.3.4:5,exo2=",
                "an option is \"exo2=\"",
                "exo2=http",
            ),
            (
                "cam=tcp://1.2.3.4:5,",
                "an option is \"\"",
                "listen=HOST:PORT",
            ),
            (
                "cam=udp://1.2.3.4:5,exo2=http",
                "requires a TCP address",
                "tcp://",
            ),
        ] {
            let error = text.parse::<PayloadPort>().expect_err(text);
            assert!(
                error.found.contains(found) && error.allowed.contains(allowed),
                "{text}: {error}"
            );
        }
        let port = |i: usize| {
            format!("p{i}=tcp://1.2.3.4:5")
                .parse::<PayloadPort>()
                .expect("a port")
        };
        let check = |numbers: &[usize]| {
            PayloadPort::check(&numbers.iter().map(|i| port(*i)).collect::<Vec<_>>())
        };
        assert_eq!(check(&[1, 2, 3]), Ok(()));
        assert!(
            check(&[1, 2, 1]).is_err_and(|e| e.to_string().contains("two payloads have this name"))
        );
        assert!(
            check(&[0, 1, 2, 3, 4, 5, 6, 7, 8]).is_err_and(|e| e.to_string().contains("up to 8"))
        );
    }
}
