//! `squall whatif`: what would have happened after a given time of a recorded game with other minds
//! or in another sea.

use crate::jobs_args::JobsArgs;
use crate::progress::Progress;
use crate::water_args::{self, within};
use crate::{output_file, recording_file, scenario_files, screen, stop};
use anyhow::{Context, Result, bail, ensure};
use command_line::explain::UsageError;
use command_line::number::whole;
use experiment::whatif::{self, Changes, Future, Past};
use experiment::{Estimate, Game};
use messages::input::Inputs;
use primitives::{SimTime, VehicleId};
use recording::{INPUTS, NewFile, Recording};
use rules::count::Counts;
use rules::event::EventCursor;
use scenario::strategy::Strategy;
use scenario::{Kind, load_file};
use serde::Serialize;
use sim::{Contest, GameRecorder, Report, Run};
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::sync::Arc;

#[derive(clap::Args)]
pub(crate) struct Args {
    /// Recording: a file, or part of a name listed by `squall runs` [default: the newest in runs]
    #[arg(value_name = "RECORDING", value_parser = recording_file::named)]
    file: Option<PathBuf>,
    /// Time after which futures differ from the recorded game, s
    #[arg(long, value_name = "SECONDS", value_parser = within(0.0, 86_400.0, "s"))]
    at: f64,
    /// Strategy that all blue boats continue with: a file or a name
    #[arg(long, value_name = "STRATEGY")]
    blue: Option<String>,
    /// Strategy that all red boats continue with
    #[arg(long, value_name = "STRATEGY")]
    red: Option<String>,
    /// Strategy that one boat continues with; may be repeated
    #[arg(long, value_name = "NAME=STRATEGY", value_parser = boat_and_strategy)]
    vehicle: Vec<(String, String)>,
    /// Sea after the time --at: a file or a name, such as gale
    #[arg(long, value_name = "SEA", value_parser = scenario_files::file_of(Kind::SEA))]
    sea: Option<PathBuf>,
    /// Number of futures
    #[arg(long, value_name = "N", default_value_t = 200, value_parser = whole::<u32>(5, 100_000))]
    futures: u32,
    #[command(flatten)]
    jobs: JobsArgs,
    /// Writes the results of all futures to this file as JSON
    #[arg(long, value_name = "FILE")]
    json: Option<PathBuf>,
    /// Records the future that the changes affect most, to watch with `squall replay`
    #[arg(long, value_name = "FILE")]
    record: Option<PathBuf>,
}

fn boat_and_strategy(word: &str) -> Result<(String, String), String> {
    let parts = word
        .split_once('=')
        .filter(|(a, b)| !a.is_empty() && !b.is_empty());
    let (boat, strategy) = parts.ok_or("expected NAME=STRATEGY, such as red_one=learned")?;
    Ok((boat.to_owned(), strategy.to_owned()))
}

/// The content of the `--json` file.
#[derive(Serialize)]
struct Compared<'a> {
    game: &'a str,
    at_s: f64,
    teams: [&'a str; 2],
    /// Means of all quantities with 95 % intervals.
    quantities: &'a [Row<'a>],
    /// Each future, as recorded and with the changes.
    futures: &'a [[Future; 2]],
}

pub(crate) fn run(args: &Args) -> Result<ExitCode> {
    let file = recording_file::or_newest(args.file.as_deref())?;
    let recording = recording_file::open(&file, "continue")?;
    let past = past_at(&recording, args.at)
        .with_context(|| format!("cannot continue {}", file.display()))?;
    let teams = [("blue", &args.blue), ("red", &args.red)];
    let teams = teams
        .iter()
        .filter_map(|(team, strategy)| Some((*team, strategy.as_deref()?)));
    let boats = args
        .vehicle
        .iter()
        .map(|(boat, strategy)| (boat.as_str(), strategy.as_str()));
    let sea = args.sea.as_deref();
    let changes = changes(&past, teams, boats, sea)?;
    ensure!(
        !changes.minds.is_empty() || changes.sea.is_some(),
        UsageError("nothing would change, expected --blue, --red, --vehicle or --sea".to_owned())
    );
    for path in args.json.iter().chain(&args.record) {
        output_file::check(path, "the result")?;
    }
    let stop = stop::on_ctrl_c()?;
    let count = args.futures as usize;
    let threads = args.jobs.threads(count);
    let mut progress = Progress::of(count as u64, "futures");
    let mut futures = vec![];
    let played = whatif::compare(&past, &changes, count, (threads, &stop), |future| {
        progress.add();
        futures.push(future);
        Ok(())
    });
    progress.end();
    played.map_err(anyhow::Error::msg)?;
    if futures.is_empty() {
        return Ok(stop::interrupted());
    }
    let name = recording.header().game.as_str();
    let teams = [0, 1].map(|team| past.scenario.teams[team].name.as_str());
    let quantities = rows(teams, &futures);
    screen::print(&text(name, args.at, futures.len(), &quantities));
    if let Some(path) = &args.json {
        let compared = Compared {
            game: name,
            at_s: args.at,
            teams,
            quantities: &quantities,
            futures: &futures,
        };
        output_file::write_json(path, "the result", &compared)?;
    }
    if let Some(path) = &args.record {
        record(path, name, &past, &changes, most_affected(&futures))?;
    }
    let is_whole = futures.len() == count;
    Ok(if is_whole {
        ExitCode::SUCCESS
    } else {
        stop::interrupted()
    })
}

