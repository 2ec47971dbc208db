//! Command line arguments that say how a process reaches a game: address, name, keys and token.

use crate::explain::UsageError;
use crate::number::endpoint;
use anyhow::{Context, Result, bail, ensure};
use bus::keys::Bundle;
use bus::token::TOKEN_VARIABLE;
use bus::{Net, Place, Token};
use messages::topic::GameName;
use primitives::input_file;
use std::collections::BTreeSet;
use std::ffi::OsString;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// The keys and the token of a game.
#[derive(clap::Args, Clone, Debug)]
pub struct AccessArgs {
    /// Folder with this node's keys, created by `squall keys new`; required if the game uses keys
    #[arg(long, value_name = "FOLDER")]
    keys: Option<PathBuf>,
    /// Reads the game's token, which `squall sim` prints, from this file [default: from the
    /// variable SQUALL_TOKEN, or from the game on this machine]
    #[arg(long, value_name = "FILE")]
    token_file: Option<PathBuf>,
}

impl AccessArgs {
    /// Loads the given keys.
    ///
    /// # Errors
    /// If they cannot be read.
    pub fn keys(&self) -> Result<Option<Arc<Bundle>>> {
        Ok(self
            .keys
            .as_deref()
            .map(Bundle::load)
            .transpose()?
            .map(Arc::new))
    }

    /// The given token.
    pub fn token(&self) -> Result<Option<Token>> {
        let given = text_of(self.token_file.as_deref(), TOKEN_VARIABLE)?;
        given
            .map(|(text, place)| text.parse().with_context(|| place))
            .transpose()
    }
}

/// Restarts this program with the number of threads that a process with keys needs.
pub fn restart_with_threads_for_keys() -> Result<()> {
    let is_keys = |word: OsString| {
        word.to_str()
            .is_some_and(|word| word == "--keys" || word.starts_with("--keys="))
    };
    if std::env::args_os().skip(1).any(is_keys) {
        bus::restart_for_keys()?;
    }
    Ok(())
}

/// Size limit of a token file (bytes), which is a single line: a longer file is not a token file.
const TOKEN_FILE_MAX: u64 = 4096;

/// Reads a secret from the file, or else from the environment variable; returns it with its source,
/// for errors.
pub fn text_of(file: Option<&Path>, variable: &str) -> Result<Option<(String, String)>> {
    let Some(file) = file else {
        return Ok(std::env::var(variable)
            .ok()
            .map(|text| (text, variable.to_owned())));
    };
    let place = file.display().to_string();
    let text = input_file::read_text(file, TOKEN_FILE_MAX)
        .with_context(|| format!("cannot read {place}"))?;
    Ok(Some((text, place)))
}

/// How to reach a hub.
#[derive(clap::Args, Clone, Debug)]
pub struct LeafArgs {
    /// Endpoint of the sim, for example tcp/192.168.1.5:7447 [default: the game on this machine]
    #[arg(long, value_name = "ENDPOINT", value_parser = endpoint)]
    connect: Vec<String>,
    /// Finds the sim by multicast on the local network
    #[arg(long, conflicts_with = "connect")]
    lan: bool,
    /// Base zenoh configuration (JSON5), for example for access control, interfaces or buffers
    #[arg(long, value_name = "FILE")]
    zenoh_config: Option<PathBuf>,
    /// Name of the game [default: the only game found]
    #[arg(long, value_name = "NAME", value_parser = GameName::new)]
    pub game: Option<GameName>,
    /// Keys and token.
    #[command(flatten)]
    pub access: AccessArgs,
}

impl LeafArgs {
    /// The gateways on this machine that a command may address. If both the arguments and a gateway
    /// name a game, it must be the same one. Otherwise, the gateway counts unless the arguments
    /// select a game elsewhere; a stop includes it even then, since it should reach too many boats
    /// rather than too few.
    pub fn local_gateways(&self, stops: bool) -> Vec<bus::GatewayEntry> {
        let is_elsewhere = !stops && (self.lan || !self.connect.is_empty());
        let is_meant = |entry: &bus::GatewayEntry| match (&self.game, &entry.game) {
            (Some(wanted), Some(game)) => wanted.as_str() == game,
            _ => !is_elsewhere,
        };
        bus::local_gateways().into_iter().filter(is_meant).collect()
    }

