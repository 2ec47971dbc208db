//! Where a node listens, whom it connects to, and whether it scouts.

use crate::session::reason;
use crate::{BusError, Token, access};
use game::topic::GameName;
use std::net::{SocketAddr, TcpListener};
use std::path::PathBuf;
use zenoh::Config;

/// The port a hub takes when it is free and none is asked for.
pub const DEFAULT_PORT: u16 = 7447;

/// What zenoh does with a link. Only its own messages, such as declarations, wait for a congested one (in us), and not for
/// long; a link that cannot take even those is closed. A batch has up to 64 kB: answers of a megabyte, and as many urgent
/// messages as anybody can ask for at once, find room. A message that is put together from fragments has a limit.
const LINKS: [(&str, &str); 5] = [
    ("transport/link/tx/queue/congestion_control/drop/wait_before_drop", "0"),
    ("transport/link/tx/queue/congestion_control/block/wait_before_close", "100000"),
    ("transport/link/tx/queue/size/real_time", "16"),
    ("transport/link/tx/queue/size/data_low", "16"),
    ("transport/link/rx/max_message_size", "16777216"),
];

/// What comes in from other nodes is dropped where it would have to wait for a link that it goes out on. An answer goes by
/// its question.
const NEVER_WAIT: &str =
    r#"[{messages: ["put", "delete", "query"], flows: ["ingress"], overwrite: {congestion_control: "drop"}}]"#;

/// The longest zenoh configuration, bytes.
const CONFIG_MAX: u64 = 1 << 20;

/// How a node meets the others.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Net {
    /// Endpoints to listen on, for example `tcp/0.0.0.0:7447`. Only a hub listens.
    pub listen: Vec<String>,
    /// Endpoints to connect to, for example `tcp/192.168.1.5:7447`.
    pub connect: Vec<String>,
    /// Find and be found by multicast on the local network.
    pub lan: bool,
    /// A zenoh configuration (JSON5) to begin with: access control, interfaces, buffers and the like.
    pub config_file: Option<PathBuf>,
    /// The game's token, where it is known.
    pub token: Option<Token>,
}

impl Net {
    /// The endpoint at which nodes on the same machine reach a hub that listens here.
    #[must_use]
    pub fn local_endpoint(&self) -> Option<String> {
        let first = self.listen.first()?;
        Some(first.replace("/0.0.0.0:", "/127.0.0.1:").replace("/[::]:", "/[::1]:"))
    }

    /// The zenoh configuration of the hub of a game.
    pub(crate) fn hub(&self, game: &GameName) -> Result<Config, BusError> {
        let mut config = self.base()?;
        // A file that has rules of its own knows better.
        if config.get_json("access_control/enabled").ok().as_deref() != Some("true") {
            set(&mut config, "access_control", &access::control(game).to_string())?;
        }
        set(&mut config, "mode", "\"router\"")?;
        set(&mut config, "listen/endpoints", &list(&self.listen))?;
        set(&mut config, "connect/endpoints", &list(&self.connect))?;
        // Our messages carry simulated time; a hybrid clock in every sample would only cost.
        set(&mut config, "timestamping/enabled", "false")?;
        // Whatever a node asks for, what it sends through the hub waits for nobody: the others would wait with it.
        set(&mut config, "qos/network", NEVER_WAIT)?;
        Ok(config)
    }

    /// The zenoh configuration of a leaf. It keeps trying to connect, and connects again after a cut.
    pub(crate) fn leaf(&self) -> Result<Config, BusError> {
        let mut config = self.base()?;
        set(&mut config, "mode", "\"client\"")?;
        // Without an endpoint, a leaf on a local network scouts for a hub.
        set(&mut config, "connect/endpoints", &list(&self.connect))?;
        set(&mut config, "connect/timeout_ms", "0")?;
        set(&mut config, "connect/exit_on_failure", "true")?;
        Ok(config)
    }

    fn base(&self) -> Result<Config, BusError> {
        let mut config = match &self.config_file {
            None => Config::default(),
            Some(path) => {
                let refused = |reason| BusError::Open { what: path.display().to_string(), reason };
                // The library would read whatever it is.
                game::input_file::read(path, CONFIG_MAX).map_err(|e| refused(e.to_string()))?;
                Config::from_file(path).map_err(|e| refused(reason(&e)))?
            }
        };
        set(&mut config, "scouting/multicast/enabled", if self.lan { "true" } else { "false" })?;
        set(&mut config, "scouting/gossip/enabled", "false")?;
        for (key, value) in LINKS {
            set(&mut config, key, value)?;
        }
        Ok(config)
    }
}

fn set(config: &mut Config, key: &str, value: &str) -> Result<(), BusError> {
    config.insert_json5(key, value).map_err(|e| BusError::Setting {
        key: key.to_owned(),
        value: value.to_owned(),
        reason: reason(&e),
    })
}

fn list(endpoints: &[String]) -> String {
    serde_json::to_string(endpoints).expect("a list of strings is JSON")
}

/// Whether an endpoint, for example `tcp/127.0.0.1:7447`, can be reached from this machine only.
#[must_use]
pub fn is_loopback(endpoint: &str) -> bool {
    let address = endpoint.split_once('/').map_or(endpoint, |(_, address)| address);
    let address = address.split(['?', '#']).next().unwrap_or(address);
    match address.parse::<SocketAddr>() {
        Ok(address) => address.ip().is_loopback(),
        Err(_) => address.rsplit_once(':').is_some_and(|(host, _)| host == "localhost"),
    }
}

/// A loopback TCP port that was free a moment ago: the default port if it is, any other if not.
///
/// # Errors
/// If the machine has no free port at all.
pub fn free_port(prefer_default: bool) -> std::io::Result<u16> {
    let wanted = if prefer_default { DEFAULT_PORT } else { 0 };
    let listener = TcpListener::bind(("127.0.0.1", wanted)).or_else(|_| TcpListener::bind(("127.0.0.1", 0)))?;
    Ok(listener.local_addr()?.port())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_loopback_is_this_machine_only() {
        for (endpoint, is_ours) in [
            ("tcp/127.0.0.1:7447", true),
            ("tcp/127.3.2.1:7447", true),
            ("tcp/[::1]:7447", true),
            ("tcp/localhost:7447", true),
            ("tcp/127.0.0.1:7447#iface=lo", true),
            ("tcp/0.0.0.0:7447", false),
            ("tcp/[::]:7447", false),
            ("tcp/192.168.1.5:7447", false),
            ("udp/localhost.example:7447", false),
            ("tcp/boat.local:7447", false),
            ("tcp/7447", false),
            ("", false),
        ] {
            assert_eq!(is_loopback(endpoint), is_ours, "{endpoint}");
        }
    }
}
