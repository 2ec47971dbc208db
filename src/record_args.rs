//! The recording of a run: where it goes, and what of the game goes into it.

use anyhow::{Context, Result};
use game::Scenario;
use game::event::EventCursor;
use game::input::Input;
use game::message::GameInfo;
use game::run_state::RecordingState;
use gateway::utc;
use recording::{Blank, Ending, Header, Note, Recorder, Turn};
use sim::Contest;
use sim::node::{RecordedMessage, Recorder as NodeRecorder, Report};
use std::path::PathBuf;

/// Whether and where `run` records.
#[derive(clap::Args)]
pub(crate) struct RecordArgs {
    /// Records the game into this folder
    #[arg(long, value_name = "DIR", default_value = "runs")]
    record: PathBuf,
    /// Does not record
    #[arg(long, conflicts_with = "record")]
    no_record: bool,
}

impl RecordArgs {
    /// A new file for a game of this scenario, in a folder that is there.
    pub(crate) fn file(&self, scenario: &Scenario, seed: u64) -> Result<Option<PathBuf>> {
        if self.no_record {
            return Ok(None);
        }
        std::fs::create_dir_all(&self.record)
            .with_context(|| format!("cannot make the folder {} for recordings", self.record.display()))?;
        let stem = format!("{}_{}_{seed}", utc::name(), scenario.name);
        let names = std::iter::once(format!("{stem}.mcap")).chain((2..).map(|n| format!("{stem}_{n}.mcap")));
        Ok(names.map(|name| self.record.join(name)).find(|path| !path.exists()))
    }
}

/// How far a recording is.
enum Stage {
    /// Before the first decision there is only the file.
    Blank(Blank),
    Begun(Recorder),
    /// Why there is none.
    Failed(String),
}

/// Writes a game down as it is played, from its first decision on.
pub(crate) struct Tape {
    path: PathBuf,
    game: String,
    pace: String,
    recorder: Stage,
    /// How far events are written down.
    written: EventCursor,
    /// Whether pictures are heard, encoded as they are, since they go over the network.
    hears_pictures: bool,
}

impl Tape {
    /// Of a game of this name at this pace on the network, into a new file.
    pub(crate) fn on_network(path: PathBuf, game: &str, pace: &str) -> Result<Tape> {
        let blank = Blank::create(&path).with_context(|| format!("cannot record into {}", path.display()))?;
        let (game, pace) = (game.to_owned(), pace.to_owned());
        Ok(Tape {
            path,
            game,
            pace,
            recorder: Stage::Blank(blank),
            written: EventCursor::default(),
            hears_pictures: true,
        })
    }

    /// Of a game in this process, into a new file.
    pub(crate) fn in_process(path: PathBuf, game: &str) -> Result<Tape> {
        Ok(Tape { hears_pictures: false, ..Tape::on_network(path, game, "in process")? })
    }

    fn header(&self, contest: &Contest) -> Header {
        let notice = GameInfo {
            version: game::VERSION.to_owned(),
            pace: self.pace.clone(),
            scenario: contest.scenario().clone(),
        };
        Header {
            commit: env!("SQUALL_COMMIT").to_owned(),
            game: self.game.clone(),
            began_utc_ns: utc::now_ns(),
            notice,
            water: sim::node::water(contest),
        }
    }

    /// Begins at the first decision.
    fn begin(&mut self, contest: &Contest) {
        let header = self.header(contest);
        self.recorder = match std::mem::replace(&mut self.recorder, Stage::Failed(String::new())) {
            Stage::Blank(blank) => match Recorder::begin(blank, &header) {
                Ok(recorder) => Stage::Begun(recorder),
                Err(e) => Stage::Failed(e.to_string()),
            },
            later => later,
        };
    }

    /// Ends it well, and says what is missing in it, if anything is.
    pub(crate) fn end(self, report: &Report) -> Result<Option<String>> {
        let run = serde_json::to_value(&report.run).context("the result is not JSON")?;
        let ending = Ending { outcome: report.outcome.clone(), run, dropped: 0 };
        let state = self.state();
        let state = match self.recorder {
            Stage::Begun(recorder) => Some(recorder.end(ending)),
            _ => state,
        };
        Ok(state.as_ref().and_then(trouble))
    }
}

impl NodeRecorder for Tape {
    fn turn(&mut self, contest: &mut Contest) {
        contest.keep_inputs();
        if matches!(self.recorder, Stage::Blank(_)) {
            self.begin(contest);
        }
        let inputs = contest.take_inputs();
        let Stage::Begun(recorder) = &self.recorder else { return };
        let shows = !self.hears_pictures && inputs.contains(&Input::Pictured);
        let pictures = if shows { contest.last_pictures().to_vec() } else { vec![] };
        let turn = Turn { frame: contest.frame(&mut self.written), pictures, inputs };
        recorder.note(Note::Turn(Box::new(turn)));
    }

    fn heard(&mut self, heard: RecordedMessage) {
        let RecordedMessage { topic, schema, bytes, at } = heard;
        if let Stage::Begun(recorder) = &self.recorder {
            recorder.note(Note::Heard { topic, schema, bytes, at });
        }
    }

    fn state(&self) -> Option<RecordingState> {
        let file = self.path.display().to_string();
        Some(match &self.recorder {
            Stage::Blank(_) => RecordingState { file, ..RecordingState::default() },
            Stage::Begun(recorder) => recorder.state(),
            Stage::Failed(reason) => RecordingState { file, failed: Some(reason.clone()), ..RecordingState::default() },
        })
    }
}

/// What is wrong with a recording, in words, if anything is.
fn trouble(state: &RecordingState) -> Option<String> {
    let file = &state.file;
    match &state.failed {
        Some(reason) => Some(format!("the recording {file} is not complete: {reason}")),
        None if state.dropped > 0 => {
            Some(format!("the recording {file} lacks {} messages: the disk was too slow", state.dropped))
        }
        None => None,
    }
}
