//! Records games of an environment, one file each, in the format of `squall run`.

use super::watch::{Moment, Watch, Watches};
use messages::Frame;
use recording::{NewFile, RecordError, utc};
use rules::event::EventCursor;
use scenario::Scenario;
use sim::{Contest, GameRecorder, Report, Run};
use std::io::ErrorKind;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, PoisonError};

/// Results of recordings, until a caller takes them.
#[derive(Default)]
pub struct RecordingLog {
    /// The most recently completed file.
    newest: Mutex<Option<PathBuf>>,
    /// Error messages.
    problems: Mutex<Vec<String>>,
}

impl RecordingLog {
    /// The newest file completed since the last call.
    pub fn take_newest(&self) -> Option<PathBuf> {
        self.newest
            .lock()
            .unwrap_or_else(PoisonError::into_inner)
            .take()
    }

    /// The errors since the last call.
    pub fn take_problems(&self) -> Vec<String> {
        std::mem::take(&mut *self.problems.lock().unwrap_or_else(PoisonError::into_inner))
    }

    fn completed(&self, file: PathBuf) {
        *self.newest.lock().unwrap_or_else(PoisonError::into_inner) = Some(file);
    }

    fn problem(&self, problem: String) {
        self.problems
            .lock()
            .unwrap_or_else(PoisonError::into_inner)
            .push(problem);
    }
}

/// How recordings are named, and whether abandoned games are kept.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RecordingNames {
    /// By time, game and seed, so that no file is replaced. Keeps the part of an abandoned game
    /// that was played, without a result.
    ByTime,
    /// By the game's seed and number; see [`recording_name`]. Replaces existing files and discards
    /// abandoned games.
    ByNumber,
}

/// The file name of a recording.
pub fn recording_name(seed: u64, number: u64) -> String {
    format!("{seed}_{number}.mcap")
}

/// Recording settings.
#[derive(Clone)]
pub struct Recordings {
    /// An existing folder.
    pub folder: PathBuf,
    /// How files are named.
    pub names: RecordingNames,
    /// Records every n-th game, including the first.
    pub every: u64,
    /// The commit of the program that writes the recordings.
    pub commit: String,
}

impl Recordings {
    /// Returns watches that record games. Results go to the log. Errors do not stop games.
    pub fn watches(self, log: Arc<RecordingLog>) -> Watches {
        let recordings = Arc::new(self);
        Arc::new(move |number| {
            number.is_multiple_of(recordings.every).then(|| -> Watch {
                let mut game = RecordedGame {
                    recordings: Arc::clone(&recordings),
                    number,
                    log: Arc::clone(&log),
                    shown: EventCursor::default(),
                    began_utc_ns: utc::now_ns(),
                    stage: Stage::Waiting,
                };
                Box::new(move |contest, moment| game.see(contest, moment))
            })
        })
    }

    /// Creates the file of a game.
    fn begin(&self, game: &Scenario, number: u64) -> Result<(GameRecorder, PathBuf), RecordError> {
        let file = match self.names {
            RecordingNames::ByTime => {
                NewFile::create_numbered(&self.folder, &recording::stem(&game.name, game.seed))?
            }
            RecordingNames::ByNumber => {
                let path = self.folder.join(recording_name(game.seed, number));
                match std::fs::remove_file(&path) {
                    Err(error) if error.kind() != ErrorKind::NotFound => return Err(error.into()),
                    _ => NewFile::create(&path)?,
                }
            }
        };
        let path = file.path().to_owned();
        Ok((
            GameRecorder::in_process(file, &game.name, &self.commit),
            path,
        ))
    }
}

struct RecordedGame {
    recordings: Arc<Recordings>,
    number: u64,
    log: Arc<RecordingLog>,
    shown: EventCursor,
    began_utc_ns: u64,
    stage: Stage,
}

/// The stage of a recording. A game in which no step was played leaves no file.
enum Stage {
    Waiting,
    /// The game before its first step, and its first frame.
    Start(Box<Contest>, Arc<Frame>),
    Recording(Box<GameRecorder>, PathBuf),
    /// The file is complete, or writing it failed and the error was logged.
    Ended,
}

impl RecordedGame {
    fn see(&mut self, contest: &mut Contest, moment: Moment) {
        let stage = std::mem::replace(&mut self.stage, Stage::Ended);
        self.stage = match (stage, moment) {
            (Stage::Waiting, _) => {
                contest.keep_inputs();
                Stage::Start(
                    Box::new(contest.clone()),
                    Arc::new(contest.frame(&mut self.shown)),
                )
            }
            // Record each decision as it is played: one step may end a game and begin the next.
            (Stage::Start(mut start, first), Moment::Decision) => {
                match self.recordings.begin(start.scenario(), self.number) {
                    Ok((mut recorder, path)) => {
                        recorder.decision(&mut start, first);
                        recorder.decision(contest, Arc::new(contest.frame(&mut self.shown)));
                        Stage::Recording(Box::new(recorder), path)
                    }
                    Err(error) => {
                        let folder = self.recordings.folder.display();
                        let seed = contest.scenario().seed;
                        self.log.problem(format!(
                            "cannot record the game with seed {seed} in {folder}: {error}"
                        ));
                        Stage::Ended
                    }
                }
            }
            (Stage::Recording(mut recorder, path), Moment::Decision) => {
                recorder.decision(contest, Arc::new(contest.frame(&mut self.shown)));
                Stage::Recording(recorder, path)
            }
            (Stage::Recording(recorder, path), Moment::End) => {
                let run = Run {
                    pace: "in process".to_owned(),
                    wall_s: utc::now_ns().saturating_sub(self.began_utc_ns) as f64 * 1e-9,
                    cut_short: !contest.is_over(),
                    ..Run::default()
                };
                let state = recorder.end(&Report {
                    outcome: contest.outcome(),
                    run,
                });
                state
                    .problem()
                    .into_iter()
                    .for_each(|problem| self.log.problem(problem));
                self.log.completed(path);
                Stage::Ended
            }
            (Stage::Start(..), Moment::End) | (Stage::Ended, _) => Stage::Ended,
        };
    }
}

impl Drop for RecordedGame {
    /// Ends the recording of an abandoned game.
    fn drop(&mut self) {
        let Stage::Recording(recorder, path) = std::mem::replace(&mut self.stage, Stage::Ended)
        else {
            return;
        };
        let problem = recorder.state().problem();
        drop(recorder);
        problem
            .into_iter()
            .for_each(|problem| self.log.problem(problem));
        match self.recordings.names {
            RecordingNames::ByTime => self.log.completed(path),
            RecordingNames::ByNumber => {
                if let Err(error) = std::fs::remove_file(&path) {
                    self.log
                        .problem(format!("cannot remove {}: {error}", path.display()));
                }
            }
        }
    }
}

/// Creates a folder for recordings if necessary and checks that it is writable.
///
/// # Errors
/// If no file can be created in it.
pub fn check_recording_folder(folder: &Path) -> std::io::Result<()> {
    std::fs::create_dir_all(folder)?;
    let file = folder.join(format!(".squall-{}-{}", std::process::id(), utc::now_ns()));
    std::fs::File::create_new(&file)?;
    std::fs::remove_file(&file)
}
