//! Command line arguments for where nodes meet.

use anyhow::{Context, Result, anyhow, bail};
use bus::keys::Bundle;
use bus::token::TOKEN_VARIABLE;
use bus::{Net, Place, Token};
use messages::topic::GameName;
use primitives::input_file;
use std::path::PathBuf;
use std::sync::Arc;

/// How a hub can be reached.
#[derive(clap::Args, Clone, Debug)]
pub(crate) struct HubArgs {
    /// Endpoint to listen on, for example tcp/0.0.0.0:7447 [default: a free loopback port, 7447 if it is]
    #[arg(long, value_name = "ENDPOINT")]
    pub(crate) listen: Vec<String>,
    /// Be found by multicast on the local network (listens on all interfaces unless --listen says otherwise)
    #[arg(long)]
    lan: bool,
    /// Lets other machines in although nothing protects the game from strangers on that network
    #[arg(long)]
    insecure: bool,
    /// A zenoh configuration (JSON5) to begin with: access control, interfaces, buffers
    #[arg(long, value_name = "FILE")]
    zenoh_config: Option<PathBuf>,
    #[command(flatten)]
    keys: KeysArgs,
    #[command(flatten)]
    token: TokenArgs,
}

/// The keys of a game.
#[derive(clap::Args, Clone, Debug)]
struct KeysArgs {
    /// The keys of this node, of a game with keys: a folder that `squall keys new` has made
    #[arg(long, value_name = "FOLDER")]
    keys: Option<PathBuf>,
}

impl KeysArgs {
    fn load(&self) -> Result<Option<Arc<Bundle>>> {
        Ok(self.keys.as_deref().map(Bundle::load).transpose()?.map(Arc::new))
    }
}

/// The token of a game.
#[derive(clap::Args, Clone, Debug)]
struct TokenArgs {
    /// A file with the game's token, as `squall sim` shows it [default: from SQUALL_TOKEN, or of the game on this machine]
    #[arg(long, value_name = "FILE")]
    token_file: Option<PathBuf>,
}

/// A token file is a line of text; what is longer is another file, bytes.
const TOKEN_FILE_MAX: u64 = 4096;

impl TokenArgs {
    /// The token that is given.
    fn token(&self) -> Result<Option<Token>> {
        let (text, place) = match (&self.token_file, std::env::var(TOKEN_VARIABLE)) {
            (Some(file), _) => {
                let text = input_file::read_text(file, TOKEN_FILE_MAX)
                    .with_context(|| format!("cannot read {}", file.display()))?;
                (text, file.display().to_string())
            }
            (None, Ok(text)) => (text, TOKEN_VARIABLE.to_owned()),
            (None, Err(_)) => return Ok(None),
        };
        text.parse().map(Some).with_context(|| place)
    }
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
    #[command(flatten)]
    keys: KeysArgs,
    #[command(flatten)]
    token: TokenArgs,
}

impl HubArgs {
    /// Where to listen.
    pub(crate) fn net(&self) -> Result<Net> {
        let mut listen = self.listen.clone();
        if listen.is_empty() && self.lan {
            listen.push(format!("tcp/0.0.0.0:{}", bus::DEFAULT_PORT));
        } else if listen.is_empty() {
            listen.push(format!("tcp/127.0.0.1:{}", free_port(true)?));
        }
        listen.iter_mut().try_for_each(with_port)?;
        let keys = self.keys.load()?;
        match (&keys, listen.iter().find(|endpoint| !bus::is_loopback(endpoint))) {
            (None, Some(open)) if !self.insecure => bail!(
                "{open} can be reached from other machines, and whoever reaches it can see all of the game and stop it: make \
                 keys with `squall keys new` and serve it with --keys, or say --insecure if nobody else is on that network"
            ),
            _ => {}
        }
        // With keys, certificates say who may do what.
        let token = self.token.token()?.or_else(|| keys.is_none().then(Token::random));
        Ok(Net { listen, connect: vec![], lan: self.lan, config_file: self.zenoh_config.clone(), token, keys })
    }
}

