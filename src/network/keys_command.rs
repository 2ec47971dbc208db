//! `squall keys`: creates and shows the keys of a game.

use super::hub_args::own_address;
use crate::screen;
use anyhow::{Result, bail};
use bus::keys::{self, Bundle, Identity};
use command_line::explain::UsageError;
use command_line::number::{host, whole};
use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::time::Duration;

#[derive(clap::Args)]
pub(crate) struct Args {
    #[command(subcommand)]
    command: KeysCommand,
}

#[derive(clap::Subcommand)]
enum KeysCommand {
    /// Creates a certificate authority, and a folder of keys for each participant in a game.
    New(NewArgs),
    /// Shows the owner and validity of keys.
    Show(ShowArgs),
}

#[derive(clap::Args)]
struct NewArgs {
    /// Folder to create the keys in
    folder: PathBuf,
    /// Creates keys for the agents of this team; may be repeated
    #[arg(long = "team", value_name = "NAME")]
    teams: Vec<String>,
    /// Creates keys for the gateway of this boat, or of any boat if no name is given; may be
    /// repeated
    #[arg(long = "gateway", value_name = "BOAT", num_args = 0..=1, default_missing_value = "")]
    gateways: Vec<String>,
    /// Creates keys for observers, who can also stop boats
    #[arg(long)]
    observer: bool,
    /// Creates keys for operators, who control the game and its boats
    #[arg(long)]
    operator: bool,
    /// Name or address of the sim, besides localhost; may be repeated [default: this machine's name
    /// and address]
    #[arg(long = "host", value_name = "HOST", value_parser = host)]
    hosts: Vec<String>,
    /// Validity of the keys, days
    #[arg(long, value_name = "DAYS", default_value_t = 90, value_parser = whole::<u32>(1, 3650))]
    days: u32,
}

#[derive(clap::Args)]
struct ShowArgs {
    /// Folders with keys
    #[arg(required = true, value_name = "FOLDER")]
    folders: Vec<PathBuf>,
}

const DAY: Duration = Duration::from_secs(24 * 3600);

pub(crate) fn run(args: &Args) -> Result<ExitCode> {
    match &args.command {
        KeysCommand::New(args) => new(args)?,
        KeysCommand::Show(args) => args.folders.iter().try_for_each(|folder| show(folder))?,
    }
    Ok(ExitCode::SUCCESS)
}

fn new(args: &NewArgs) -> Result<()> {
    let mut identities = vec![Identity::Sim];
    for team in &args.teams {
        identities.push(named(&format!("team-{team}"))?);
    }
    for boat in &args.gateways {
        identities.push(if boat.is_empty() {
            Identity::Gateway(None)
        } else {
            named(&format!("gateway-{boat}"))?
        });
    }
    identities.extend(args.observer.then_some(Identity::Observer));
    identities.extend(args.operator.then_some(Identity::Operator));
    if let [Identity::Sim] = identities[..] {
        bail!(UsageError(
            "these keys would let no node join; add at least one of --team, --gateway, --observer and --operator"
                .to_owned()
        ));
    }
    identities.sort();
    if let Some([twice, _]) = identities.windows(2).find(|pair| pair[0] == pair[1]) {
        bail!(UsageError(format!("{twice} is given twice, expected once")));
    }
    if let Some(there) = identities
        .iter()
        .map(|identity| args.folder.join(identity.to_string()))
        .find(|path| path.exists())
    {
        bail!(
            "{} already exists; new keys would replace all the old ones, so choose a new folder",
            there.display()
        );
    }
    let mut hosts: Vec<String> = ["localhost", "127.0.0.1", "::1"]
        .map(str::to_owned)
        .to_vec();
    if args.hosts.is_empty() {
        hosts.extend(own_name());
        hosts.extend(own_address().map(|address| address.to_string()));
    }
    hosts.extend(args.hosts.iter().cloned());
    let folders = keys::make(&args.folder, &identities, &hosts, args.days * DAY)?;
    folders.iter().try_for_each(|folder| show(folder))?;
    screen::print(
        "\nAnyone with a folder has the rights that it grants: copy each folder only to the machine that needs it, and \
         use it with --keys FOLDER.\nA set cannot be extended: to add a participant or replace a lost folder, create a new set for all machines.\n",
    );
    Ok(())
}

fn named(text: &str) -> Result<Identity> {
    let wrong = "is not a valid name, expected 1 to 48 characters from a-z, A-Z, 0-9, _ and -";
    text.parse()
        .map_err(|_| UsageError(format!("{text:?} {wrong}")).into())
}

fn show(folder: &Path) -> Result<()> {
    let bundle = Bundle::load(folder)?;
    let [from, until] = &bundle.valid;
    let mut text = format!(
        "{}: {}, valid from {from} until {until}",
        folder.display(),
        bundle.identity
    );
    if !bundle.hosts.is_empty() {
        write!(text, ", for the hosts {}", bundle.hosts.join(", "))
            .expect("a text can be written to");
    }
    screen::print(&(text + "\n"));
    Ok(())
}

/// This machine's name, if the system reports it.
fn own_name() -> Option<String> {
    let name = std::fs::read_to_string("/proc/sys/kernel/hostname")
        .ok()?
        .trim()
        .to_owned();
    let is_host = name
        .chars()
        .all(|c| c.is_ascii_alphanumeric() || c == '-' || c == '.');
    (!name.is_empty() && name != "localhost" && is_host).then_some(name)
}
