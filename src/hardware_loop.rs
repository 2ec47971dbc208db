//! The hardware loop, closed on one machine: water of its own, an emulated boat and a gateway for every real one.

use crate::child_process::{self, ChildProcess, option};
use crate::net_args::unique_game_name;
use crate::override_args;
use anyhow::{Context, Result, anyhow, bail};
use game::Scenario;
use game::scenario::Overrides;
use sim::node::Pace;
use std::path::{Path, PathBuf};
use std::process::Stdio;
use std::time::Duration;

/// What `run` is asked of it.
#[derive(clap::Args)]
pub(crate) struct LoopArgs {
    /// Emulated boats stand in for the real ones: they float in water of their own, speak the Surveyor's sentences and are
    /// driven through gateways, which tell how they were in the end
    #[arg(long, conflicts_with_all = ["in_process", "rehearse"])]
    emulate: bool,
    /// How the gateways drive them: a gateway file [default: a Surveyor, carefully]
    #[arg(long, value_name = "FILE", requires = "emulate")]
    gateway: Option<PathBuf>,
    /// Records what goes through each gateway into this folder, as NAME.mcap
    #[arg(long, value_name = "DIR", requires = "emulate")]
    record_gateways: Option<PathBuf>,
}

/// The game that the boats are to play in.
pub(crate) struct Match<'a> {
    pub(crate) file: &'a Path,
    pub(crate) scenario: &'a Scenario,
    pub(crate) overrides: &'a Overrides,
    pub(crate) seed: u64,
    pub(crate) pace: Pace,
    pub(crate) game: &'a str,
    pub(crate) endpoint: &'a str,
}

/// How long an emulator may take to report where it listens.
const WINDOW: Duration = Duration::from_secs(20);
/// How long everybody may take to end.
const LEAVE: Duration = Duration::from_secs(5);

/// The processes of the loop.
pub(crate) struct HardwareLoop {
    /// Gateways, then emulators: the order in which they are to end.
    ends: Vec<ChildProcess>,
    water: ChildProcess,
}

impl LoopArgs {
    /// Starts the loop, if it is asked for and there are real boats.
    pub(crate) fn start(&self, game: &Match<'_>) -> Result<Option<HardwareLoop>> {
        let vehicles = game.scenario.externals().map(|vehicle| &game.scenario.vehicles[vehicle.index()]);
        let names: Vec<&str> = vehicles.map(|vehicle| vehicle.name.as_str()).collect();
        if !self.emulate {
            return Ok(None);
        }
        if names.is_empty() {
            bail!("no boat of this game is real: --emulate has nothing to stand in for");
        }
        let declination_deg = match &self.gateway {
            None => None,
            Some(path) => {
                let gateway = game::scenario::load_gateway(path)
                    .with_context(|| format!("cannot drive by {}", path.display()))?;
                gateway.declination_rad.map(f64::to_degrees)
            }
        };
        if let Some(folder) = &self.record_gateways {
            std::fs::create_dir_all(folder).with_context(|| format!("cannot make the folder {}", folder.display()))?;
        }
        let port = bus::free_port(false).map_err(|e| anyhow!("no free port on this machine: {e}"))?;
        let name = unique_game_name("water")?.as_str().to_owned();
        let endpoint = format!("tcp/127.0.0.1:{port}");
        let place = (name.as_str(), endpoint.as_str());
        let water = start_water(game, &names, place)?;
        let (mut emulators, mut gateways) = (Vec::new(), Vec::new());
        for vehicle in names {
            let (emulator, link) = start_emulator(vehicle, declination_deg, place)?;
            emulators.push(emulator);
            gateways.push(self.start_gateway(vehicle, &link, game)?);
        }
        gateways.extend(emulators);
        Ok(Some(HardwareLoop { ends: gateways, water }))
    }

    fn start_gateway(&self, name: &str, link: &str, game: &Match<'_>) -> Result<ChildProcess> {
        let mut command =
            child_process::squall(&["gateway", "surveyor", "--game", game.game, "--connect", game.endpoint])?;
        command.args(["--vehicle", name, "--link", link, "--arm", "--at-game-pace"]);
        option(&mut command, "--config", self.gateway.as_ref().map(|path| path.display()));
        match &self.record_gateways {
            Some(folder) => command.arg("--record").arg(folder.join(format!("{name}.mcap"))),
            None => command.arg("--no-record"),
        };
        ChildProcess::start(&format!("the gateway of {name}"), command, Stdio::inherit())
    }
}

impl HardwareLoop {
    /// Ends it all, gateways first: they leave their boats at rest. Says who ended badly.
    pub(crate) fn end(mut self) -> Vec<String> {
        let mut badly = Vec::new();
        for one in &mut self.ends {
            one.ask_to_stop();
            badly.extend(child_process::wait_for_all(std::slice::from_mut(one), LEAVE));
        }
        // The water has no end of its own: it is cut short, and says so.
        self.water.ask_to_stop();
        child_process::wait_for_all(std::slice::from_mut(&mut self.water), LEAVE);
        badly
    }
}

fn start_water(game: &Match<'_>, names: &[&str], (water, endpoint): (&str, &str)) -> Result<ChildProcess> {
    let mut command = child_process::squall(&["sim", "--game", water, "--listen", endpoint])?;
    command.arg(game.file).args(override_args::words(game.overrides));
    option(&mut command, "--pace", Some(game.pace));
    option(&mut command, "--seed", Some(game.seed));
    command.arg("--afloat").args(names);
    ChildProcess::start("the water", command, Stdio::null())
}

/// Starts an emulator; gives it and the address of its link.
fn start_emulator(
    name: &str,
    declination_deg: Option<f64>,
    (water, endpoint): (&str, &str),
) -> Result<(ChildProcess, String)> {
    let listen = "tcp://127.0.0.1:0";
    let mut command = child_process::squall(&["gateway", "emulate", "--game", water, "--connect", endpoint])?;
    command.args(["--vehicle", name, "--listen", listen]);
    option(&mut command, "--declination-deg", declination_deg);
    let mut emulator = ChildProcess::start(&format!("the emulator of {name}"), command, Stdio::piped())?;
    let addresses = emulator.lines(|line| line.strip_prefix("back seat at ").map(str::to_owned))?;
    let address = addresses.recv_timeout(WINDOW);
    Ok((emulator, address.map_err(|_| anyhow!("the emulator of {name} does not report where it listens"))?))
}
