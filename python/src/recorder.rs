//! Records the games of an environment, each into a file of its own, as `squall run` records one.

use game::Scenario;
use game::event::EventCursor;
use game::message::Frame;
use learn::environment::{Moment, Watch, Watches};
use recording::{RecordError, utc};
use sim::{Contest, GameRecorder, Report, Run};
use std::io::ErrorKind;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, PoisonError};

/// Others may record into the same folder: so often another name is tried.
const NAMES_MAX: u32 = 100;

/// What has become of recordings, until somebody asks.
#[derive(Default)]
pub(crate) struct Log {
    /// The file that was completed last.
    newest: Mutex<Option<PathBuf>>,
    /// What went wrong, in words.
    problems: Mutex<Vec<String>>,
}

impl Log {
    /// The newest file, if one has been completed since this was asked last.
    pub(crate) fn take_newest(&self) -> Option<PathBuf> {
        self.newest.lock().unwrap_or_else(PoisonError::into_inner).take()
    }

    /// What has gone wrong since this was asked last.
    pub(crate) fn take_problems(&self) -> Vec<String> {
        std::mem::take(&mut *self.problems.lock().unwrap_or_else(PoisonError::into_inner))
    }

    fn completed(&self, file: PathBuf) {
        *self.newest.lock().unwrap_or_else(PoisonError::into_inner) = Some(file);
    }

    fn problem(&self, problem: String) {
        self.problems.lock().unwrap_or_else(PoisonError::into_inner).push(problem);
    }
}

/// Records each `every`th game into this folder.
pub(crate) fn watches(folder: PathBuf, every: u64, log: Arc<Log>) -> Watches {
    Arc::new(move |number| {
        number.is_multiple_of(every).then(|| -> Watch {
            let mut game = RecordedGame {
                folder: folder.clone(),
                log: Arc::clone(&log),
                shown: EventCursor::default(),
                began_utc_ns: utc::now_ns(),
                stage: Stage::Waiting,
            };
            Box::new(move |contest, moment| game.see(contest, moment))
        })
    })
}

/// A game, and how far its recording is.
struct RecordedGame {
    folder: PathBuf,
    log: Arc<Log>,
    shown: EventCursor,
    began_utc_ns: u64,
    stage: Stage,
}

/// A game of which no step is played leaves no file.
enum Stage {
    /// Nothing has been seen.
    Waiting,
    /// A copy of the game at its start, and its first frame.
    Start(Box<Contest>, Arc<Frame>),
    Recording(Box<GameRecorder>, PathBuf),
    /// The file is complete, or there is none, and why has been told.
    Ended,
}

impl RecordedGame {
    fn see(&mut self, contest: &mut Contest, moment: Moment) {
        let stage = std::mem::replace(&mut self.stage, Stage::Ended);
        self.stage = match (stage, moment) {
            (Stage::Waiting, _) => {
                contest.keep_inputs();
                Stage::Start(Box::new(contest.clone()), Arc::new(contest.frame(&mut self.shown)))
            }
            (Stage::Start(mut start, first), Moment::Decision) => match self.begin(start.scenario()) {
                Ok((mut recorder, path)) => {
                    recorder.decision(&mut start, first);
                    recorder.decision(contest, Arc::new(contest.frame(&mut self.shown)));
                    Stage::Recording(Box::new(recorder), path)
                }
                Err(error) => {
                    let (folder, seed) = (self.folder.display(), contest.scenario().seed);
                    self.log.problem(format!("the game of seed {seed} is not recorded in {folder}: {error}"));
                    Stage::Ended
                }
            },
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
                let state = recorder.end(&Report { outcome: contest.outcome(), run });
                state.problem().into_iter().for_each(|problem| self.log.problem(problem));
                self.log.completed(path);
                Stage::Ended
            }
            (Stage::Start(..), Moment::End) | (Stage::Ended, _) => Stage::Ended,
        };
    }

    /// A new file for the game.
    fn begin(&self, game: &Scenario) -> Result<(GameRecorder, PathBuf), RecordError> {
        let mut tried = 0;
        loop {
            let path = recording::free_path(&self.folder, &game.name, game.seed);
            tried += 1;
            match GameRecorder::in_process(path.clone(), &game.name, "unknown") {
                Err(RecordError::File(error)) if error.kind() == ErrorKind::AlreadyExists && tried < NAMES_MAX => {}
                begun => return begun.map(|recorder| (recorder, path)),
            }
        }
    }
}

impl Drop for RecordedGame {
    /// A game that was given up: what was played of it is kept, without a result.
    fn drop(&mut self) {
        if let Stage::Recording(recorder, path) = std::mem::replace(&mut self.stage, Stage::Ended) {
            let problem = recorder.state().problem();
            drop(recorder);
            problem.into_iter().for_each(|problem| self.log.problem(problem));
            self.log.completed(path);
        }
    }
}

/// Whether a folder takes files, which it is made for where it is not there.
pub(crate) fn check_folder(folder: &Path) -> Result<(), String> {
    let wrong = |error: std::io::Error| format!("record is {:?}, expected a folder for recordings: {error}", folder);
    std::fs::create_dir_all(folder).map_err(wrong)?;
    let file = folder.join(format!(".squall-{}-{}", std::process::id(), utc::now_ns()));
    std::fs::File::create_new(&file).map_err(wrong)?;
    std::fs::remove_file(&file).map_err(wrong)
}
