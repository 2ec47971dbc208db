//! A sweep in a folder: the tables of its games as they are played, and the report.
//!
//! `games.csv` gets one line per game, in order; `boats.csv` has a line for each boat of each game;
//! `sums.txt` has a checksum of each game's lines in both. A study resumes after the last game
//! whose lines are complete and match their checksums. Lines truncated when the machine stopped, or
//! changed since, are replaced by playing their games again.

use super::plan::Plan;
use super::play::{BoatRow, Played};
use super::report::Report;
use super::table::{self, Row};
use crate::checksum::checksum;
use primitives::input_file::TABLE_BYTES_MAX;
use primitives::{input_file, output_file};
use std::fs::{File, OpenOptions};
use std::io::Write;
use std::path::{Path, PathBuf};
use thiserror::Error;

/// The table of games.
pub const GAMES: &str = "games.csv";
/// The table of boats.
const BOATS: &str = "boats.csv";
/// The checksums of the games' lines.
const SUMS: &str = "sums.txt";
/// A checksum has 16 hexadecimal digits and a newline.
const SUM_BYTES: usize = 17;
/// The file with the plan's digest.
const PLAN: &str = "plan.txt";
/// The file with the plan and all required files, so that any game can be replayed.
pub const PACKED_PLAN: &str = "plan.json";
/// The first line of the table of boats.
const BOATS_HEAD: &str = "game,boat,team,is_entrys,grabs,captures,tags,tagged,out_of_bounds,collisions,\
    tagged_s,outside_s,carrying_s,distance_m,speed_mean_m_s,speed_max_m_s,energy_kj\n";

/// A sweep stored in a folder.
pub struct Study {
    folder: PathBuf,
    games: File,
    boats: File,
    sums: File,
    done: usize,
}

/// Why a study failed.
#[derive(Debug, Error)]
pub enum StudyError {
    /// A file cannot be read or written.
    #[error("cannot {doing} {}: {error}", path.display())]
    Io {
        /// The failed action.
        doing: &'static str,
        /// The file.
        path: PathBuf,
        /// The system's error.
        error: std::io::Error,
    },
    /// The folder already contains a study.
    #[error("{} already contains a sweep of {games} games; continue it with --resume, or choose another folder with --out", folder.display())]
    Exists {
        /// The folder.
        folder: PathBuf,
        /// The number of games in it.
        games: usize,
    },
    /// The folder contains no study.
    #[error("{} contains no sweep to resume", folder.display())]
    Missing {
        /// The folder.
        folder: PathBuf,
    },
    /// The study belongs to a different sweep.
    #[error(
        "{} contains a different sweep: the files, the seed, the number of games or Squall's version have \
         changed; expected digest {expected}, found {found}",
        folder.display()
    )]
    Other {
        /// The folder.
        folder: PathBuf,
        /// The digest of this plan.
        expected: String,
        /// The digest of the plan in the folder.
        found: String,
    },
    /// A table cannot be created.
    #[error("cannot create {what}: {why}")]
    Table {
        /// The name of the table.
        what: &'static str,
        /// The cause.
        why: String,
    },
}

impl Study {
    /// A new study in a folder, which is created.
    ///
    /// # Errors
    /// [`StudyError`] if a file cannot be written or the folder already contains a study.
    pub fn begin(folder: &Path, plan: &Plan) -> Result<Study, StudyError> {
        std::fs::create_dir_all(folder).map_err(io("create the folder", folder))?;
        let games = rows_in(plan, &text_if_any(&folder.join(GAMES))?).len();
        if games > 0 {
            return Err(StudyError::Exists {
                folder: folder.to_owned(),
                games,
            });
        }
        write_plan(folder, plan)?;
        for (name, head) in heads(plan) {
            write(&folder.join(name), &head)?;
        }
        // Write it last: a folder without it contains no study, whatever parts of the other files a
        // full disk has left.
        write(&folder.join(PLAN), &(plan.digest() + "\n"))?;
        Study::open(folder, 0)
    }

