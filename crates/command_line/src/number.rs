//! Parsers of command line values: range-checked numbers, addresses and endpoints.

use clap::Command;
use std::net::SocketAddr;
use std::str::FromStr;

/// Parses a number from the command line and checks its range.
pub fn within(
    low: f64,
    high: f64,
    unit: &'static str,
) -> impl Fn(&str) -> Result<f64, String> + Clone {
    move |text: &str| {
        let number = text
            .parse()
            .ok()
            .filter(|number| (low..=high).contains(number));
        number.ok_or_else(|| format!("expected a number from {low} to {high} {unit}"))
    }
}

/// Parses a number of seconds from the command line.
///
/// # Errors
/// If it is not a number from 0 to a million.
pub fn seconds(text: &str) -> Result<f64, String> {
    within(0.0, 1e6, "s")(text)
}

/// Parses a whole number from the command line and checks its range; `high` may be `u64::MAX`.
pub fn whole<T: FromStr>(low: u64, high: u64) -> impl Fn(&str) -> Result<T, String> + Clone {
    move |text: &str| {
        let is_within = text
            .parse()
            .is_ok_and(|number| (low..=high).contains(&number));
        text.parse()
            .ok()
            .filter(|_| is_within)
            .ok_or_else(|| match high {
                u64::MAX => format!("expected a whole number of at least {low}"),
                high => format!("expected a whole number from {low} to {high}"),
            })
    }
}

/// Parses an IP address with a port from the command line.
///
/// # Errors
/// If it is neither IPv4 nor IPv6 with a port.
pub fn address(text: &str) -> Result<SocketAddr, String> {
    text.parse()
        .map_err(|_| "expected an IP address and a port, such as 127.0.0.1:8100".to_owned())
}

/// Parses the endpoint of a node from the command line.
///
/// # Errors
/// If it does not consist of a known protocol, a host and a port.
pub fn endpoint(text: &str) -> Result<String, String> {
    const PROTOCOLS: [&str; 4] = ["tcp", "quic", "tls", "udp"];
    let (protocol, address) = text.split_once('/').unwrap_or_default();
    let (host, port) = address
        .split(['?', '#'])
        .next()
        .and_then(|it| it.rsplit_once(':'))
        .unwrap_or_default();
    // `tcp://HOST:PORT` is the form of a boat's link.
    let is_host = !host.is_empty() && !host.starts_with('/');
    let is_endpoint = PROTOCOLS.contains(&protocol) && is_host && port.parse::<u16>().is_ok();
    let wrong =
        || "expected tcp/HOST:PORT or quic/HOST:PORT, such as tcp/192.168.1.5:7447".to_owned();
    is_endpoint.then(|| text.to_owned()).ok_or_else(wrong)
}

/// Parses the name or the IP address of a machine from the command line.
///
/// # Errors
/// If it contains characters not allowed in names and addresses.
pub fn host(text: &str) -> Result<String, String> {
    let is_plain = |c: char| c.is_ascii_alphanumeric() || "-_.:".contains(c);
    let is_host = !text.is_empty() && text.chars().all(is_plain);
    is_host
        .then(|| text.to_owned())
        .ok_or_else(|| "expected a name or an IP address, such as boat.local".to_owned())
}

/// Formats a measured or statistical number with two significant digits, as in 1.5, 0.031 or 190.
pub fn significant(number: f64) -> String {
    let text = format!("{number:.1e}");
    let exponent: i32 = text
        .split_once('e')
        .and_then(|(_, exponent)| exponent.parse().ok())
        .unwrap_or(0);
    let decimals = usize::try_from(1 - exponent).unwrap_or(0);
    format!("{:.decimals$}", text.parse().unwrap_or(number))
}

/// Lets all options take negative numbers, so that their parsers report the allowed range.
/// Otherwise, clap would report an unknown option.
pub fn with_negative_numbers(command: Command) -> Command {
    command
        .mut_args(|arg| {
            let takes_value = arg.get_action().takes_values();
            arg.allow_negative_numbers(takes_value)
        })
        .mut_subcommands(with_negative_numbers)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_measured_number_has_two_significant_digits() {
        for (number, want) in [
            (0.0, "0.0"),
            (0.0312, "0.031"),
            (1.04, "1.0"),
            (9.96, "10"),
            (62.7, "63"),
            (627.0, "630"),
            (-2765.0, "-2800"),
        ] {
            assert_eq!(significant(number), want);
        }
    }

    #[test]
    fn numbers_out_of_range_are_refused_with_the_range() {
        assert_eq!(whole::<u8>(1, 30)("30"), Ok(30));
        assert_eq!(
            whole::<u64>(0, u64::MAX)("18446744073709551615"),
            Ok(u64::MAX)
        );
        for text in ["0", "31", "-1", "1k", "", "1.5"] {
            assert_eq!(
                whole::<u8>(1, 30)(text),
                Err("expected a whole number from 1 to 30".to_owned()),
                "{text}"
            );
        }
        assert_eq!(
            whole::<u64>(1, u64::MAX)("0"),
            Err("expected a whole number of at least 1".to_owned())
        );
        for text in ["-1", "1e9", "nan", "abc"] {
            assert_eq!(
                seconds(text),
                Err("expected a number from 0 to 1000000 s".to_owned()),
                "{text}"
            );
        }
        for text in [
            "tcp/127.0.0.1:7447",
            "quic/[::1]:7447",
            "tcp/boat.local:7447#iface=wlan0",
        ] {
            assert_eq!(endpoint(text).as_deref(), Ok(text));
        }
        for text in [
            "127.0.0.1:7447",
            "tcp://127.0.0.1:7447",
            "tcp/127.0.0.1",
            "tcp/:7447",
            "http/a:80",
            "tcp/a:x",
            "",
        ] {
            assert!(endpoint(text).is_err(), "{text}");
        }
        assert!(address("localhost:8088").is_err() && address("[::1]:8088").is_ok());
    }
}