/// Checks that a recorded game can be continued.
pub(crate) fn check(recording: &Recording) -> Result<()> {
    recording_file::check_inputs(recording)?;
    recording.scenario().has_no_real_boats()?;
    Ok(())
}

/// A recorded game, up to its end.
pub(crate) fn past(recording: &Recording) -> Result<Past> {
    check(recording)?;
    let scenario = recording.scenario().clone();
    let mut inputs = vec![];
    let mut until = SimTime::ZERO;
    for message in recording
        .bag()
        .messages()
        .filter(|message| message.topic == INPUTS)
    {
        let given: Inputs = message.read()?;
        until = given.stamp.valid_ns;
        let all: Option<Vec<_>> = given.of(&scenario).collect();
        let all = all.with_context(|| format!("cannot decode an input at {:.1} s", until.as_s()));
        inputs.extend(all?);
    }
    Ok(Past {
        scenario,
        inputs,
        until,
    })
}

/// The recorded game up to the first decision at or after a time.
pub(crate) fn past_at(recording: &Recording, at_s: f64) -> Result<Past> {
    let past = past(recording)?;
    let end_s = past.until.as_s();
    ensure!(
        at_s < end_s,
        UsageError(format!(
            "--at is {at_s}, expected less than {end_s:.1}, when the game ended"
        ))
    );
    let decision = past.scenario.decision();
    let decisions = (at_s / decision.as_s() - 1e-9).ceil().max(0.0);
    Ok(Past {
        until: decision * decisions as i64,
        ..past
    })
}

/// The changes: strategies by team and by boat, and the file of the sea.
pub(crate) fn changes<'a>(
    past: &Past,
    teams: impl Iterator<Item = (&'a str, &'a str)>,
    boats: impl Iterator<Item = (&'a str, &'a str)>,
    sea: Option<&Path>,
) -> Result<Changes> {
    let scenario = &past.scenario;
    let vehicles = &scenario.vehicles;
    let mut minds = vec![];
    let mut change = |key: &str, name: &str, strategy: &str, are: &dyn Fn(VehicleId) -> bool| {
        let path = scenario_files::find(strategy, Kind::STRATEGY)?;
        let strategy = load_file::<Strategy>(&path)?;
        let boats = (0..vehicles.len())
            .map(VehicleId::at)
            .filter(|boat| are(*boat));
        let before = minds.len();
        minds.extend(boats.map(|boat| (boat, Box::new(strategy.clone()))));
        if minds.len() == before {
            let known: Vec<&str> = vehicles
                .iter()
                .map(|vehicle| vehicle.name.as_str())
                .collect();
            bail!(UsageError(format!(
                "{key} is {name:?}, which this game does not have; its boats are {}",
                known.join(", ")
            )));
        }
        Ok(())
    };
    for (team, strategy) in teams {
        change("the team", team, strategy, &|boat| {
            scenario.teams[scenario.team_of(boat).index()].name == team
        })?;
    }
    for (name, strategy) in boats {
        change("--vehicle", name, strategy, &|boat| {
            vehicles[boat.index()].name == *name
        })?;
    }
    let sea = sea.map(|path| water_args::sea(path, scenario.seed));
    Ok(Changes {
        minds,
        sea: sea.transpose()?,
    })
}

/// The future in which the changes alter the result most.
fn most_affected(futures: &[[Future; 2]]) -> usize {
    let by =
        |[before, after]: &[Future; 2]| (after.game.margin() - before.game.margin()).unsigned_abs();
    (0..futures.len())
        .rev()
        .max_by_key(|i| by(&futures[*i]))
        .unwrap_or(0)
}