    /// Resumes a study from the first game without complete lines.
    ///
    /// # Errors
    /// [`StudyError`] if a file cannot be read or written, or if the folder contains no study or a
    /// study of a different plan.
    pub fn resume(folder: &Path, plan: &Plan) -> Result<Study, StudyError> {
        let found = text_if_any(&folder.join(PLAN))?.trim().to_owned();
        if found.is_empty() {
            return Err(StudyError::Missing {
                folder: folder.to_owned(),
            });
        }
        let expected = plan.digest();
        if found != expected {
            return Err(StudyError::Other {
                folder: folder.to_owned(),
                expected,
                found,
            });
        }
        write_plan(folder, plan)?;
        let text = |name: &str| text_if_any(&folder.join(name));
        let texts = [text(GAMES)?, text(BOATS)?, text(SUMS)?];
        let (done, lengths) = whole(plan, &texts);
        for (((name, head), text), length) in heads(plan).into_iter().zip(&texts).zip(lengths) {
            let path = folder.join(name);
            if length == 0 {
                write(&path, &head)?;
            } else if length < text.len() {
                let file = OpenOptions::new()
                    .write(true)
                    .open(&path)
                    .map_err(io("open", &path))?;
                file.set_len(length as u64).map_err(io("cut", &path))?;
            }
        }
        Study::open(folder, done)
    }

    fn open(folder: &Path, done: usize) -> Result<Study, StudyError> {
        let open = |name: &str| {
            let path = folder.join(name);
            OpenOptions::new()
                .append(true)
                .open(&path)
                .map_err(io("open", &path))
        };
        Ok(Study {
            folder: folder.to_owned(),
            games: open(GAMES)?,
            boats: open(BOATS)?,
            sums: open(SUMS)?,
            done,
        })
    }

    /// The number of games in the study, which is the index of the next one.
    pub fn done(&self) -> usize {
        self.done
    }

    /// Adds the next game.
    ///
    /// # Errors
    /// [`StudyError`] if a file cannot be written; its previous content remains intact.
    ///
    /// # Panics
    /// If it is not the next one.
    pub fn add(&mut self, plan: &Plan, played: &Played) -> Result<(), StudyError> {
        let (games, boats) = lines(plan, played);
        self.add_lines(played.row.job.index, &games, &boats)
    }

    /// Adds the lines of the next game, as created by [`lines`].
    ///
    /// # Errors
    /// [`StudyError`] if a file cannot be written; its previous content remains intact.
    ///
    /// # Panics
    /// If it is not the next one.
    pub fn add_lines(&mut self, index: usize, game: &str, boats: &str) -> Result<(), StudyError> {
        assert_eq!(index, self.done, "games come in order");
        // Write the checksum last, to confirm the other lines.
        let folder = &self.folder;
        let sum = sum_line(game, boats);
        self.boats
            .write_all(boats.as_bytes())
            .map_err(io("write", &folder.join(BOATS)))?;
        self.games
            .write_all(game.as_bytes())
            .map_err(io("write", &folder.join(GAMES)))?;
        self.sums
            .write_all(sum.as_bytes())
            .map_err(io("write", &folder.join(SUMS)))?;
        self.done += 1;
        Ok(())
    }

    /// Writes the report on all games so far: `report.json` and `games.parquet`.
    ///
    /// # Errors
    /// [`StudyError`] if a file cannot be read or written.
    pub fn report(&self, plan: &Plan) -> Result<Report, StudyError> {
        let rows = rows_in(plan, &text(&self.folder.join(GAMES))?);
        let report = Report::new(plan, &rows);
        let json = serde_json::to_string_pretty(&report);
        let json = json.map_err(|error| StudyError::Table {
            what: "report.json",
            why: error.to_string(),
        })? + "\n";
        write(&self.folder.join("report.json"), &json)?;
        let path = self.folder.join("games.parquet");
        let table = table::parquet(plan, &rows);
        let table = table.map_err(|error| StudyError::Table {
            what: "games.parquet",
            why: error.to_string(),
        })?;
        output_file::write(&path, table).map_err(io("write", &path))?;
        Ok(report)
    }
}

