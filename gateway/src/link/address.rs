//! Link addresses as users type them, such as `tcp://HOST:PORT`.

use std::fmt;
use std::path::PathBuf;
use thiserror::Error;

/// Supported speeds of a serial line, baud.
// The serial speed and format of a Surveyor are not published. These speeds, with 8N1, are common
// for NMEA devices. RTK receivers use the faster ones, and autopilots' telemetry ports use 921600.
const BAUDS: [u32; 9] = [
    4800, 9600, 19_200, 38_400, 57_600, 115_200, 230_400, 460_800, 921_600,
];

/// The default speed of a serial line: NMEA 0183-HS.
const BAUD: u32 = 38_400;

const BAUDS_ALLOWED: &str = "4800, 9600, 19200, 38400, 57600, 115200, 230400, 460800, 921600";
const TO_CONNECT: &str =
    "tcp://HOST:PORT, udp://HOST:PORT, udp-listen://HOST:PORT, serial:///dev/DEVICE?baud=38400";
const TO_LISTEN: &str = "tcp://HOST:PORT, udp://HOST:PORT, serial:///dev/DEVICE?baud=38400, pty, pty:///path/of/symlink";

/// The address of a link.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum LinkAddress {
    /// A TCP port.
    Tcp(Side, HostPort),
    /// A UDP port. A listening port replies to every sender.
    Udp(Side, HostPort),
    /// A local UDP port that serves only its first sender, for boats that send to their ground
    /// station's port.
    UdpListen(HostPort),
    /// A serial line, 8N1.
    Serial {
        /// The device.
        path: PathBuf,
        /// One of `BAUDS`.
        baud: u32,
    },
    /// A new pseudo-terminal, which other programs open like a serial line.
    Pty {
        /// Where to create a symlink to it.
        link: Option<PathBuf>,
    },
}

/// The side of a link that an address describes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Side {
    /// Connects to another program's port.
    Connects,
    /// Opens its own port.
    Listens,
}

/// A port on a machine.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct HostPort {
    /// Name or address of the machine, IPv6 without brackets; `0.0.0.0` listens on all interfaces.
    pub host: String,
    /// The port; 0 selects any free port to listen on.
    pub port: u16,
}

/// An invalid link address.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[error("link address {text:?}: {found}, allowed: {allowed}")]
pub struct LinkAddressError {
    /// The address as typed.
    pub text: String,
    /// The fault.
    pub found: String,
    /// The values allowed.
    pub allowed: &'static str,
}

/// The fault, and the values allowed.
type Fault = (String, &'static str);

impl LinkAddress {
    /// Parses an address to connect to: `tcp://HOST:PORT`, `udp://HOST:PORT`,
    /// `udp-listen://HOST:PORT` or `serial:///dev/ttyUSB0?baud=38400`.
    ///
    /// # Errors
    /// [`LinkAddressError`] with the value found and the values allowed.
    pub fn to_connect(text: &str) -> Result<LinkAddress, LinkAddressError> {
        parse(text, Side::Connects).map_err(|fault| error(text, fault))
    }

    /// Parses an address to listen on: a form of [`LinkAddress::to_connect`], `pty`, or
    /// `pty:///path/of/symlink`.
    ///
    /// # Errors
    /// [`LinkAddressError`] with the value found and the values allowed.
    pub fn to_listen(text: &str) -> Result<LinkAddress, LinkAddressError> {
        parse(text, Side::Listens).map_err(|fault| error(text, fault))
    }
}

impl fmt::Display for LinkAddress {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            LinkAddress::Tcp(_, at) => write!(f, "tcp://{at}"),
            LinkAddress::Udp(_, at) => write!(f, "udp://{at}"),
            LinkAddress::UdpListen(at) => write!(f, "udp-listen://{at}"),
            LinkAddress::Serial { path, baud } => {
                write!(f, "serial://{}?baud={baud}", path.display())
            }
            LinkAddress::Pty { link: None } => write!(f, "pty"),
            LinkAddress::Pty { link: Some(link) } => write!(f, "pty://{}", link.display()),
        }
    }
}

