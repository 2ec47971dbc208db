//! `squall moos`: connects MOOS applications to a game.

use super::join_args::JoinArgs;
use crate::screen;
use crate::stop;
use anyhow::{Context, Result, anyhow};
use command_line::explain::UsageError;
use command_line::number::{address, whole};
use moos::bridge::{self, News};
use moos::community::Address;
use std::net::{SocketAddr, ToSocketAddrs};
use std::process::ExitCode;
use std::time::Duration;

#[derive(clap::Args)]
pub(crate) struct Args {
    /// Boats to connect. NAME: serve a MOOSDB on the next port, counting from --port. NAME=:PORT or
    /// NAME=IP:PORT: serve it on that port. NAME=tcp/HOST:PORT: use a running MOOSDB
    #[arg(long, num_args = 1.., value_name = "NAME[=ADDRESS]", value_parser = boat)]
    vehicle: Vec<(String, Option<Address>)>,
    /// Connects all boats of this team, each with its own MOOSDB
    #[arg(long, value_name = "TEAM")]
    team: Option<String>,
    /// First port for boats without an address
    #[arg(long, value_name = "PORT", default_value_t = 9001, value_parser = whole::<u16>(1, 65_535))]
    port: u16,
    /// Publishes the whole game for pMarineViewer to the MOOSDB at this address, for example :9000
    #[arg(long, value_name = "ADDRESS")]
    shore: Option<Address>,
    /// Forwards the shoreside's variables to pShare at this address, for example shore.local:9300;
    /// may be repeated
    #[arg(long, value_name = "HOST:PORT", requires = "shore")]
    pshare: Vec<String>,
    /// Listens on this address, such as 0.0.0.0:9301, for commands from pShare, such as DEPLOY_ALL
    #[arg(long, value_name = "IP:PORT", requires = "shore", value_parser = address)]
    pshare_listen: Option<SocketAddr>,
    #[command(flatten)]
    join: JoinArgs,
}

/// Parses a boat and, optionally, the address of its database.
fn boat(text: &str) -> Result<(String, Option<Address>), String> {
    match text.split_once('=') {
        Some((name, address)) => Ok((name.to_owned(), Some(address.parse()?))),
        None => Ok((text.to_owned(), None)),
    }
}

fn resolved(place: &String) -> Result<SocketAddr> {
    let mut found = place
        .to_socket_addrs()
        .with_context(|| format!("--pshare {place}, expected HOST:PORT"))?;
    found
        .next()
        .ok_or_else(|| anyhow!("--pshare {place}: cannot resolve the host"))
}

pub(crate) fn run(args: &Args) -> Result<ExitCode> {
    if args.vehicle.is_empty() && args.team.is_none() && args.shore.is_none() {
        return Err(UsageError(
            "nothing to connect: use --vehicle NAME or --team TEAM for boats, or --shore :9000 for \
             pMarineViewer"
                .to_owned(),
        )
        .into());
    }
    let stop = stop::on_ctrl_c()?;
    stop::exit_when_late(&stop);
    let settings = bridge::Settings {
        game: args.join.leaf.game.clone(),
        place: args.join.leaf.place()?,
        wait: Duration::from_secs_f64(args.join.wait_s),
        silence: Duration::from_secs_f64(args.join.silence_s),
        stop: stop.clone(),
        boats: args.vehicle.clone(),
        team: args.team.clone(),
        first_port: args.port,
        shore: args.shore.clone(),
        share_to: args.pshare.iter().map(resolved).collect::<Result<_>>()?,
        share_listen: args.pshare_listen,
    };
    for address in args
        .vehicle
        .iter()
        .filter_map(|(_, address)| address.as_ref())
        .chain(&args.shore)
    {
        if let Address::Serve(at) = address
            && !at.ip().is_loopback()
        {
            screen::remark(&format!(
                "{at}: anyone who reaches this address can command the boat: MOOS does not support keys"
            ));
        }
    }
    bridge::serve(&settings, &|news| match news {
        News::Looking(reason) => screen::remark(&format!("looking for the game: {reason}")),
        News::Open(lines) => lines.iter().for_each(|line| screen::remark(line)),
        News::Joined(game) => screen::remark(&format!("joined {game}")),
        News::Note(note) => screen::remark(&note),
    })
    .context("the MOOS bridge")?;
    let stopped = stop.load(std::sync::atomic::Ordering::Relaxed);
    Ok(if stopped {
        stop::interrupted()
    } else {
        ExitCode::SUCCESS
    })
}
