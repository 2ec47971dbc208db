//! Reports on the page: tournaments, leagues, sweeps and training runs.

use super::games::{Game, Games, Source};
use super::training::TrainingReport;
use anyhow::{Context, Result, anyhow, bail};
use experiment::Packed;
use experiment::{sweep, tournament};
use primitives::input_file;
use serde_json::{Value, json};
use shore::page::{Report, Shown};
use std::collections::BTreeMap;
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

/// Size limit of a report file, bytes.
const BYTES_MAX: u64 = 256 << 20;

/// Opens the report at a path: a file, or the folder that contains it.
pub(super) fn open(path: &Path, stop: &Arc<AtomicBool>) -> Result<Arc<dyn Report>> {
    let games = Games::new(stop)?;
    if !path.is_dir() {
        return of_file(path, games);
    }
    let file = path.join("report.json");
    if file.exists() {
        return of_file(&file, games);
    }
    if TrainingReport::is_in(path) {
        return Ok(Arc::new(TrainingReport::open(path, games)?));
    }
    bail!(
        "there is no report in {}, expected report.json (of a league or a sweep) or updates.csv (of a training run)",
        path.display()
    )
}

fn of_file(path: &Path, games: Games) -> Result<Arc<dyn Report>> {
    let bytes = read(path)?;
    let is_none = || format!("{} is not a report", path.display());
    let value: Value = serde_json::from_slice(&bytes).with_context(is_none)?;
    match ["tournament", "sweep"].map(|kind| value.get(kind).is_some()) {
        [true, _] => Ok(Arc::new(TournamentReport::new(
            serde_json::from_slice(&bytes).with_context(is_none)?,
            games,
        ))),
        [_, true] => Ok(Arc::new(
            SweepReport::open(path, &value, games).with_context(is_none)?,
        )),
        _ => bail!(
            "{} is not a report: it has neither the key tournament nor sweep",
            path.display()
        ),
    }
}

/// Reads a whole file.
pub(super) fn read(path: &Path) -> Result<Vec<u8>> {
    input_file::read(path, BYTES_MAX).with_context(|| format!("cannot read {}", path.display()))
}

/// The report of a tournament or a league.
struct TournamentReport {
    json: Vec<u8>,
    /// The plan, or the reason why its games cannot be replayed.
    plan: Result<tournament::Plan, String>,
    /// The digests in the report, by game index.
    digests: BTreeMap<usize, String>,
    games: Games,
}

impl TournamentReport {
    fn new(mut report: tournament::Report, games: Games) -> TournamentReport {
        let plan = match report.plan.take() {
            None => Err("the report has no plan".to_owned()),
            Some(packed) => tournament::Plan::unpack(packed).map_err(|why| why.to_string()),
        };
        let digests = report
            .matches
            .iter()
            .map(|row| (row.game, row.digest.clone()))
            .collect();
        let mut shown = serde_json::to_value(&report).expect("its map keys are strings");
        // JavaScript numbers cannot represent every seed.
        let spell = |row: &mut Value| row["seed"] = row["seed"].to_string().into();
        spell(&mut shown);
        for list in ["matches", "failures"] {
            shown[list]
                .as_array_mut()
                .into_iter()
                .flatten()
                .for_each(spell);
        }
        let json =
            json!({"kind": "tournament", "report": shown, "unplayable": plan.as_ref().err()});
        TournamentReport {
            json: json.to_string().into_bytes(),
            plan,
            digests,
            games,
        }
    }

    fn find(&self, name: &str) -> Result<Game> {
        let plan = self
            .plan
            .as_ref()
            .map_err(|why| anyhow!("cannot rerun games: {why}"))?;
        let place = place_of(name, plan.games())?;
        let (of, scenario) = plan.match_at(place);
        let [blue, red] = of
            .sides
            .map(|entry| plan.tournament().entries[entry].name.replace('_', " "));
        let teams = plan.teams();
        Ok(Game {
            about: format!(
                "{blue} ({}) against {red} ({}), seed {}",
                teams[0], teams[1], of.seed
            ),
            source: Source::Played {
                scenario: Box::new(scenario.clone()),
                seed: of.seed,
                digest: self.digests.get(&place).cloned(),
            },
        })
    }
}

/// Parses a game's index, which must be below `games`.
fn place_of(name: &str, games: usize) -> Result<usize> {
    name.parse()
        .ok()
        .filter(|place| *place < games)
        .with_context(|| {
            format!(
                "there is no game {name:?}, expected a number from 0 to {}",
                games.saturating_sub(1)
            )
        })
}

impl Report for TournamentReport {
    fn file(&self, path: &str) -> Option<Vec<u8>> {
        (path == "/report.json").then(|| self.json.clone())
    }

    fn game(&self, name: &str) -> Shown {
        self.games.show(name, || self.find(name))
    }
}

/// The request path for the games of a point, followed by the point's number.
const GAMES_OF_POINT: &str = "/sweep_games/";
/// Maximum number of listed games of a point.
const LISTED_MAX: usize = 10_000;

