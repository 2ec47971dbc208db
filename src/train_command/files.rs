//! The files that a training run writes to its folder.

use crate::{clock, output_file};
use anyhow::{Context, Result};
use learn::environment::{Finished, recording_name};
use learn::train::{Progress, Trainer};
use primitives::input_file::{self, TABLE_BYTES_MAX};
use primitives::printable;
use scenario::{argument_for, built_in, tidied_path};
use serde_json::json;
use std::fmt::Write as _;
use std::fs::File;
use std::io::Write as _;
use std::path::{Path, PathBuf};
use std::time::Instant;
use xxhash_rust::xxh3::Xxh3;

/// The header of the table of updates.
const UPDATES: &str = "samples,stage,reward,policy_loss,value_loss,entropy,divergence,clipped,epochs,explained_variance\n";
/// The header of the table of evaluations.
const EVALUATIONS: &str =
    "samples,stage,opponent,won,drawn,lost,points,points_against,left_field,best\n";
/// The header of the table of episodes.
const EPISODES: &str =
    "samples,stage,seed,team,opponent,points,points_against,steps,cut_off,recording\n";

/// The length and checksum of each table at every saved state: `samples,table,bytes,checksum`.
const SUMS: &str = "sums.csv";
/// The wall-clock time spent by each update, over all parts of a resumed run.
const TIMES: &str = "times.csv";
/// The data about a training run, besides its tables, that the page shows.
const RUN: &str = "run.json";
/// The subfolder of recordings.
const GAMES: &str = "games";

/// The folder of a training run.
pub(super) struct Files {
    folder: PathBuf,
    tables: [Table; 3],
    /// The table of times, locked while the training runs.
    times: File,
    begun: Instant,
    /// Time spent before this process, s.
    before_s: f64,
    /// The strategy whose helm uses the policy, if there is one.
    base: Option<PathBuf>,
}

/// The length and checksum of a table to which lines are appended.
struct Table {
    name: &'static str,
    bytes: usize,
    // Updated with each line: rereading a table at every saved state would take ever longer.
    sum: Xxh3,
}

impl Table {
    fn of(name: &'static str, text: &str) -> Table {
        let mut table = Table {
            name,
            bytes: 0,
            sum: Xxh3::new(),
        };
        table.note(text);
        table
    }

    /// Accounts for characters appended to the file.
    fn note(&mut self, text: &str) {
        self.bytes += text.len();
        self.sum.update(text.as_bytes());
    }

    fn checksum(&self) -> String {
        format!("{:016x}", self.sum.digest())
    }
}

impl Files {
    /// Opens the folder of a training run; if resuming, drops everything written after the saved
    /// state.
    pub(super) fn open(folder: &Path, base: &Path, trainer: &Trainer) -> Result<Files> {
        let (samples, _) = trainer.samples();
        let tables = [
            ("updates.csv", UPDATES),
            ("evaluations.csv", EVALUATIONS),
            ("episodes.csv", EPISODES),
        ];
        output_file::make_folder(folder)?;
        let mut texts = tables.map(|(name, head)| (name, head.to_owned()));
        let mut sums = String::new();
        if samples > 0 {
            let path = folder.join(SUMS);
            let text = read(&path)?;
            // The last line may be truncated.
            let is_kept = |line: &&str| {
                line.ends_with('\n') && first_number(line).is_some_and(|at| at <= samples)
            };
            sums.extend(text.split_inclusive('\n').filter(is_kept));
            for ((name, table), (_, head)) in texts.iter_mut().zip(tables) {
                *table = read(&folder.join(*name))?;
                let begins = format!("{samples},{name},");
                let noted = sums
                    .lines()
                    .find_map(|line| line.strip_prefix(&begins)?.split_once(','));
                let (bytes, sum) = noted.with_context(|| {
                    format!(
                        "{} has no entry for {name} at {samples} samples",
                        path.display()
                    )
                })?;
                let kept = bytes
                    .parse()
                    .ok()
                    .and_then(|bytes: usize| table.get(..bytes))
                    .map(str::to_owned);
                // An earlier version wrote different columns.
                *table = kept
                    .filter(|kept| kept.starts_with(head) && Table::of(name, kept).checksum() == sum)
                    .with_context(|| {
                        let path = folder.join(*name);
                        format!(
                            "{} was changed or truncated after it was written; start afresh with --out",
                            path.display()
                        )
                    })?;
            }
        }
        output_file::write(&folder.join(SUMS), "the training", sums)?;
        for (name, text) in &texts {
            output_file::write(&folder.join(name), "the training", text)?;
        }
        let tables = texts.map(|(name, text)| Table::of(name, &text));
        let (times, before_s) = open_times(&folder.join(TIMES), samples)?;
        let stage = trainer.training().stage.last();
        let sea = stage
            .and_then(|stage| stage.sea.as_deref())
            .map(argument_for);
        let game = stage.map(|stage| argument_for(&stage.game));
        let seed = trainer.training().seed.to_string();
        let run = json!({"samples": trainer.samples().1, "seed": seed, "game": game, "sea": sea});
        output_file::write_json(&folder.join(RUN), "the training", &run)?;
        Ok(Files {
            folder: folder.to_owned(),
            tables,
            times,
            begun: clock::now(),
            before_s,
            base: base_for(base),
        })
    }

    /// The file from which a training run resumes.
    pub(super) fn state(folder: &Path) -> PathBuf {
        folder.join("state.bin")
    }

    /// The folder of recordings.
    pub(super) fn games(folder: &Path) -> PathBuf {
        folder.join(GAMES)
    }

