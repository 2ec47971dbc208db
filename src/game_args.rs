//! Command line arguments that select a game and override its file; shared by `run` and `sim`.

use crate::output_file;
use crate::{scenario_files, screen};
use anyhow::{Context, Error, Result, bail};
use command_line::explain::UsageError;
use command_line::number::whole;
use scenario::{Files, Kind, Overrides, Scenario, Setting};
use sim::Report;
use std::path::{Path, PathBuf};
use std::sync::Arc;

#[derive(Clone, clap::Args)]
pub(crate) struct GameArgs {
    /// Game: a file, or the name of a built-in game or of one in scenarios/games
    #[arg(value_name = "GAME", value_parser = scenario_files::file_of(Kind::GAME))]
    scenario: PathBuf,
    /// Random seed [default: the seed in the game file]
    #[arg(long, value_parser = whole::<u64>(0, u64::MAX))]
    pub(crate) seed: Option<u64>,
    /// Sea to use instead of the game's: a file or a name, such as gale
    #[arg(long, value_name = "SEA", value_parser = scenario_files::file_of(Kind::SEA))]
    sea: Option<PathBuf>,
    /// Field to use instead of the game's: a file or a name
    #[arg(long, value_name = "FIELD", value_parser = scenario_files::file_of(Kind::FIELD))]
    field: Option<PathBuf>,
    /// Strategy for all blue boats, overriding the game's: a file or a name. Names are looked up
    /// first in the strategies folder next to the game's folder. FILE.onnx plays a trained policy,
    /// host:FOLDER a competition entry
    #[arg(long, value_name = "STRATEGY")]
    blue: Option<String>,
    /// Strategy for all red boats, as for --blue
    #[arg(long, value_name = "STRATEGY")]
    red: Option<String>,
    /// Strategy for all boats of this team, as for --blue; may be repeated
    #[arg(long, value_name = "TEAM=FILE", value_parser = team_and_file)]
    strategy: Vec<(String, String)>,
    /// Exchanges the teams' strategies
    #[arg(long)]
    pub(crate) exchange_strategies: bool,
    /// Overrides a value in the scenario files, for example sea.wind.speed_m_s=12,
    /// boat.gps.noise_m=2 or link.delay_s=1; may be repeated
    #[arg(long = "set", value_name = "KEY=VALUE", value_parser = Setting::parse)]
    settings: Vec<Setting>,
    /// Simulates all external boats instead of waiting for gateways
    #[arg(long)]
    rehearse: bool,
    /// Writes the result to this file as JSON
    #[arg(long, value_name = "FILE")]
    json: Option<PathBuf>,
}

impl GameArgs {
    /// The file of the game.
    pub(crate) fn file(&self) -> &Path {
        &self.scenario
    }

    /// Loads the scenario; the error lists every problem.
    pub(crate) fn load(&self) -> Result<Scenario> {
        self.load_from(&Arc::default())
    }

    pub(crate) fn load_from(&self, files: &Arc<Files>) -> Result<Scenario> {
        // The seed may also decide which boats there are.
        scenario::load_with_files(&self.scenario, &self.overrides()?, files)
            .and_then(|game| game.of_seed(self.seed(&game)))
            .with_context(|| format!("cannot play {}", self.scenario.display()))
    }

    /// The seed that selects one of the scenario's games.
    pub(crate) fn seed(&self, scenario: &Scenario) -> u64 {
        self.seed.unwrap_or(scenario.seed)
    }

    /// Checks that the result file can be written.
    pub(crate) fn check_result_file(&self) -> Result<()> {
        self.json
            .as_ref()
            .map_or(Ok(()), |path| output_file::check(path, "the result"))
    }

    /// Writes the game's result to a file, if requested.
    pub(crate) fn write_result(&self, report: &Report) -> Result<()> {
        self.json.as_ref().map_or(Ok(()), |path| {
            output_file::write_json(path, "the result", &result_of(report)?)
        })
    }

    /// Writes the results of several games to a file, if requested.
    pub(crate) fn write_results(&self, reports: &[Report], sum: &serde_json::Value) -> Result<()> {
        let Some(path) = &self.json else {
            return Ok(());
        };
        let games = reports.iter().map(result_of).collect::<Result<Vec<_>>>()?;
        output_file::write_json(
            path,
            "the results",
            &serde_json::json!({ "games": games, "sum": sum }),
        )
    }

    /// Prints a remark if `--rehearse` has no effect.
    pub(crate) fn remark_on_rehearsal(&self) -> Result<()> {
        let overrides = Overrides {
            simulate_all: false,
            ..self.overrides()?
        };
        if self.rehearse
            && scenario::load_with(&self.scenario, &overrides)?
                .externals()
                .next()
                .is_none()
        {
            screen::remark("--rehearse has no effect: this game has no real boats");
        }
        Ok(())
    }

    /// The overrides of the game file.
    pub(crate) fn overrides(&self) -> Result<Overrides> {
        let mut settings = self.settings.clone();
        if let Some(field) = &self.field {
            let field = format!(
                "game.field={}",
                serde_json::Value::from(field.display().to_string())
            );
            settings.push(Setting::parse(&field).map_err(anyhow::Error::msg)?);
        }
        let mut overrides = Overrides {
            sea: self.sea.clone(),
            exchange_strategies: self.exchange_strategies,
            simulate_all: self.rehearse,
            settings,
            ..Overrides::default()
        };
        let beside = self.scenario.parent().unwrap_or(Path::new(""));
        let folder = beside
            .parent()
            .unwrap_or(Path::new(".."))
            .join(Kind::STRATEGY.folder());
        let named = [("blue", &self.blue), ("red", &self.red)];
        let named = named.into_iter().filter_map(|(team, file)| {
            Some((format!("--{team} <STRATEGY>"), team, file.as_deref()?))
        });
        let of_teams = self.strategy.iter().map(|(team, file)| {
            let option = "--strategy <TEAM=FILE>".to_owned();
            (option, team.as_str(), file.as_str())
        });
        for (option, team, file) in named.chain(of_teams) {
            let path = scenario_files::find_beside(file, Kind::STRATEGY, Some(&folder));
            let path = path.map_err(|e: Error| {
                UsageError(format!("invalid value '{file}' for '{option}': {e}"))
            })?;
            if overrides.strategies.insert(team.to_owned(), path).is_some() {
                bail!(UsageError(format!(
                    "the strategy of team {team} is given twice, expected once"
                )));
            }
        }
        Ok(overrides)
    }
}

/// A game's outcome and the data about its run, as JSON.
fn result_of(report: &Report) -> Result<serde_json::Value> {
    let mut value =
        serde_json::to_value(&report.outcome).context("cannot encode the result as JSON")?;
    value["run"] = serde_json::to_value(&report.run).context("cannot encode the result as JSON")?;
    Ok(value)
}

/// Parses `TEAM=FILE`.
fn team_and_file(text: &str) -> Result<(String, String), String> {
    match text.split_once('=') {
        Some((team, file)) if !team.is_empty() && !file.is_empty() => {
            Ok((team.to_owned(), file.to_owned()))
        }
        _ => Err("expected TEAM=FILE".to_owned()),
    }
}
