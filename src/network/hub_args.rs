//! Command line arguments of a process that serves a game: its endpoint, keys and token.

use anyhow::{Result, anyhow, bail};
use bus::token::TOKEN_VARIABLE;
use bus::{Net, Token};
use command_line::explain::UsageError;
use command_line::leaf_args::AccessArgs;
use command_line::number::endpoint;
use messages::topic::GameName;
use std::net::{IpAddr, Ipv4Addr, UdpSocket};
use std::path::PathBuf;

#[derive(clap::Args, Clone, Debug)]
pub(crate) struct HubArgs {
    /// Endpoint to listen on, for example tcp/0.0.0.0:7447, or quic/0.0.0.0:7448 for lossy links;
    /// may be repeated [default: loopback port 7447, or a free port if it is taken]
    #[arg(long, value_name = "ENDPOINT", value_parser = endpoint)]
    pub(crate) listen: Vec<String>,
    /// Announces the game by multicast on the local network; without --listen, listens on all
    /// interfaces
    #[arg(long)]
    lan: bool,
    /// Accepts other machines without keys: anyone on the network can see and stop the game
    #[arg(long)]
    insecure: bool,
    /// Base zenoh configuration (JSON5), for example for access control, interfaces or buffers
    #[arg(long, value_name = "FILE")]
    zenoh_config: Option<PathBuf>,
    #[command(flatten)]
    access: AccessArgs,
}

impl HubArgs {
    /// The network settings for serving.
    pub(crate) fn net(&self) -> Result<Net> {
        let mut listen = self.listen.clone();
        if listen.is_empty() && self.lan {
            listen.push(format!("tcp/0.0.0.0:{}", bus::DEFAULT_PORT));
        } else if listen.is_empty() {
            listen.push(format!("tcp/127.0.0.1:{}", free_port(true)?));
        }
        listen.iter_mut().try_for_each(with_port)?;
        let keys = self.access.keys()?;
        match (
            &keys,
            listen.iter().find(|endpoint| !bus::is_loopback(endpoint)),
        ) {
            (None, Some(open)) if !self.insecure => bail!(UsageError(format!(
                "{open} can be reached from other machines, where anyone can see and stop the game: create keys with \
                 `squall keys new` and use --keys, or use --insecure on a private network"
            ))),
            _ => {}
        }
        // With keys, certificates define the rights, so no token is needed.
        let token = self
            .access
            .token()?
            .or_else(|| keys.is_none().then(Token::random));
        Ok(Net {
            listen,
            connect: vec![],
            lan: self.lan,
            config_file: self.zenoh_config.clone(),
            token,
            keys,
        })
    }
}

/// A free port of this machine.
pub(crate) fn free_port(prefer_default: bool) -> Result<u16> {
    bus::free_port(prefer_default).map_err(|e| anyhow!("no free port on this machine: {e}"))
}

/// Replaces port 0 with a free port, so that the endpoint can be passed to other nodes.
fn with_port(endpoint: &mut String) -> Result<()> {
    if let Some(rest) = endpoint.strip_suffix(":0") {
        *endpoint = format!("{rest}:{}", free_port(false)?);
    }
    Ok(())
}

/// A game name with a random suffix, so that it is very likely unique on the network.
pub(crate) fn unique_game_name(scenario: &str) -> Result<GameName> {
    use std::hash::{BuildHasher, Hasher, RandomState};
    let bits = RandomState::new().build_hasher().finish() & 0xff_ffff;
    let stem: String = scenario.chars().take(40).collect();
    GameName::new(&format!("{stem}-{bits:06x}")).map_err(|e| anyhow!(e))
}

/// This machine's address as seen by others, if it has one. Sends nothing: the system only looks up
/// the route.
pub(crate) fn own_address() -> Option<IpAddr> {
    let socket = UdpSocket::bind((Ipv4Addr::UNSPECIFIED, 0)).ok()?;
    // A documentation address (RFC 5737), which takes the default route.
    socket.connect((Ipv4Addr::new(192, 0, 2, 1), 9)).ok()?;
    let address = socket.local_addr().ok()?.ip();
    (!address.is_loopback() && !address.is_unspecified()).then_some(address)
}

/// The information that users on other machines, or other users of this machine, need to join and
/// control a game.
pub(crate) fn token_text(token: &Token) -> String {
    format!(
        "token for agents and operators on other machines or accounts: {TOKEN_VARIABLE}={}",
        token.hex()
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn port_0_becomes_one_that_is_free_and_every_other_stays() {
        let given = |text: &str| {
            let mut endpoint = text.to_owned();
            with_port(&mut endpoint).map(|()| endpoint).unwrap()
        };
        for text in ["tcp/127.0.0.1:7447", "tcp/127.0.0.1:10", "tcp/0.0.0.0:7440"] {
            assert_eq!(given(text), text);
        }
        for text in ["tcp/127.0.0.1:0", "tcp/[::1]:0"] {
            let endpoint = given(text);
            let (before, port) = endpoint.rsplit_once(':').unwrap();
            assert!(
                text.starts_with(before) && port.parse::<u16>().unwrap() > 0,
                "{endpoint}"
            );
        }
    }
}
