//! The hardware loop on one machine: a separate water simulation, and an emulated boat and a
//! gateway for each real boat.

use super::child_process::{self, ChildProcess, option};
use super::hub_args::{free_port, unique_game_name};
use super::pace_args::PaceArgs;
use crate::game_args::GameArgs;
use crate::{output_file, scenario_files};
use anyhow::{Context, Result, anyhow, bail};
use bus::keys::Identity;
use command_line::explain::UsageError;
use gateway::config::{BoatProtocol, Gateway};
use recording::{LentFile, NewFile};
use scenario::{Kind, Scenario};
use std::path::{Path, PathBuf};
use std::process::Stdio;
use std::time::Duration;

#[derive(Clone, clap::Args)]
pub(crate) struct LoopArgs {
    /// Replaces real boats with emulated boats, driven by gateways over the protocol that the
    /// gateway file specifies; prints the gateways' final status
    #[arg(long, conflicts_with_all = ["in_process", "rehearse"])]
    emulate: bool,
    /// Gateway settings: a file or a name [default: a Surveyor with conservative limits]
    #[arg(long, value_name = "GATEWAY", requires = "emulate", value_parser = scenario_files::file_of(Kind::of::<Gateway>()))]
    gateway: Option<PathBuf>,
    /// Records the link traffic of each gateway to NAME.mcap in this folder
    #[arg(long, value_name = "DIR", requires = "emulate")]
    record_gateways: Option<PathBuf>,
}

/// Maximum number of emulated boats, each of which needs two processes.
const BOATS_MAX: usize = 32;
/// Maximum time for an emulator to report its address.
const WINDOW: Duration = Duration::from_secs(20);
/// The processes of the loop.
pub(crate) struct HardwareLoop {
    /// Gateways, then emulators, in the order of shutdown.
    ends: Vec<ChildProcess>,
    water: ChildProcess,
    /// Written by the gateways; an empty file is removed.
    _recordings: Vec<LentFile>,
}

impl LoopArgs {
    /// Starts the loop for the real boats of the game with this name and endpoint, if requested.
    pub(crate) fn start(
        &self,
        (args, pace): (&GameArgs, &PaceArgs),
        scenario: &Scenario,
        game: (&str, &str),
        keys: Option<&Path>,
    ) -> Result<Option<HardwareLoop>> {
        let vehicles = scenario
            .externals()
            .map(|vehicle| &scenario.vehicles[vehicle.index()]);
        let names: Vec<&str> = vehicles.map(|vehicle| vehicle.name.as_str()).collect();
        if !self.emulate {
            return Ok(None);
        }
        if names.is_empty() {
            bail!(UsageError(
                "--emulate requires a game with at least one external boat".to_owned()
            ));
        }
        if names.len() > BOATS_MAX {
            bail!(
                "this game has {} real boats, expected at most {BOATS_MAX} with --emulate",
                names.len()
            );
        }
        let gateway = match &self.gateway {
            None => gateway::config::default_gateway(),
            Some(path) => scenario::load_file::<Gateway>(path)
                .with_context(|| format!("cannot use the gateway file {}", path.display()))?,
        };
        let mut recordings = Vec::new();
        if let Some(folder) = &self.record_gateways {
            output_file::make_folder(folder)?;
            // Check first: a gateway that refuses to record would leave its boat out of the game.
            for path in names.iter().map(|name| folder.join(format!("{name}.mcap"))) {
                let file = NewFile::create(&path)
                    .with_context(|| format!("cannot record to {}", path.display()))?;
                recordings.push(file.lend());
            }
        }
        let port = free_port(false)?;
        let name = unique_game_name("water")?.as_str().to_owned();
        let endpoint = format!("tcp/127.0.0.1:{port}");
        let place = (name.as_str(), endpoint.as_str());
        let mut water = pace.sim(args, place.0, place.1)?;
        water.arg("--afloat").args(&names);
        let water = ChildProcess::start("the water", water, Stdio::null())?;
        let mut emulators = Vec::new();
        let mut gateways = Vec::new();
        for vehicle in names {
            let (emulator, link) = start_emulator(vehicle, &gateway, place)?;
            emulators.push(emulator);
            gateways.push(self.start_gateway(vehicle, &link, game, keys)?);
        }
        gateways.extend(emulators);
        Ok(Some(HardwareLoop {
            ends: gateways,
            water,
            _recordings: recordings,
        }))
    }

    fn start_gateway(
        &self,
        name: &str,
        link: &str,
        (game, endpoint): (&str, &str),
        keys: Option<&Path>,
    ) -> Result<ChildProcess> {
        let mut command =
            child_process::squall(&["gateway", "surveyor", "--game", game, "--connect", endpoint])?;
        command.args(["--vehicle", name, "--link", link, "--arm", "--at-game-pace"]);
        child_process::give_keys(&mut command, keys, &Identity::Gateway(None));
        option(
            &mut command,
            "--config",
            self.gateway.as_ref().map(|path| path.display()),
        );
        match &self.record_gateways {
            Some(folder) => command
                .arg("--record")
                .arg(folder.join(format!("{name}.mcap"))),
            None => command.arg("--no-record"),
        };
        ChildProcess::start(&format!("the gateway of {name}"), command, Stdio::inherit())
    }
}

impl HardwareLoop {
    /// Stops all processes, gateways first, so that their boats are left at rest. Returns the
    /// failures.
    pub(crate) fn end(mut self) -> Vec<String> {
        let badly = self.ends.iter_mut().flat_map(ChildProcess::stop).collect();
        // The water simulation never ends by itself; stopping it makes it report that it was cut
        // short.
        self.water.stop();
        badly
    }
}

/// Starts an emulator; returns it and the address of its link.
fn start_emulator(
    name: &str,
    gateway: &Gateway,
    (water, endpoint): (&str, &str),
) -> Result<(ChildProcess, String)> {
    let listen = "tcp://127.0.0.1:0";
    let mut command =
        child_process::squall(&["gateway", "emulate", "--game", water, "--connect", endpoint])?;
    // The battery must outlast the game: only the game or the gateway may stop a boat.
    command.args([
        "--vehicle",
        name,
        "--listen",
        listen,
        "--charge-pct",
        "none",
    ]);
    match gateway.protocol {
        BoatProtocol::Surveyor => {
            option(
                &mut command,
                "--declination-deg",
                gateway.declination_rad.map(f64::to_degrees),
            );
        }
        BoatProtocol::Mavlink => {
            command.args(["--protocol", "mavlink"]);
        }
    }
    let mut emulator =
        ChildProcess::start(&format!("the emulator of {name}"), command, Stdio::piped())?;
    let addresses = emulator.lines(|line| line.strip_prefix("back seat at ").map(str::to_owned))?;
    let address = addresses.recv_timeout(WINDOW);
    Ok((
        emulator,
        address.map_err(|_| anyhow!("the emulator of {name} did not report its address"))?,
    ))
}
