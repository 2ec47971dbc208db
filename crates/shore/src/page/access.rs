//! Access control of the page: accepted host names and origins, and the tokens for actions.
//!
//! Other web pages open on this machine can also send requests to this server, by its address or a
//! name that resolves to it. `Host` and `Origin` reveal this, because browsers set them and pages
//! cannot.

use super::view::Access;
use std::net::{IpAddr, SocketAddr};

#[derive(Clone, Debug)]
pub(super) struct AccessControl {
    bound: SocketAddr,
    hosts: Vec<String>,
    tokens: Tokens,
}

/// The tokens that pages need for actions.
#[derive(Clone, Debug)]
pub(super) struct Tokens {
    /// The token to control the game; `None` permits every page.
    pub(super) control: Option<String>,
    /// The token to operate real boats. Everyone needs it, even other users of this machine.
    pub(super) operate: String,
}

impl AccessControl {
    /// The rules for a server at this address.
    pub(super) fn new(bound: SocketAddr, hosts: &[String], tokens: Tokens) -> AccessControl {
        AccessControl {
            bound,
            hosts: hosts.iter().map(|host| host.to_ascii_lowercase()).collect(),
            tokens,
        }
    }

    /// Checks that a request with this `Host` header is for this server.
    ///
    /// # Errors
    /// The reason, and a remedy.
    pub(super) fn check_host(&self, host: Option<&str>) -> Result<(), String> {
        let Some(host) = host else {
            return Err("The request has no Host header.\n".to_owned());
        };
        let host = host.to_ascii_lowercase();
        let name = name_of(&host);
        if self
            .hosts
            .iter()
            .any(|known| *known == host || *known == name)
            || self.is_own(name)
        {
            return Ok(());
        }
        Err(format!(
            "This server is not known as {name:?}, so another web page may have sent the request. To allow this name, \
             start the server with --host {name}.\n"
        ))
    }

    fn is_own(&self, name: &str) -> bool {
        match name.parse::<IpAddr>() {
            // If the server listens on all addresses, accept any address: attackers control only
            // names.
            Ok(ip) => ip.is_loopback() || ip == self.bound.ip() || self.bound.ip().is_unspecified(),
            Err(_) => name == "localhost",
        }
    }

    /// Checks that the WebSocket is opened by our own page, or by a client other than a browser.
    ///
    /// # Errors
    /// The reason.
    pub(super) fn check_origin(host: Option<&str>, origin: Option<&str>) -> Result<(), String> {
        let Some(origin) = origin else { return Ok(()) };
        let site = origin.split_once("://").map(|(_, site)| site);
        match (site, host) {
            (Some(site), Some(host)) if site.eq_ignore_ascii_case(host) => Ok(()),
            _ => Err(format!(
                "Pages from {origin:?} may not connect to this server.\n"
            )),
        }
    }

    /// The access that the query in a page's address grants.
    pub(super) fn access(&self, query: Option<&str>) -> Access {
        let shown = value(query, "token");
        let is_shown = |token: &String| {
            shown
                .as_ref()
                .is_some_and(|shown| is_same(shown, token.as_bytes()))
        };
        match &self.tokens {
            Tokens { operate, .. } if is_shown(operate) => Access::Operate,
            Tokens { control, .. } if control.as_ref().is_none_or(is_shown) => Access::Control,
            _ => Access::Watch,
        }
    }
}

/// The value of a parameter in a query.
pub(super) fn value(query: Option<&str>, name: &str) -> Option<Vec<u8>> {
    let pairs = query
        .unwrap_or_default()
        .split('&')
        .filter_map(|pair| pair.split_once('='));
    pairs
        .into_iter()
        .find(|(given, _)| *given == name)
        .map(|(_, value)| decoded(value))
}

/// The host without its port, and an IPv6 address without its brackets.
fn name_of(host: &str) -> &str {
    if let Some(rest) = host.strip_prefix('[') {
        return rest.split_once(']').map_or(rest, |(address, _)| address);
    }
    host.rsplit_once(':').map_or(host, |(name, _)| name)
}