impl LeafArgs {
    /// The token that is given.
    pub(crate) fn token(&self) -> Result<Option<Token>> {
        self.token.token()
    }

    /// The keys that are given.
    pub(crate) fn keys(&self) -> Result<Option<Arc<Bundle>>> {
        self.keys.load()
    }

    /// The gateways of this machine that may be meant. Where a game elsewhere is asked for, those that were told its name;
    /// but a command that stops boats is meant for one gateway too many rather than for one too few.
    pub(crate) fn local_gateways(&self, stops: bool) -> Vec<bus::GatewayEntry> {
        let is_elsewhere = !stops && (self.lan || !self.connect.is_empty());
        let is_meant = |entry: &bus::GatewayEntry| match (&self.game, &entry.game) {
            (Some(wanted), Some(game)) => wanted.as_str() == game,
            _ => !is_elsewhere,
        };
        bus::local_gateways().into_iter().filter(is_meant).collect()
    }

    /// Where to connect: as asked for, or where this machine's local registry says.
    pub(crate) fn net(&self) -> Result<Net> {
        self.net_of(None, self.keys()?)
    }

    /// The same, for nodes that outlive a game, or come before it.
    pub(crate) fn place(&self) -> Result<Place> {
        let (leaf, keys) = (self.clone(), self.keys()?);
        Ok(Place::new(move |game| leaf.net_of(game, keys.clone()).map_err(|e| format!("{e:#}"))))
    }

    /// Where this game is, or else that which is asked for.
    fn net_of(&self, game: Option<&GameName>, keys: Option<Arc<Bundle>>) -> Result<Net> {
        let game = game.or(self.game.as_ref());
        let mut connect = self.connect.clone();
        let is_named = |entry: &bus::Entry| game.is_none_or(|game| game.as_str() == entry.game);
        let mut known: Vec<bus::Entry> = bus::local_registry().into_iter().filter(is_named).collect();
        if connect.is_empty() && !self.lan {
            connect.push(local_endpoint(&known)?);
        }
        known.retain(|entry| connect.contains(&entry.endpoint));
        let shown = || known.first().and_then(|entry| entry.token.as_ref()?.parse().ok());
        let token = self.token.token()?.or_else(shown);
        Ok(Net { listen: vec![], connect, lan: self.lan, config_file: self.zenoh_config.clone(), token, keys })
    }
}

/// A port of this machine that nobody listens on.
pub(crate) fn free_port(prefer_default: bool) -> Result<u16> {
    bus::free_port(prefer_default).map_err(|e| anyhow!("no free port on this machine: {e}"))
}

/// Port 0 is any that is free: chosen here, so that it is known to whoever is told the endpoint.
fn with_port(endpoint: &mut String) -> Result<()> {
    if let Some(rest) = endpoint.strip_suffix(":0") {
        *endpoint = format!("{rest}:{}", free_port(false)?);
    }
    Ok(())
}

/// Where the game of this machine listens.
fn local_endpoint(games: &[bus::Entry]) -> Result<String> {
    match games {
        [] => Ok(format!("tcp/127.0.0.1:{}", bus::DEFAULT_PORT)),
        [entry] => Ok(entry.endpoint.clone()),
        several => {
            let names: Vec<&str> = several.iter().map(|entry| entry.game.as_str()).collect();
            bail!("several games run on this machine: choose with --game among {}", names.join(", "))
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

/// What people on other machines, or other users of this one, need for joining and controlling a game.
pub(crate) fn token_text(token: &Token) -> String {
    format!("its token, for agents and operators elsewhere: {TOKEN_VARIABLE}={}", token.hex())
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
            assert!(text.starts_with(before) && port.parse::<u16>().unwrap() > 0, "{endpoint}");
        }
    }
}
