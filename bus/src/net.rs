//! Where a node listens, whom it connects to, and whether it scouts.

use crate::BusError;
use crate::session::reason;
use std::net::TcpListener;
use std::path::PathBuf;
use zenoh::Config;

/// The port a hub takes when it is free and none is asked for.
pub const DEFAULT_PORT: u16 = 7447;

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
}

impl Net {
    /// The endpoint at which nodes on the same machine reach a hub that listens here.
    #[must_use]
    pub fn local_endpoint(&self) -> Option<String> {
        let first = self.listen.first()?;
        Some(first.replace("/0.0.0.0:", "/127.0.0.1:").replace("/[::]:", "/[::1]:"))
    }

    /// The zenoh configuration of a hub.
    pub(crate) fn hub(&self) -> Result<Config, BusError> {
        let mut config = self.base()?;
        set(&mut config, "mode", "\"router\"")?;
        set(&mut config, "listen/endpoints", &list(&self.listen))?;
        set(&mut config, "connect/endpoints", &list(&self.connect))?;
        // Our messages carry simulated time; a hybrid clock in every sample would only cost.
        set(&mut config, "timestamping/enabled", "false")?;
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
            Some(path) => Config::from_file(path)
                .map_err(|e| BusError::Open { what: path.display().to_string(), reason: reason(&e) })?,
        };
        set(&mut config, "scouting/multicast/enabled", if self.lan { "true" } else { "false" })?;
        set(&mut config, "scouting/gossip/enabled", "false")?;
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

/// A loopback TCP port that was free a moment ago: the default port if it is, any other if not.
///
/// # Errors
/// If the machine has no free port at all.
pub fn free_port(prefer_default: bool) -> std::io::Result<u16> {
    let wanted = if prefer_default { DEFAULT_PORT } else { 0 };
    let listener = TcpListener::bind(("127.0.0.1", wanted)).or_else(|_| TcpListener::bind(("127.0.0.1", 0)))?;
    Ok(listener.local_addr()?.port())
}
