//! Records a running game, networked or in this process, from its first decision.

use crate::contest::Contest;
use crate::progress::Report;
use messages::input::Input;
use messages::run_state::RecordingState;
use messages::{Frame, GameInfo};
use recording::{Decision, Ending, Entry, Header, NewFile, Recorder, utc};
use std::path::PathBuf;
use std::sync::Arc;

enum Stage {
    /// The first decision has not been made; only the file exists.
    Waiting(NewFile),
    Recording(Recorder),
    /// The recording failed for this reason.
    Failed(String),
}

/// The recorder of a game. The game never waits for it.
pub struct GameRecorder {
    path: PathBuf,
    game: String,
    pace: String,
    commit: String,
    stage: Stage,
    /// Whether pictures are sent over the network, and recorded as sent.
    pictures_are_sent: bool,
}

impl GameRecorder {
    /// A recorder that writes a new file, for a networked game with this name and pace, played by a
    /// program built from this commit.
    pub fn on_network(file: NewFile, game: &str, pace: &str, commit: &str) -> GameRecorder {
        let path = file.path().to_owned();
        let [game, pace, commit] = [game, pace, commit].map(str::to_owned);
        GameRecorder {
            path,
            game,
            pace,
            commit,
            stage: Stage::Waiting(file),
            pictures_are_sent: true,
        }
    }

    /// A recorder that writes a new file, for a game in this process.
    pub fn in_process(file: NewFile, game: &str, commit: &str) -> GameRecorder {
        let recorder = GameRecorder::on_network(file, game, "in process", commit);
        GameRecorder {
            pictures_are_sent: false,
            ..recorder
        }
    }

    /// Records a decision: its frame, and the contest's inputs since the previous one.
    pub fn decision(&mut self, contest: &mut Contest, frame: Arc<Frame>) {
        contest.keep_inputs();
        self.begin(contest);
        let inputs = contest.take_inputs();
        let Stage::Recording(recorder) = &self.stage else {
            return;
        };
        // Over the network, pictures are recorded as sent; in one process they are never encoded.
        let shows = !self.pictures_are_sent && inputs.contains(&Input::Pictured);
        let pictures = if shows {
            contest.last_pictures().to_vec()
        } else {
            vec![]
        };
        // Pass the decision on unencoded: another thread encodes and writes it, so that the disk
        // never delays a game.
        recorder.record(Entry::Decision(Box::new(Decision {
            frame,
            pictures,
            inputs,
        })));
    }

    /// Records a network message.
    pub fn message(&self, entry: Entry) {
        if let Stage::Recording(recorder) = &self.stage {
            recorder.record(entry);
        }
    }

    /// The state of the recording.
    pub fn state(&self) -> RecordingState {
        let unwritten = |failed| RecordingState {
            file: self.path.display().to_string(),
            failed,
            ..RecordingState::default()
        };
        match &self.stage {
            Stage::Waiting(_) => unwritten(None),
            Stage::Recording(recorder) => recorder.state(),
            Stage::Failed(reason) => unwritten(Some(reason.clone())),
        }
    }

    /// Completes the recording with the result of the game. Returns the final state.
    pub fn end(self, report: &Report) -> RecordingState {
        let state = self.state();
        let run = serde_json::to_value(&report.run).expect("a run is JSON");
        let ending = Ending {
            outcome: report.outcome.clone(),
            run,
            dropped: 0,
        };
        if let Stage::Recording(recorder) = self.stage {
            recorder.end(ending.facts())
        } else {
            state
        }
    }

    /// Starts the recording at the first decision.
    fn begin(&mut self, contest: &Contest) {
        if !matches!(self.stage, Stage::Waiting(_)) {
            return;
        }
        let info = GameInfo {
            version: primitives::VERSION.to_owned(),
            pace: self.pace.clone(),
            scenario: contest.scenario().clone(),
        };
        let water = contest.world().sea().water();
        let commit = self.commit.clone();
        let game = self.game.clone();
        let header = Header {
            commit,
            game,
            began_utc_ns: utc::now_ns(),
            info,
            water,
        };
        self.stage = match std::mem::replace(&mut self.stage, Stage::Failed(String::new())) {
            Stage::Waiting(file) => Recorder::begin(file, &header.opening())
                .map_or_else(|e| Stage::Failed(e.to_string()), Stage::Recording),
            later => later,
        };
    }
}
