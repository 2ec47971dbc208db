//! The games behind a report. A game without a recording is played when a page requests it, and
//! recorded temporarily.

use crate::in_process;
use crate::network::replay_command;
use anyhow::{Context, Result, bail};
use rayon::{ThreadPool, ThreadPoolBuilder};
use recording::NewFile;
use scenario::Scenario;
use shore::page::{PreparingView, Showing, Shown};
use std::collections::VecDeque;
use std::num::NonZeroUsize;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::{Arc, Mutex, PoisonError};
use tempfile::TempDir;

/// Maximum number of open games; an unused game is closed to make room for more.
const OPEN_MAX: usize = 8;
/// Maximum number of games being played at the same time.
const PLAYED_MAX: usize = 2;
/// Number of decisions between progress messages to a page.
const TELL_EVERY: u64 = 100;

/// The source of a game.
pub(super) enum Source {
    /// An existing recording.
    Recorded(PathBuf),
    /// The game is played again; `digest` is the expected digest, if the report contains one.
    Played {
        scenario: Box<Scenario>,
        seed: u64,
        digest: Option<String>,
    },
}

/// A game of a report.
pub(super) struct Game {
    /// A description of the game.
    pub(super) about: String,
    pub(super) source: Source,
}

/// The games that pages show.
pub(super) struct Games {
    open: Mutex<VecDeque<Open>>,
    folder: TempDir,
    /// The number of the next recording.
    recordings: AtomicU64,
    /// Plays the games.
    players: ThreadPool,
    stop: Arc<AtomicBool>,
}

/// A game that is open or being prepared.
struct Open {
    name: String,
    showing: Arc<Showing>,
    /// Where the game is recorded if it is played.
    file: PathBuf,
}

impl Drop for Open {
    fn drop(&mut self) {
        // No file exists if the game had already been recorded, or could not be played.
        drop(std::fs::remove_file(&self.file));
    }
}

impl Games {
    pub(super) fn new(stop: &Arc<AtomicBool>) -> Result<Games> {
        let folder = TempDir::with_prefix("squall-view-")
            .context("cannot create a folder for the recordings of games")?;
        // A game that panics is reported by its thread, and must not end other games.
        let players = ThreadPoolBuilder::new()
            .num_threads(PLAYED_MAX)
            .panic_handler(drop)
            .build()?;
        Ok(Games {
            open: Mutex::default(),
            folder,
            recordings: AtomicU64::new(0),
            players,
            stop: Arc::clone(stop),
        })
    }

    /// The view of the game with this name; `find` returns its description and source.
    pub(super) fn show(&self, name: &str, find: impl FnOnce() -> Result<Game>) -> Shown {
        let mut open = self.open.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(known) = open.iter().find(|open| open.name == name) {
            return known.showing.shown();
        }
        let refused = |why: &str| Showing::new(Arc::new(PreparingView::failed(why))).shown();
        if open.len() >= OPEN_MAX {
            let Some(idle) = open.iter().position(|open| !open.showing.is_watched()) else {
                return refused(&format!(
                    "{OPEN_MAX} other games are open; close one of them, then reload this page"
                ));
            };
            open.remove(idle);
        }
        let game = match find() {
            Ok(game) => game,
            Err(why) => return refused(&command_line::explain::line(&why)),
        };
        let preparing = Arc::new(PreparingView::new(&format!(
            "{}: waiting for another game to end",
            game.about
        )));
        let showing = Showing::new(Arc::clone(&preparing) as _);
        let file = self.folder.path().join(format!(
            "{}.mcap",
            self.recordings.fetch_add(1, Ordering::Relaxed)
        ));
        let shown = showing.shown();
        open.push_back(Open {
            name: name.to_owned(),
            showing: Arc::clone(&showing),
            file: file.clone(),
        });
        let stop = Arc::clone(&self.stop);
        self.players
            .spawn(move || match prepare(&game, &file, &stop, &preparing) {
                Ok(view) => showing.show(Arc::new(view)),
                Err(why) => {
                    let why = format!("{}: {}", game.about, command_line::explain::line(&why));
                    showing.show(Arc::new(PreparingView::failed(&why)));
                }
            });
        shown
    }
}

/// Plays a game unless it has been recorded, and opens its recording.
fn prepare(
    game: &Game,
    file: &Path,
    stop: &AtomicBool,
    preparing: &PreparingView,
) -> Result<shore::page::replay::ReplayView> {
    let (scenario, seed, digest) = match &game.source {
        Source::Recorded(path) => return replay_command::open(path, Some(game.about.clone())),
        Source::Played {
            scenario,
            seed,
            digest,
        } => (scenario, *seed, digest),
    };
    let end_s = scenario.rules.time_limit.as_s();
    let new =
        NewFile::create(file).with_context(|| format!("cannot record to {}", file.display()))?;
    let report = in_process::play(
        scenario,
        seed,
        Some(new),
        (NonZeroUsize::MIN, stop),
        |contest| {
            if contest.decision().is_multiple_of(TELL_EVERY) {
                let share = 100.0 * (contest.now().as_s() / end_s).clamp(0.0, 1.0);
                preparing.tell(&format!("{}: playing, {share:.0} %", game.about));
            }
        },
    )?;
    if let Some(problem) = report.run.recording_problem {
        bail!("{problem}");
    }
    let about = match digest {
        Some(digest) if *digest == report.outcome.digest => {
            format!("{}; rerun, identical to the report", game.about)
        }
        Some(_) => format!(
            "{}; rerun, NOT identical to the report: this program gives a different result",
            game.about
        ),
        None => format!("{}; rerun", game.about),
    };
    replay_command::open(file, Some(about))
}