/// The line of a game in the table of games, and the lines of its boats.
pub fn lines(plan: &Plan, played: &Played) -> (String, String) {
    let index = played.row.job.index;
    let boat = |boat: &BoatRow| {
        let of = &boat.statistics;
        let counts = &boat.statistics.counts;
        let counts = [
            counts.grabs,
            counts.captures,
            counts.tags,
            counts.tagged,
            counts.out_of_bounds,
            counts.collisions,
        ];
        let mut cells = vec![
            index.to_string(),
            of.boat.clone(),
            of.team.clone(),
            u8::from(boat.is_own).to_string(),
        ];
        cells.extend(counts.map(|count| count.to_string()));
        let numbers = [
            of.tagged_s,
            of.outside_s,
            of.carrying_s,
            of.distance_m,
            of.speed_mean_m_s,
            of.speed_max_m_s,
        ];
        cells.extend(
            numbers
                .into_iter()
                .chain([boat.energy_kj])
                .map(table::cell_of),
        );
        table::record(cells)
    };
    (
        table::csv_line(plan, &played.row),
        played.boats.iter().map(boat).collect(),
    )
}

/// The games in `text`, in the format of `games.csv`, up to the first line that is incomplete or
/// belongs to a different plan.
pub fn rows_in(plan: &Plan, text: &str) -> Vec<Row> {
    table::csv_rows(plan, text).map(|(row, _)| row).collect()
}

/// The header lines of the tables.
fn heads(plan: &Plan) -> [(&'static str, String); 3] {
    [
        (GAMES, table::csv_head(plan)),
        (BOATS, BOATS_HEAD.to_owned()),
        (SUMS, String::new()),
    ]
}

/// The checksum line of a game.
fn sum_line(game: &str, boats: &str) -> String {
    checksum(&[game, boats].concat()) + "\n"
}

/// The number of games that are complete in both tables and match their checksums, and the lengths
/// of the three files up to that point; the lengths are zero if the headers are wrong.
fn whole(plan: &Plan, [games, boats, sums]: &[String; 3]) -> (usize, [usize; 3]) {
    let [(_, games_head), (_, boats_head), _] = heads(plan);
    if !games.starts_with(&games_head) || !boats.starts_with(&boats_head) {
        return (0, [0; 3]);
    }
    let mut done = 0;
    let mut lengths = [games_head.len(), boats_head.len(), 0];
    for (row, games_end) in table::csv_rows(plan, games) {
        let rest = &boats[lengths[1]..];
        let boats_end = lengths[1]
            + rest
                .split_inclusive('\n')
                .take(row.boats)
                .map(str::len)
                .sum::<usize>();
        let sum = sums.get(lengths[2]..lengths[2] + SUM_BYTES);
        if sum
            != Some(&sum_line(
                &games[lengths[0]..games_end],
                &boats[lengths[1]..boats_end],
            ))
        {
            break;
        }
        (done, lengths) = (
            row.job.index + 1,
            [games_end, boats_end, lengths[2] + SUM_BYTES],
        );
    }
    (done, lengths)
}

/// Writes the plan with all required files.
fn write_plan(folder: &Path, plan: &Plan) -> Result<(), StudyError> {
    let packed = serde_json::to_string(&plan.pack());
    let packed = packed.map_err(|error| StudyError::Table {
        what: PACKED_PLAN,
        why: error.to_string(),
    })?;
    write(&folder.join(PACKED_PLAN), &(packed + "\n"))
}

/// The content of a file; empty if the file does not exist.
// Anything else at the path is an error: writing to a named pipe would wait for a reader.
fn text_if_any(path: &Path) -> Result<String, StudyError> {
    match text(path) {
        Err(StudyError::Io { error, .. }) if error.kind() == std::io::ErrorKind::NotFound => {
            Ok(String::new())
        }
        other => other,
    }
}

fn text(path: &Path) -> Result<String, StudyError> {
    let bytes = input_file::read(path, TABLE_BYTES_MAX).map_err(io("read", path))?;
    Ok(String::from_utf8_lossy(&bytes).into_owned())
}

fn write(path: &Path, text: &str) -> Result<(), StudyError> {
    output_file::write(path, text).map_err(io("write", path))
}

fn io(doing: &'static str, path: &Path) -> impl FnOnce(std::io::Error) -> StudyError {
    let path = path.to_owned();
    move |error| StudyError::Io { doing, path, error }
}