    /// The path of an episode's recording relative to the folder; empty if there is none.
    fn recording(&self, one: &Finished) -> String {
        let path = format!("{GAMES}/{}", recording_name(one.standing.seed, one.number));
        if self.folder.join(&path).exists() {
            path
        } else {
            String::new()
        }
    }

    /// Adds an update to its table.
    pub(super) fn update(&mut self, trainer: &Trainer, progress: &Progress) -> Result<()> {
        let training = trainer.training();
        let stage = &training.stage[progress.stage].name;
        let samples = progress.samples;
        let mut lines = [String::new(), String::new(), String::new()];
        let _ = writeln!(
            lines[0],
            "{samples},{stage},{}{}",
            progress.reward,
            progress
                .learnt
                .named()
                .map(|(_, value)| value.map_or(",".to_owned(), |value| format!(",{value}")))
                .concat()
        );
        for (name, played) in progress
            .evaluated
            .iter()
            .flat_map(|evaluated| &evaluated.played)
        {
            let [won, drawn, lost] = played.results;
            let [own, theirs] = played.points;
            let _ = writeln!(
                lines[1],
                "{samples},{stage},{name},{won},{drawn},{lost},{own},{theirs},{},{}",
                played.left_field, progress.is_best
            );
        }
        for (one, opponent) in &progress.finished {
            let [own, theirs] = one.standing.score;
            let side = one.standing.side;
            let seed = one.standing.seed;
            let steps = one.standing.steps;
            let _ = writeln!(
                lines[2],
                "{samples},{stage},{seed},{},{opponent},{own},{theirs},{steps},{},{}",
                side.learner.0,
                one.cut_off,
                self.recording(one)
            );
        }
        for (table, lines) in self.tables.iter_mut().zip(lines) {
            append(&self.folder.join(table.name), &lines)?;
            table.note(&lines);
        }
        let elapsed_s = self.before_s + clock::now().duration_since(self.begun).as_secs_f64();
        let written = writeln!(self.times, "{samples},{elapsed_s:.3}");
        written.with_context(|| format!("cannot write to {}", self.folder.join(TIMES).display()))
    }

    /// Writes the state after this many samples atomically.
    pub(super) fn keep_state(&self, samples: u64, state: &[u8]) -> Result<()> {
        let mut sums = String::new();
        for table in &self.tables {
            let _ = writeln!(
                sums,
                "{samples},{},{},{}",
                table.name,
                table.bytes,
                table.checksum()
            );
        }
        // Write the checksums first: the state depends on them.
        append(&self.folder.join(SUMS), sums)?;
        let path = Files::state(&self.folder);
        let new = self.folder.join("state.new");
        output_file::write(&new, "the state", state)?;
        std::fs::rename(&new, &path)
            .with_context(|| format!("cannot write the state to {}", path.display()))
    }

    /// Writes the current policy, and the best one with a strategy that uses it.
    pub(super) fn models(&self, trainer: &Trainer, is_best: bool) -> Result<()> {
        let model = trainer.model().context("cannot export the policy")?;
        output_file::write(&self.folder.join("last.onnx"), "the policy", model)?;
        let Some(best) = trainer.best().filter(|_| is_best) else {
            return Ok(());
        };
        output_file::write(&self.folder.join("best.onnx"), "the policy", &best.onnx)?;
        let Some(base) = &self.base else {
            return Ok(());
        };
        let strategy = format!(
            "# Plays the policy of the training {}.\nbase = {:?}\n\n[behaviour.learned]\nmodel = \"best.onnx\"\n",
            printable::line(&trainer.training().name),
            base.display().to_string()
        );
        output_file::write(&self.folder.join("best.toml"), "the strategy", strategy)
    }
}

/// Opens the table of times and drops the lines written after the saved state; also returns the
/// last time.
fn open_times(path: &Path, samples: u64) -> Result<(File, f64)> {
    let text = if samples > 0 && path.exists() {
        read(path)?
    } else {
        String::new()
    };
    let is_kept =
        |line: &&str| line.ends_with('\n') && first_number(line).is_some_and(|at| at <= samples);
    let kept: String = text.split_inclusive('\n').filter(is_kept).collect();
    let last = kept
        .lines()
        .last()
        .and_then(|line| line.split_once(',')?.1.parse().ok());
    output_file::write(path, "the training", format!("samples,elapsed_s\n{kept}"))?;
    let file = File::options().append(true).open(path);
    let file = file.with_context(|| format!("cannot write to {}", path.display()))?;
    // A page shows a training run as active while its table is locked. Some file systems do not
    // support locks.
    drop(file.lock_shared());
    Ok((file, last.unwrap_or(0.0)))
}

fn append(path: &Path, bytes: impl AsRef<[u8]>) -> Result<()> {
    let open = || File::options().append(true).open(path);
    let written = open().and_then(|mut file| file.write_all(bytes.as_ref()));
    written.with_context(|| format!("cannot write to {}", path.display()))
}

/// A path of this strategy that is valid in any folder; `None` if it is neither on disk nor built
/// in.
fn base_for(strategy: &Path) -> Option<PathBuf> {
    let inside = || Some(tidied_path(strategy)).filter(|path| built_in(path).is_some());
    std::fs::canonicalize(strategy).ok().or_else(inside)
}

/// Reads a text file from the folder.
fn read(path: &Path) -> Result<String> {
    input_file::read_text(path, TABLE_BYTES_MAX)
        .with_context(|| format!("cannot read {}", path.display()))
}

fn first_number(line: &str) -> Option<u64> {
    line.split(',').next()?.parse().ok()
}