    /// Whether the arguments give these endpoints.
    pub fn connects_to(&self, net: &Net) -> bool {
        !self.connect.is_empty() && net.connect == self.connect
    }

    /// Whether the arguments select no game and none is running on this machine.
    pub fn finds_no_game(&self) -> bool {
        let names_place = self.game.is_some()
            || self.lan
            || !self.connect.is_empty()
            || self.zenoh_config.is_some();
        !names_place && bus::local_registry().is_empty()
    }

    /// The same arguments for an emulated boat. Without a name, they select the only water
    /// simulation on this machine.
    pub fn in_water(mut self) -> LeafArgs {
        let water: Vec<bus::Entry> = bus::local_registry()
            .into_iter()
            .filter(|entry| entry.is_water)
            .collect();
        if let ([water], true, false) = (water.as_slice(), self.connect.is_empty(), self.lan) {
            self.game = self.game.or_else(|| GameName::new(&water.game).ok());
        }
        self
    }

    /// Checks that a command for all boats of a game, sent to these gateways, refers to only one
    /// game. Stops need no check: they are sent to as many boats as possible.
    ///
    /// # Errors
    /// If there are several games; the error names them.
    pub fn check_one_game(&self, gateways: &[bus::GatewayEntry]) -> Result<()> {
        let mut names: BTreeSet<String> = gateways
            .iter()
            .filter_map(|entry| entry.game.clone())
            .collect();
        if self.connect.is_empty() && !self.lan {
            names.extend(
                bus::local_registry()
                    .into_iter()
                    .filter(|entry| !entry.is_water)
                    .map(|entry| entry.game),
            );
        }
        ensure!(
            self.game.is_some() || names.len() < 2,
            several_games(names.iter().map(String::as_str))
        );
        Ok(())
    }

    /// Where to connect: the given endpoints, or those in this machine's local registry.
    pub fn net(&self) -> Result<Net> {
        self.net_of(None, self.access.keys()?)
    }

    /// Like `net`, for nodes that outlive a game or start before it.
    pub fn place(&self) -> Result<Place> {
        let leaf = self.clone();
        let keys = self.access.keys()?;
        Ok(Place::new(move |game| {
            leaf.net_of(game, keys.clone())
                .map_err(|e| crate::explain::line(&e))
        }))
    }

    /// The network settings for this game, or else for the game that the arguments name.
    fn net_of(&self, game: Option<&GameName>, keys: Option<Arc<Bundle>>) -> Result<Net> {
        let game = game.or(self.game.as_ref());
        let mut connect = self.connect.clone();
        let is_named = |entry: &bus::Entry| game.is_none_or(|game| game.as_str() == entry.game);
        let mut known: Vec<bus::Entry> =
            bus::local_registry().into_iter().filter(is_named).collect();
        if connect.is_empty() && !self.lan {
            connect.push(local_endpoint(&known)?);
        }
        known.retain(|entry| {
            connect
                .iter()
                .any(|given| bus::is_same_place(given, &entry.endpoint))
        });
        let shown = || {
            known
                .first()
                .and_then(|entry| entry.token.as_ref()?.parse().ok())
        };
        let token = self.access.token()?.or_else(shown);
        Ok(Net {
            listen: vec![],
            connect,
            lan: self.lan,
            config_file: self.zenoh_config.clone(),
            token,
            keys,
        })
    }
}

/// The endpoint of the game on this machine.
fn local_endpoint(known: &[bus::Entry]) -> Result<String> {
    let (water, games): (Vec<_>, Vec<_>) = known.iter().partition(|entry| entry.is_water);
    match if games.is_empty() { water } else { games }.as_slice() {
        [] => Ok(format!("tcp/127.0.0.1:{}", bus::DEFAULT_PORT)),
        [entry] => Ok(entry.endpoint.clone()),
        several => bail!(several_games(
            several.iter().map(|entry| entry.game.as_str())
        )),
    }
}

fn several_games<'a>(names: impl Iterator<Item = &'a str>) -> UsageError {
    let names: Vec<&str> = names.collect();
    UsageError(format!(
        "several games are running on this machine; select one with --game: {}",
        names.join(", ")
    ))
}