/// A quantity to compare: its name, its value in a game for a team, and whether that is a fraction.
type Quantity = (&'static str, fn(&Game, usize) -> f64, bool);

const QUANTITIES: [Quantity; 7] = [
    (
        "wins",
        |game, team| f64::from(game.winner == Some(team)),
        true,
    ),
    ("points", |game, team| f64::from(game.score[team]), false),
    ("grabs", |game, team| of(game, team, |c| c.grabs), false),
    (
        "captures",
        |game, team| of(game, team, |c| c.captures),
        false,
    ),
    ("tags", |game, team| of(game, team, |c| c.tags), false),
    (
        "out of bounds",
        |game, team| of(game, team, |c| c.out_of_bounds),
        false,
    ),
    (
        "collisions",
        |game, team| of(game, team, |c| c.collisions),
        false,
    ),
];

fn of(game: &Game, team: usize, count: fn(&Counts) -> u32) -> f64 {
    f64::from(count(&game.counts[team]))
}

/// A quantity of a team per game.
#[derive(Serialize)]
pub(crate) struct Row<'a> {
    team: &'a str,
    quantity: &'static str,
    /// Whether the quantity is a fraction of all games.
    is_share: bool,
    recorded: Estimate,
    changed: Estimate,
    difference: Estimate,
}

/// All quantities of both teams.
pub(crate) fn rows<'a>(teams: [&'a str; 2], futures: &[[Future; 2]]) -> Vec<Row<'a>> {
    let mut rows = vec![];
    for (team, name) in teams.into_iter().enumerate() {
        for (quantity, value, is_share) in QUANTITIES {
            let estimate = |of: &dyn Fn([&Game; 2]) -> f64| {
                let each = futures.iter().map(|[a, b]| of([&a.game, &b.game]));
                Estimate::of(&each.collect::<Vec<_>>())
            };
            rows.push(Row {
                team: name,
                quantity,
                is_share,
                recorded: estimate(&|[recorded, _]| value(recorded, team)),
                changed: estimate(&|[_, changed]| value(changed, team)),
                difference: estimate(&|[recorded, changed]| {
                    value(changed, team) - value(recorded, team)
                }),
            });
        }
    }
    rows
}

/// The table of all quantities, with 95 % intervals.
fn text(name: &str, at_s: f64, futures: usize, rows: &[Row<'_>]) -> String {
    let mut text = format!(
        "{futures} futures of {name} from {at_s} s on, each with the same random numbers for both columns\n\n\
         {:<22}{:>16}{:>16}{:>18}\n",
        "a game, ± 95 %", "as recorded", "changed", "difference"
    );
    for row in rows {
        let (times, unit, digits) = if row.is_share {
            (100.0, " %", 0)
        } else {
            (1.0, "", 2)
        };
        let column = |estimate: &Estimate, sign: &str| {
            let mean = estimate.mean * times;
            let half = estimate.half_width().unwrap_or(f64::NAN) * times;
            let sign = if mean > 0.0 { sign } else { "" };
            format!("{sign}{mean:.digits$} ± {half:.digits$}{unit}")
        };
        text += &format!(
            "{:<22}{:>16}{:>16}{:>18}\n",
            format!("{} {}", row.team, row.quantity),
            column(&row.recorded, ""),
            column(&row.changed, ""),
            column(&row.difference, "+")
        );
    }
    text
}

/// Plays a future again and records it.
fn record(path: &Path, name: &str, past: &Past, changes: &Changes, future: usize) -> Result<()> {
    // If the file did not exist, `check` has created and removed it; nothing is overwritten.
    let file =
        NewFile::create(path).with_context(|| format!("cannot record to {}", path.display()))?;
    let mut recorder = GameRecorder::in_process(file, name, env!("SQUALL_COMMIT"));
    let mut written = EventCursor::default();
    let watch = |contest: &mut Contest| {
        let frame = Arc::new(contest.frame(&mut written));
        recorder.decision(contest, frame);
        true
    };
    let contest = whatif::play(past, changes, whatif::seed_of(past, future), watch)?;
    let run = Run {
        pace: "in process".to_owned(),
        ..Run::default()
    };
    let outcome = contest.outcome();
    let problem = recorder.end(&Report { outcome, run }).problem();
    ensure!(
        problem.is_none(),
        "the recording is incomplete: {}",
        problem.unwrap_or_default()
    );
    screen::remark(&format!(
        "future {future} is affected most by the changes; show it with: squall replay {}",
        path.display()
    ));
    if changes.sea.is_some() {
        screen::remark(
            "the sea changes during this recording, so `squall replay --check` reports a difference then",
        );
    }
    Ok(())
}
