//! Command line arguments for where nodes meet.

use anyhow::{Result, anyhow, bail};
use bus::Net;
use game::topic::GameName;
use std::path::PathBuf;

/// How a hub can be reached.
#[derive(clap::Args, Clone, Debug)]
pub(crate) struct HubArgs {
    /// Endpoint to listen on, for example tcp/0.0.0.0:7447 [default: a free loopback port, 7447 if it is]
    #[arg(long, value_name = "ENDPOINT")]
    pub(crate) listen: Vec<String>,
    /// Be found by multicast on the local network (listens on all interfaces unless --listen says otherwise)
    #[arg(long)]
    lan: bool,
    /// A zenoh configuration (JSON5) to begin with: access control, interfaces, buffers
    #[arg(long, value_name = "FILE")]
    zenoh_config: Option<PathBuf>,
}

/// How to reach a hub.
#[derive(clap::Args, Clone, Debug)]
pub(crate) struct LeafArgs {
    /// Where the sim is, for example tcp/192.168.1.5:7447 [default: the game on this machine]
    #[arg(long, value_name = "ENDPOINT")]
    connect: Vec<String>,
    /// Find the sim by multicast on the local network
    #[arg(long, conflicts_with = "connect")]
    lan: bool,
    /// A zenoh configuration (JSON5) to begin with: access control, interfaces, buffers
    #[arg(long, value_name = "FILE")]
    zenoh_config: Option<PathBuf>,
    /// The game's name [default: the only one there]
    #[arg(long, value_name = "NAME", value_parser = GameName::new)]
    pub(crate) game: Option<GameName>,
}

impl HubArgs {
    /// Where to listen.
    pub(crate) fn net(&self) -> Result<Net> {
        let mut listen = self.listen.clone();
        if listen.is_empty() && self.lan {
            listen.push(format!("tcp/0.0.0.0:{}", bus::DEFAULT_PORT));
        } else if listen.is_empty() {
            let port = bus::free_port(true).map_err(|e| anyhow!("no free port to listen on: {e}"))?;
            listen.push(format!("tcp/127.0.0.1:{port}"));
        }
        Ok(Net { listen, connect: vec![], lan: self.lan, config_file: self.zenoh_config.clone() })
    }
}

impl LeafArgs {
    /// Where to connect: as asked for, or where this machine's local registry says.
    pub(crate) fn net(&self) -> Result<Net> {
        let mut connect = self.connect.clone();
        if connect.is_empty() && !self.lan {
            connect.push(self.local_endpoint()?);
        }
        Ok(Net { listen: vec![], connect, lan: self.lan, config_file: self.zenoh_config.clone() })
    }

    fn local_endpoint(&self) -> Result<String> {
        let wanted = |entry: &bus::Entry| self.game.as_ref().is_none_or(|game| game.as_str() == entry.game);
        let entries: Vec<bus::Entry> = bus::local_registry().into_iter().filter(wanted).collect();
        match entries.as_slice() {
            [] => Ok(format!("tcp/127.0.0.1:{}", bus::DEFAULT_PORT)),
            [entry] => Ok(entry.endpoint.clone()),
            several => {
                let names: Vec<&str> = several.iter().map(|entry| entry.game.as_str()).collect();
                bail!("several games run on this machine: choose with --game among {}", names.join(", "))
            }
        }
    }
}

/// A name for a game that no other game on the network has.
pub(crate) fn unique_game_name(scenario: &str) -> Result<GameName> {
    use std::hash::{BuildHasher, Hasher, RandomState};
    let bits = RandomState::new().build_hasher().finish() & 0xff_ffff;
    let stem: String = scenario.chars().take(40).collect();
    GameName::new(&format!("{stem}-{bits:06x}")).map_err(|e| anyhow!(e))
}