/// Compares byte strings in constant time.
fn is_same(a: &[u8], b: &[u8]) -> bool {
    let differences = a
        .iter()
        .zip(b)
        .fold(0, |all, (a, b)| std::hint::black_box(all | (a ^ b)));
    a.len() == b.len() && differences == 0
}

/// The bytes of a percent-encoded part of an address.
fn decoded(text: &str) -> Vec<u8> {
    percent_encoding::percent_decode_str(&text.replace('+', " ")).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn guard(bound: &str, hosts: &[&str]) -> AccessControl {
        let hosts: Vec<String> = hosts.iter().map(|host| (*host).to_owned()).collect();
        let tokens = Tokens {
            control: None,
            operate: "of operators".to_owned(),
        };
        AccessControl::new(bound.parse().expect("an address"), &hosts, tokens)
    }

    /// The cases of one check in `access_cases.csv`: the other two columns, where `none` means
    /// absent, and the expected result.
    fn cases(check: &str) -> Vec<([Option<String>; 2], bool)> {
        let file = concat!(env!("CARGO_MANIFEST_DIR"), "/src/page/access_cases.csv");
        let text = std::fs::read_to_string(file).expect("the cases");
        let rows = text
            .lines()
            .map(|line| line.split(',').map(str::to_owned).collect::<Vec<_>>());
        let given = |cell: &String| (cell != "none").then(|| cell.clone());
        let cases = rows
            .filter(|row| row[0] == check)
            .map(|row| ([given(&row[1]), given(&row[2])], row[3] == "yes"));
        cases.collect()
    }

    #[test]
    fn only_its_own_names_lead_to_it() {
        for ([bound, host], good) in cases("host") {
            let bound = bound.expect("an address");
            let checked =
                guard(&bound, &["boat.local", "tug.local:81"]).check_host(host.as_deref());
            assert_eq!(checked.is_ok(), good, "{host:?} at {bound}: {checked:?}");
        }
    }

    #[test]
    fn other_peoples_pages_open_no_websocket() {
        for ([host, origin], good) in cases("origin") {
            let checked = AccessControl::check_origin(host.as_deref(), origin.as_deref());
            assert_eq!(checked.is_ok(), good, "{origin:?} at {host:?}");
        }
    }

    #[test]
    fn the_token_gives_rights() {
        for ([control, query], rights) in cases("token") {
            let tokens = Tokens {
                control,
                operate: "of operators".to_owned(),
            };
            let guard = AccessControl {
                tokens,
                ..guard("127.0.0.1:1", &[])
            };
            let access = guard.access(query.as_deref());
            assert_eq!(
                access,
                if rights {
                    Access::Control
                } else {
                    Access::Watch
                },
                "{query:?} with {:?}",
                guard.tokens
            );
        }
    }

    #[test]
    fn nobody_operates_real_boats_without_the_token() {
        for control in [
            None,
            Some("a b+c%".to_owned()),
            Some("of operators".to_owned()),
        ] {
            let tokens = Tokens {
                control,
                operate: "of operators".to_owned(),
            };
            let guard = AccessControl {
                tokens,
                ..guard("127.0.0.1:1", &[])
            };
            assert_eq!(
                guard.access(Some("token=of%20operators")),
                Access::Operate,
                "{:?}",
                guard.tokens
            );
            for query in [
                None,
                Some(""),
                Some("token="),
                Some("token=of"),
                Some("token=a+b%2Bc%25"),
                Some("x=of%20operators"),
            ] {
                assert!(
                    guard.access(query) < Access::Operate,
                    "{query:?} with {:?}",
                    guard.tokens
                );
            }
        }
    }

    proptest! {
        #[test]
        fn no_header_makes_it_panic(host in ".{0,30}", origin in ".{0,30}", query in "[%a-f0-9+&=token]{0,30}") {
            let guard = guard("0.0.0.0:80", &[]);
            drop(guard.check_host(Some(&host)));
            drop(AccessControl::check_origin(Some(&host), Some(&origin)));
            guard.access(Some(&query));
            decoded(&query);
        }
    }
}
