//! A sweep in a folder: the tables of its games as they are played, and the report.
//!
//! `games.csv` is written a line a game, in order, and is all that a study is taken up again from; `boats.csv` has a line for each boat
//! of each game. What was torn off when the machine stopped is dropped.

use crate::metric::METRICS;
use crate::plan::Plan;
use crate::play::Played;
use crate::report::Report;
use crate::{html, parquet_file};
use std::fs::{File, OpenOptions};
use std::io::Write;
use std::path::{Path, PathBuf};
use thiserror::Error;

/// The table of games.
pub const GAMES: &str = "games.csv";
/// The table of boats.
const BOATS: &str = "boats.csv";
/// What identifies the plan.
const PLAN: &str = "plan.txt";
/// The plan with all that its games need, so that any of them can be played again.
pub const PACKED_PLAN: &str = "plan.json";
/// The columns of the table of games before those of the axes.
const FIRST: [&str; 6] = ["game", "point", "entry", "seed", "side", "boats"];
/// Its last columns.
const LAST: [&str; 2] = ["digest", "error"];
/// The columns of the table of boats.
const BOAT_COLUMNS: [&str; 17] = [
    "game",
    "boat",
    "team",
    "is_entrys",
    "grabs",
    "captures",
    "tags",
    "tagged",
    "out_of_bounds",
    "collisions",
    "tagged_s",
    "outside_s",
    "carrying_s",
    "distance_m",
    "speed_mean_m_s",
    "speed_max_m_s",
    "energy_kj",
];

/// A sweep that is kept in a folder.
pub struct Study {
    folder: PathBuf,
    games: File,
    boats: File,
    done: usize,
}

/// A line of the table of games.
#[derive(Clone, Debug, PartialEq)]
pub struct Row {
    /// The game's place in the order of the sweep.
    pub index: usize,
    /// Digest of its final state and of all events; empty if it could not start.
    pub digest: String,
    /// By metric, NaN where there is none; or why it could not start.
    pub result: Result<Vec<f64>, String>,
}

/// Why a study cannot be kept.
#[derive(Debug, Error)]
pub enum StudyError {
    /// A file cannot be read or written.
    #[error("cannot {doing} {}: {error}", path.display())]
    Io {
        /// What was tried.
        doing: &'static str,
        /// With which file.
        path: PathBuf,
        /// Why not.
        error: std::io::Error,
    },
    /// There is one already.
    #[error("{} holds a sweep of {games} games already; --resume goes on with it, or --out names another folder", folder.display())]
    Exists {
        /// The folder.
        folder: PathBuf,
        /// How many games were played.
        games: usize,
    },
    /// There is none.
    #[error("{} holds no sweep to go on with", folder.display())]
    Missing {
        /// The folder.
        folder: PathBuf,
    },
    /// It is of another sweep.
    #[error(
        "{} holds another sweep than this: its files, its seed, its games or Squall's version have changed; \
         expected {expected}, found {found}",
        folder.display()
    )]
    Other {
        /// The folder.
        folder: PathBuf,
        /// The digest of this plan.
        expected: String,
        /// That of the one in the folder.
        found: String,
    },
    /// A table cannot be made.
    #[error("cannot make {what}: {why}")]
    Table {
        /// Which.
        what: &'static str,
        /// Why not.
        why: String,
    },
}

impl Study {
    /// A new study in a folder, which is made.
    ///
    /// # Errors
    /// [`StudyError`]: a file cannot be written, or there is a study already.
    pub fn begin(folder: &Path, plan: &Plan) -> Result<Study, StudyError> {
        std::fs::create_dir_all(folder).map_err(io("make the folder", folder))?;
        let games = rows_in(plan, &text(&folder.join(GAMES)).unwrap_or_default()).len();
        if games > 0 {
            return Err(StudyError::Exists { folder: folder.to_owned(), games });
        }
        write(&folder.join(PLAN), &(plan.digest() + "\n"))?;
        let packed = serde_json::to_string(&plan.pack());
        let packed = packed.map_err(|error| StudyError::Table { what: PACKED_PLAN, why: error.to_string() })?;
        write(&folder.join(PACKED_PLAN), &(packed + "\n"))?;
        write(&folder.join(GAMES), &record(&columns(plan)))?;
        write(&folder.join(BOATS), &record(&BOAT_COLUMNS.map(str::to_owned)))?;
        Study::open(folder, 0)
    }

