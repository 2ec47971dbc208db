//! The games of a sweep.

use super::{Axis, AxisValue, Design, Sweep};
use crate::jobs::{load_game, strategy_option, teams_of, too_many_games};
use crate::tournament::Entrant;
use crate::{Packed, UnpackError};
use primitives::stream::Stream;
use scenario::{Files, Overrides, Problem, Problems, Scenario, Setting, argument_for, digest_of};
use std::collections::BTreeSet;
use std::path::PathBuf;
use std::sync::Arc;

/// The maximum number of points of a grid.
const POINTS_MAX: usize = 100_000;
/// The number of Sobol dimensions in use, which is the maximum number of axes.
const SOBOL_DIMENSIONS: u32 = 50;

/// A sweep with all required files.
#[derive(Clone, Debug)]
pub struct Plan {
    sweep: Sweep,
    teams: Vec<String>,
    seeds: u64,
    points: Vec<Point>,
    files: Arc<Files>,
}

/// A point of the space: a value for each axis.
pub type Point = Vec<AxisValue>;

/// One game of a sweep.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Job {
    /// The game's index in the order of the sweep.
    pub index: usize,
    /// The index of the point.
    pub point: usize,
    /// The index of the entry.
    pub entry: usize,
    /// The seed of the game.
    pub seed: u64,
    /// Whether the entry is the first team (0) or the second (1).
    pub side: usize,
}

impl Plan {
    /// The games of a sweep, after checking the game at every point.
    ///
    /// # Errors
    /// All problems at any point, or a grid of more than 100,000 points.
    pub fn new(sweep: &Sweep) -> Result<Plan, Problems> {
        let plan = Plan::unchecked(sweep, Arc::default())?;
        let mut problems = vec![];
        // Check each point with one entry, and each entry at one point. All other games combine the
        // same points and strategies.
        let of_points = (0..plan.points.len()).map(|point| (point, 0));
        for (point, entry) in of_points.chain((1..sweep.entries.len()).map(|entry| (0, entry))) {
            if let Err(Problems(found)) = plan.scenario(point, entry, 0) {
                problems.extend(found);
            }
        }
        problems.extend(too_many_games(plan.games(), &sweep.path));
        problems.sort();
        problems.dedup();
        if problems.is_empty() {
            Ok(plan)
        } else {
            Err(Problems(problems))
        }
    }

    /// A plan with unchecked points, read from these files.
    fn unchecked(sweep: &Sweep, files: Arc<Files>) -> Result<Plan, Problems> {
        let teams = teams_of(&sweep.game, &files)?;
        let points = points(sweep)?;
        Ok(Plan {
            sweep: sweep.clone(),
            teams,
            seeds: u64::from(sweep.games).div_ceil(2),
            points,
            files,
        })
    }

    /// The sweep.
    pub fn sweep(&self) -> &Sweep {
        &self.sweep
    }

    /// The names of the game's teams.
    pub fn teams(&self) -> &[String] {
        &self.teams
    }

    /// The points.
    pub fn points(&self) -> &[Point] {
        &self.points
    }

    /// The number of seeds at each point.
    pub fn seeds(&self) -> u64 {
        self.seeds
    }

    /// The number of games at each point.
    pub fn games_per_point(&self) -> usize {
        usize::try_from(self.seeds).map_or(usize::MAX, |seeds| {
            seeds.saturating_mul(2 * self.sweep.entries.len())
        })
    }

    /// The total number of games.
    pub fn games(&self) -> usize {
        self.games_per_point().saturating_mul(self.points.len())
    }

    /// The game at `index`, ordered by point, then seed, then entry, then side.
    ///
    /// # Panics
    /// If `index` is out of range.
    pub fn job(&self, index: usize) -> Job {
        assert!(index < self.games(), "game {index} of {}", self.games());
        let point = index / self.games_per_point();
        let within = index % self.games_per_point();
        let entries = self.sweep.entries.len();
        let seed = self
            .sweep
            .seed
            .wrapping_add((within / (2 * entries)) as u64);
        Job {
            index,
            point,
            entry: within / 2 % entries,
            seed,
            side: within % 2,
        }
    }

    /// The scenario of an entry on a side at a point.
    ///
    /// # Errors
    /// All problems in any file.
    pub fn scenario(&self, point: usize, entry: usize, side: usize) -> Result<Scenario, Problems> {
        load_game(
            &self.sweep.game,
            &self.overrides(point, entry, side),
            &self.files,
            &self.sweep.path,
        )
    }

    fn overrides(&self, point: usize, entry: usize, side: usize) -> Overrides {
        self.sweep
            .overrides(&self.teams, entry, side, &self.points[point])
    }

    /// The command that replays a game.
    pub fn command(&self, job: &Job) -> String {
        let Overrides {
            strategies,
            settings,
            ..
        } = self.overrides(job.point, job.entry, job.side);
        let mut command = format!("squall run {}", argument_for(&self.sweep.game));
        for (team, file) in &strategies {
            command += &strategy_option(team, &argument_for(file));
        }
        for setting in settings {
            let option = setting
                .key
                .strip_prefix("game.")
                .filter(|key| ["sea", "field"].contains(key));
            command += &match option.zip(file_of(&setting)) {
                Some((option, file)) => format!(" --{option} {}", argument_for(&file)),
                None => format!(" {}", beside_here(&setting).argument()),
            };
        }
        format!("{command} --seed {}", job.seed)
    }