impl fmt::Display for HostPort {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let HostPort { host, port } = self;
        if host.contains(':') {
            write!(f, "[{host}]:{port}")
        } else {
            write!(f, "{host}:{port}")
        }
    }
}

fn error(text: &str, (found, allowed): Fault) -> LinkAddressError {
    LinkAddressError {
        text: text.to_owned(),
        found,
        allowed,
    }
}

fn parse(text: &str, side: Side) -> Result<LinkAddress, Fault> {
    let forms = if side == Side::Connects {
        TO_CONNECT
    } else {
        TO_LISTEN
    };
    let listens = side == Side::Listens;
    if listens && text == "pty" {
        return Ok(LinkAddress::Pty { link: None });
    }
    let Some((scheme, rest)) = text.split_once("://") else {
        return Err(("it has no `://`".to_owned(), forms));
    };
    match scheme {
        "tcp" => Ok(LinkAddress::Tcp(side, host_and_port(rest, side)?)),
        "udp" => Ok(LinkAddress::Udp(side, host_and_port(rest, side)?)),
        "udp-listen" if !listens => Ok(LinkAddress::UdpListen(host_and_port(rest, side)?)),
        "serial" => serial(rest),
        "pty" if listens => Ok(LinkAddress::Pty {
            link: Some(absolute(rest)?),
        }),
        // To connect to another program's terminal, use its path as a serial line.
        "pty" => Err(("a pty can only be listened on".to_owned(), forms)),
        _ => Err((format!("the scheme is {scheme:?}"), forms)),
    }
}

fn host_and_port(text: &str, side: Side) -> Result<HostPort, Fault> {
    // Split from the right because of IPv6 addresses, which end in a bracket if there is no port.
    let Some((host, port)) = text
        .rsplit_once(':')
        .filter(|(_, port)| !port.ends_with(']'))
    else {
        return Err(("it has no port".to_owned(), "HOST:PORT"));
    };
    let inside = host
        .strip_prefix('[')
        .and_then(|rest| rest.strip_suffix(']'));
    if inside.is_none() && host.contains(':') {
        return Err((
            format!("the host is {host:?}"),
            "an IPv6 address in brackets, as in [::1]:8003",
        ));
    }
    let name = inside.unwrap_or(host);
    // The resolver's error for other characters is less clear.
    let plain = |c: char| c.is_ascii_alphanumeric() || "-_.:%".contains(c);
    if name.is_empty() || !name.chars().all(plain) {
        let hosts =
            "a name, an IPv4 address, or an IPv6 address in brackets; 0.0.0.0 listens everywhere";
        return Err((format!("the host is {host:?}"), hosts));
    }
    let (first, ports) = if side == Side::Connects {
        (1, "1 to 65535")
    } else {
        (0, "0 to 65535; 0 selects a free port")
    };
    // `parse` alone would accept "+80".
    let number = Some(port).filter(|port| port.bytes().all(|b| b.is_ascii_digit()));
    match number.and_then(|port| port.parse::<u16>().ok()) {
        Some(port) if port >= first => Ok(HostPort {
            host: name.to_owned(),
            port,
        }),
        _ => Err((format!("the port is {port:?}"), ports)),
    }
}

fn serial(text: &str) -> Result<LinkAddress, Fault> {
    let (path, query) = text
        .split_once('?')
        .map_or((text, None), |(path, query)| (path, Some(query)));
    let path = absolute(path)?;
    let Some(query) = query else {
        return Ok(LinkAddress::Serial { path, baud: BAUD });
    };
    let Some(wanted) = query.strip_prefix("baud=") else {
        return Err((format!("{query:?} follows the `?`"), "baud=38400"));
    };
    match BAUDS.into_iter().find(|baud| baud.to_string() == wanted) {
        Some(baud) => Ok(LinkAddress::Serial { path, baud }),
        None => Err((format!("baud is {wanted:?}"), BAUDS_ALLOWED)),
    }
}

fn absolute(path: &str) -> Result<PathBuf, Fault> {
    if path.starts_with('/') && path.len() > 1 && !path.contains('\0') {
        return Ok(PathBuf::from(path));
    }
    Err((
        format!("the path is {path:?}"),
        "an absolute path, which makes three slashes: serial:///dev/ttyUSB0",
    ))
}