    /// A study that is taken up again: its last line is dropped if it was cut off.
    ///
    /// # Errors
    /// [`StudyError`]: a file cannot be read or written, or the folder holds none, or one of another plan.
    pub fn resume(folder: &Path, plan: &Plan) -> Result<Study, StudyError> {
        let Ok(found) = text(&folder.join(PLAN)) else {
            return Err(StudyError::Missing { folder: folder.to_owned() });
        };
        let (found, expected) = (found.trim().to_owned(), plan.digest());
        if found != expected {
            return Err(StudyError::Other { folder: folder.to_owned(), expected, found });
        }
        let [games, boats] = [GAMES, BOATS].map(|name| folder.join(name));
        let (games_text, boats_text) = (text(&games)?, text(&boats)?);
        let (done, lengths) = whole(plan, &games_text, &boats_text);
        for (path, text, length) in [(&games, &games_text, lengths[0]), (&boats, &boats_text, lengths[1])] {
            if length < text.len() {
                let file = OpenOptions::new().write(true).open(path).map_err(io("open", path))?;
                file.set_len(length as u64).map_err(io("cut", path))?;
            }
        }
        Study::open(folder, done)
    }

    fn open(folder: &Path, done: usize) -> Result<Study, StudyError> {
        let open = |name: &str| {
            let path = folder.join(name);
            OpenOptions::new().append(true).open(&path).map_err(io("open", &path))
        };
        Ok(Study { folder: folder.to_owned(), games: open(GAMES)?, boats: open(BOATS)?, done })
    }

    /// How many games it has: the next one's place.
    #[must_use]
    pub fn done(&self) -> usize {
        self.done
    }

    /// The folder.
    #[must_use]
    pub fn folder(&self) -> &Path {
        &self.folder
    }

    /// Adds the next game.
    ///
    /// # Errors
    /// [`StudyError`]: a file cannot be written; what is in it so far is whole.
    ///
    /// # Panics
    /// If it is not the next one.
    pub fn add(&mut self, plan: &Plan, played: &Played) -> Result<(), StudyError> {
        let (games, boats) = lines(plan, played);
        self.add_lines(played.job.index, &games, &boats)
    }

    /// Adds the lines of the next game, as [`lines`] makes them.
    ///
    /// # Errors
    /// [`StudyError`]: a file cannot be written; what is in it so far is whole.
    ///
    /// # Panics
    /// If it is not the next one.
    pub fn add_lines(&mut self, index: usize, game: &str, boats: &str) -> Result<(), StudyError> {
        assert_eq!(index, self.done, "games come in order");
        // The game's line says that its boats' are there.
        let folder = &self.folder;
        self.boats.write_all(boats.as_bytes()).map_err(io("write", &folder.join(BOATS)))?;
        self.games.write_all(game.as_bytes()).map_err(io("write", &folder.join(GAMES)))?;
        self.done += 1;
        Ok(())
    }

    /// Writes the report of all games so far: `report.json`, `report.html` and `games.parquet`.
    ///
    /// # Errors
    /// [`StudyError`]: a file cannot be read or written.
    pub fn report(&self, plan: &Plan) -> Result<Report, StudyError> {
        let rows = rows_in(plan, &text(&self.folder.join(GAMES))?);
        let report = Report::new(plan, &rows);
        let json = serde_json::to_string_pretty(&report);
        let json = json.map_err(|error| StudyError::Table { what: "report.json", why: error.to_string() })? + "\n";
        write(&self.folder.join("report.html"), &html::page(&report.sweep, &json))?;
        write(&self.folder.join("report.json"), &json)?;
        let path = self.folder.join("games.parquet");
        let table = parquet_file::bytes(plan, &rows);
        let table = table.map_err(|error| StudyError::Table { what: "games.parquet", why: error.to_string() })?;
        std::fs::write(&path, table).map_err(io("write", &path))?;
        Ok(report)
    }
}

/// The line of a game in the table of games, and those of its boats.
#[must_use]
pub fn lines(plan: &Plan, played: &Played) -> (String, String) {
    let job = &played.job;
    let mut cells = vec![
        job.index.to_string(),
        job.point.to_string(),
        plan.sweep().entries[job.entry].name.clone(),
        job.seed.to_string(),
        plan.teams()[job.side].clone(),
        played.boats.len().to_string(),
    ];
    cells.extend(plan.points()[job.point].values.iter().map(ToString::to_string));
    match &played.result {
        Ok(numbers) => cells.extend(numbers.iter().map(|number| cell(*number))),
        Err(_) => cells.extend(METRICS.map(|_| String::new())),
    }
    let why = played.result.as_ref().err().cloned().unwrap_or_default();
    // A line is a game.
    cells.extend([played.digest.clone(), why.split_whitespace().collect::<Vec<_>>().join(" ")]);
    let boat = |boat: &crate::play::BoatRow| {
        let (of, counts) = (&boat.statistics, &boat.statistics.counts);
        let counts =
            [counts.grabs, counts.captures, counts.tags, counts.tagged, counts.out_of_bounds, counts.collisions];
        let mut cells =
            vec![job.index.to_string(), of.boat.clone(), of.team.clone(), u8::from(boat.is_own).to_string()];
        cells.extend(counts.map(|count| count.to_string()));
        let numbers = [of.tagged_s, of.outside_s, of.carrying_s, of.distance_m, of.speed_mean_m_s, of.speed_max_m_s];
        cells.extend(numbers.into_iter().chain([boat.energy_kj]).map(cell));
        record(&cells)
    };
    (record(&cells), played.boats.iter().map(boat).collect())
}

