//! Identities of nodes.

use std::fmt;
use std::str::FromStr;
use thiserror::Error;

/// The identity of a node: the common name of its certificate, and the name of its key folder.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Identity {
    /// The node that serves the game.
    Sim,
    /// The agents of this team.
    Team(String),
    /// The gateway of this boat, or of any boat.
    Gateway(Option<String>),
    /// A node that observes and may stop boats.
    Observer,
    /// A node that controls the game and operates boats.
    Operator,
}

/// A string that is not an identity.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[error(
    "unknown identity {0:?}, expected sim, team-NAME, gateway, gateway-NAME, observer, operator"
)]
pub struct UnknownIdentity(String);

impl fmt::Display for Identity {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Identity::Sim => f.write_str("sim"),
            Identity::Team(team) => write!(f, "team-{team}"),
            Identity::Gateway(None) => f.write_str("gateway"),
            Identity::Gateway(Some(boat)) => write!(f, "gateway-{boat}"),
            Identity::Observer => f.write_str("observer"),
            Identity::Operator => f.write_str("operator"),
        }
    }
}

impl FromStr for Identity {
    type Err = UnknownIdentity;

    fn from_str(text: &str) -> Result<Identity, UnknownIdentity> {
        let named = |kind: &str| {
            text.strip_prefix(kind)
                .filter(|name| is_name(name))
                .map(str::to_owned)
        };
        match text {
            "sim" => Ok(Identity::Sim),
            "gateway" => Ok(Identity::Gateway(None)),
            "observer" => Ok(Identity::Observer),
            "operator" => Ok(Identity::Operator),
            _ => (named("team-").map(Identity::Team))
                .or_else(|| named("gateway-").map(|boat| Identity::Gateway(Some(boat))))
                .ok_or_else(|| UnknownIdentity(text.to_owned())),
        }
    }
}

/// Whether a string is valid as a team or boat name, which becomes part of file names and topics.
fn is_name(name: &str) -> bool {
    let allowed = |c: char| c.is_ascii_alphanumeric() || c == '_' || c == '-';
    // A common name has up to 64 characters (RFC 5280, upper bound `ub-common-name`), and the
    // longest prefix takes eight.
    (1..=48).contains(&name.len()) && name.chars().all(allowed)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_identity_is_read_as_it_is_written() {
        let team = Identity::Team("blue".to_owned());
        let boat = Identity::Gateway(Some("blue_one".to_owned()));
        for identity in [
            Identity::Sim,
            team,
            Identity::Gateway(None),
            boat,
            Identity::Observer,
            Identity::Operator,
        ] {
            assert_eq!(identity.to_string().parse(), Ok(identity));
        }
        for bad in [
            "",
            "team-",
            "team-../x",
            "team-a/b",
            "gateway-*",
            "Sim",
            "root",
            &format!("team-{}", "x".repeat(49)),
        ] {
            assert!(bad.parse::<Identity>().is_err(), "{bad}");
        }
    }
}