/// The report of a sweep and its games.
struct SweepReport {
    json: Vec<u8>,
    plan: Result<sweep::Plan, String>,
    /// The results from the table next to the report, in game order.
    rows: Result<Vec<sweep::Row>, String>,
    /// The digests of the worst games in the report, used if the table lacks them.
    digests: BTreeMap<usize, String>,
    games: Games,
}

impl SweepReport {
    fn open(path: &Path, value: &Value, games: Games) -> Result<SweepReport> {
        for key in [
            "axes",
            "entries",
            "metrics",
            "points",
            "effects",
            "interactions",
            "worst",
            "failures",
        ] {
            if !value[key].is_array() {
                bail!("{key} is missing or not a list");
            }
        }
        let plan = unpacked(&path.with_file_name(sweep::PACKED_PLAN));
        let table = || read(&path.with_file_name(sweep::GAMES));
        let rows = match &plan {
            Ok(plan) => table().map(|bytes| sweep::rows_in(plan, &String::from_utf8_lossy(&bytes))),
            Err(_) => Ok(vec![]),
        };
        let plan = plan.map_err(|why| command_line::explain::line(&why));
        let rows = rows.map_err(|why| command_line::explain::line(&why));
        let worst = value["worst"].as_array().into_iter().flatten();
        let digest = |game: &Value| {
            Some((
                usize::try_from(game["game"].as_u64()?).ok()?,
                game["digest"].as_str()?.to_owned(),
            ))
        };
        let digests = worst.filter_map(digest).collect();
        let json = json!({"kind": "sweep", "report": value, "playable": plan.is_ok()});
        Ok(SweepReport {
            json: json.to_string().into_bytes(),
            plan,
            rows,
            digests,
            games,
        })
    }

    /// The result of a game, if the table contains it.
    fn row(&self, index: usize) -> Option<&sweep::Row> {
        self.rows.as_ref().ok()?.get(index)
    }

    /// The games of a point, as JSON for the page.
    fn games_at(&self, point: usize) -> Option<Value> {
        let plan = self
            .plan
            .as_ref()
            .ok()
            .filter(|plan| point < plan.points().len())?;
        let count = plan.games_per_point();
        let first = point * plan.games_per_point();
        let game = |index: usize| {
            let job = plan.job(index);
            let result = self.row(index).map(|row| &row.result);
            json!({
                "game": index,
                "entry": job.entry,
                "team": plan.teams()[job.side],
                // JavaScript numbers cannot represent every seed.
                "seed": job.seed.to_string(),
                "score": result.and_then(|result| result.as_ref().ok()).map(sweep::Metrics::score),
                "why": result.and_then(|result| result.as_ref().err()),
            })
        };
        let games: Vec<Value> = (first..first + count.min(LISTED_MAX)).map(game).collect();
        Some(
            json!({"games": games, "left_out": count - games.len(), "problem": self.rows.as_ref().err()}),
        )
    }

    fn find(&self, name: &str) -> Result<Game> {
        let plan = self
            .plan
            .as_ref()
            .map_err(|why| anyhow!("cannot rerun games: {why}"))?;
        let job = plan.job(place_of(name, plan.games())?);
        let scenario = plan.scenario(job.point, job.entry, job.side)?;
        let sweep = plan.sweep();
        let values = &plan.points()[job.point];
        let axes: Vec<String> = sweep
            .axes
            .iter()
            .zip(values)
            .map(|(axis, value)| format!("{} {value}", axis.key))
            .collect();
        let entry = sweep.entries[job.entry].name.replace('_', " ");
        let team = &plan.teams()[job.side];
        Ok(Game {
            about: format!("{entry} ({team}) at {}, seed {}", axes.join(", "), job.seed),
            source: Source::Played {
                scenario: Box::new(scenario),
                seed: job.seed,
                digest: self.digest(job.index).cloned(),
            },
        })
    }

    fn digest(&self, index: usize) -> Option<&String> {
        let in_table = self
            .row(index)
            .map(|row| &row.digest)
            .filter(|digest| !digest.is_empty());
        in_table.or_else(|| self.digests.get(&index))
    }
}

fn unpacked(path: &Path) -> Result<sweep::Plan> {
    let packed: Packed = serde_json::from_slice(&read(path)?)
        .with_context(|| format!("{} is not a plan", path.display()))?;
    Ok(sweep::Plan::unpack(packed)?)
}

impl Report for SweepReport {
    fn file(&self, path: &str) -> Option<Vec<u8>> {
        if let Some(point) = path
            .strip_prefix(GAMES_OF_POINT)
            .and_then(|rest| rest.strip_suffix(".json"))
        {
            return self
                .games_at(point.parse().ok()?)
                .map(|games| games.to_string().into_bytes());
        }
        (path == "/report.json").then(|| self.json.clone())
    }

    fn game(&self, name: &str) -> Shown {
        self.games.show(name, || self.find(name))
    }
}