/// A number that is read again to the bit; nothing where there is none.
pub(crate) fn cell(number: f64) -> String {
    if number.is_finite() { number.to_string() } else { String::new() }
}

/// The number that [`cell`] wrote.
pub(crate) fn number_of(cell: &str) -> Option<f64> {
    if cell.is_empty() { Some(f64::NAN) } else { cell.parse().ok() }
}

/// A line of a table.
pub(crate) fn record(cells: &[String]) -> String {
    let mut writer = csv::WriterBuilder::new().from_writer(vec![]);
    writer.write_record(cells).expect("memory takes it");
    String::from_utf8(writer.into_inner().expect("memory takes it")).expect("cells are text")
}

fn columns(plan: &Plan) -> Vec<String> {
    let axes = plan.sweep().axes.iter().map(|axis| axis.key.clone());
    let names = |names: &[&str]| names.iter().map(|name| (*name).to_owned()).collect::<Vec<_>>();
    let metrics = METRICS.iter().map(|metric| metric.name.to_owned());
    names(&FIRST).into_iter().chain(axes).chain(metrics).chain(names(&LAST)).collect()
}

/// The games whose lines are whole, from the first on, each with where its line ends and how many boats it has.
fn parsed<'a>(plan: &'a Plan, text: &'a str) -> impl Iterator<Item = (Row, usize, usize)> + 'a {
    let whole = text.rsplit_once('\n').map_or("", |(whole, _)| whole);
    let text = &text[..(whole.len() + 1).min(text.len())];
    let metrics_from = FIRST.len() + plan.sweep().axes.len();
    let mut reader = csv::ReaderBuilder::new().flexible(true).from_reader(text.as_bytes());
    let mut record = csv::StringRecord::new();
    let mut index = 0;
    std::iter::from_fn(move || {
        let is_there = reader.read_record(&mut record).ok()?;
        if !is_there || record.len() != metrics_from + METRICS.len() + LAST.len() || record[0].parse() != Ok(index) {
            return None;
        }
        let numbers: Option<Vec<f64>> = (0..METRICS.len()).map(|m| number_of(&record[metrics_from + m])).collect();
        let [digest, why] = [0, 1].map(|i| record[metrics_from + METRICS.len() + i].to_owned());
        let result = if why.is_empty() { Ok(numbers?) } else { Err(why) };
        let boats: usize = record[5].parse().ok()?;
        index += 1;
        Some((Row { index: index - 1, digest, result }, reader.position().byte() as usize, boats))
    })
}

/// The games of a table, whose text is that of `games.csv`, from the first on as far as its lines are whole and of this plan.
#[must_use]
pub fn rows_in(plan: &Plan, text: &str) -> Vec<Row> {
    parsed(plan, text).map(|(row, ..)| row).take(plan.games()).collect()
}

/// How many games are whole in both tables, and how long these are then.
fn whole(plan: &Plan, games: &str, boats: &str) -> (usize, [usize; 2]) {
    let head = |text: &str| text.find('\n').map_or(text.len(), |at| at + 1);
    let (mut done, mut lengths) = (0, [head(games), head(boats)]);
    for (row, end, count) in parsed(plan, games).take(plan.games()) {
        let mut boats_end = lengths[1];
        for _ in 0..count {
            let rest = &boats[boats_end..];
            let Some(length) = rest.find('\n') else { return (done, lengths) };
            if rest.split(',').next().and_then(|game| game.parse().ok()) != Some(row.index) {
                return (done, lengths);
            }
            boats_end += length + 1;
        }
        (done, lengths) = (row.index + 1, [end, boats_end]);
    }
    (done, lengths)
}

fn text(path: &Path) -> Result<String, StudyError> {
    let bytes = std::fs::read(path).map_err(io("read", path))?;
    Ok(String::from_utf8_lossy(&bytes).into_owned())
}

fn write(path: &Path, text: &str) -> Result<(), StudyError> {
    std::fs::write(path, text).map_err(io("write", path))
}

pub(crate) fn io(doing: &'static str, path: &Path) -> impl FnOnce(std::io::Error) -> StudyError {
    let path = path.to_owned();
    move |error| StudyError::Io { doing, path, error }
}