    /// Identifies the plan: a study is resumed only with the same digest. It depends on the
    /// contents of files, not on their location: moved files with the same references to each other
    /// give the same digest.
    pub fn digest(&self) -> String {
        let nowhere = PathBuf::new;
        let entry = |entry: &Entrant| Entrant {
            strategy: nowhere(),
            ..entry.clone()
        };
        let axis = |axis: &Axis| Axis {
            place: (1, 1),
            ..axis.clone()
        };
        let Sweep { entries, axes, .. } = &self.sweep;
        let sweep = Sweep {
            path: nowhere(),
            game: nowhere(),
            opponent: nowhere(),
            entries: entries.iter().map(entry).collect(),
            axes: axes.iter().map(axis).collect(),
            ..self.sweep.clone()
        };
        digest_of(&format!("{sweep:?}"), &self.files.list())
    }

    /// The plan with all required files, for a process on another machine.
    pub fn pack(&self) -> Packed {
        Packed::new(&self.sweep, self.files.list(), self.digest())
    }

    /// A plan packed elsewhere. Its points are not checked again.
    ///
    /// # Errors
    /// [`UnpackError`] if it is damaged or was packed by a different version of Squall.
    pub fn unpack(packed: Packed) -> Result<Plan, UnpackError> {
        packed.unpack(Plan::unchecked, Plan::digest)
    }
}

/// The file that a setting names, if any.
fn file_of(setting: &Setting) -> Option<PathBuf> {
    let named: Option<String> = serde_json::from_str(&setting.value).ok();
    Some(
        setting
            .path
            .parent()?
            .join(named.filter(|named| named.ends_with(".toml"))?),
    )
}

/// A setting with the full path of the file that it names.
fn beside_here(setting: &Setting) -> Setting {
    let whole = file_of(setting).and_then(|path| std::path::absolute(path).ok());
    let value = whole.map(|path| serde_json::Value::from(path.display().to_string()).to_string());
    Setting {
        value: value.unwrap_or_else(|| setting.value.clone()),
        ..setting.clone()
    }
}

fn points(sweep: &Sweep) -> Result<Vec<Point>, Problems> {
    let axes = &sweep.axes;
    let count = sweep.points as usize;
    let sampled = |share: &dyn Fn(usize, usize) -> f64| {
        let point = |i: usize| {
            axes.iter()
                .enumerate()
                .map(|(k, axis)| axis.at(share(i, k)))
                .collect()
        };
        (0..count).map(point).collect()
    };
    Ok(match sweep.design {
        Design::Grid => grid(sweep)?,
        Design::OneAtATime => one_at_a_time(axes),
        Design::LatinHypercube => {
            let columns: Vec<Vec<f64>> = axes
                .iter()
                .map(|axis| latin_column(sweep.seed, &axis.key, count))
                .collect();
            sampled(&|i, k| columns[k][i])
        }
        Design::Sobol => {
            // The generator takes a 32-bit seed, and a sequence has at most 65536 points.
            let seed = (sweep.seed ^ (sweep.seed >> 32)) as u32;
            sampled(&|i, k| {
                f64::from(sobol_burley::sample(
                    i as u32,
                    k as u32 % SOBOL_DIMENSIONS,
                    seed,
                ))
            })
        }
    })
}

/// A column of a Latin hypercube: one number in each of `count` equal intervals from 0 to 1, in
/// random order.
fn latin_column(seed: u64, key: &str, count: usize) -> Vec<f64> {
    let mut stream = Stream::new(seed, &format!("sweep/{key}"));
    let mut pieces: Vec<usize> = (0..count).collect();
    stream.shuffle(&mut pieces);
    pieces
        .into_iter()
        .map(|piece| (piece as f64 + stream.unit()) / count as f64)
        .collect()
}

fn grid(sweep: &Sweep) -> Result<Vec<Point>, Problems> {
    let levels: Vec<Vec<AxisValue>> = sweep.axes.iter().map(Axis::levels).collect();
    let count = levels
        .iter()
        .try_fold(1_usize, |count, levels| count.checked_mul(levels.len()));
    if count.is_none_or(|count| count > POINTS_MAX) {
        let message = format!(
            "the grid has more than {POINTS_MAX} points; use fewer levels or another design"
        );
        return Err(Problems(vec![Problem::of_file(
            sweep.path.clone(),
            message,
        )]));
    }
    let mut points: Vec<Point> = vec![vec![]];
    for levels in &levels {
        let with =
            |point: &Point, level: &AxisValue| [&point[..], std::slice::from_ref(level)].concat();
        points = points
            .iter()
            .flat_map(|point| levels.iter().map(move |level| with(point, level)))
            .collect();
    }
    Ok(points)
}

fn one_at_a_time(axes: &[Axis]) -> Vec<Point> {
    let nominal: Point = axes.iter().map(Axis::nominal).collect();
    let mut points = vec![nominal.clone()];
    let mut known = BTreeSet::from([format!("{nominal:?}")]);
    for (i, axis) in axes.iter().enumerate() {
        for level in axis.levels() {
            let mut values = nominal.clone();
            values[i] = level;
            if known.insert(format!("{values:?}")) {
                points.push(values);
            }
        }
    }
    points
}
