//! Plays a whole game in this process, and optionally records it.

use crate::clock;
use agent::MindRunner;
use anyhow::Result;
use recording::NewFile;
use rules::event::EventCursor;
use scenario::Scenario;
use sim::{Contest, EntryFaults, GameRecorder, Report, Run};
use std::num::NonZeroUsize;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

/// Plays the game of `scenario` with `seed`, without a network, until it is over or `stop` is set.
/// With many minds, `threads` threads make their decisions. Calls `look` before every decision and
/// at the end.
///
/// # Errors
/// If the game cannot start.
pub(crate) fn play(
    scenario: &Scenario,
    seed: u64,
    file: Option<NewFile>,
    (threads, stop): (NonZeroUsize, &AtomicBool),
    mut look: impl FnMut(&Contest),
) -> Result<Report> {
    let scenario = scenario.of_seed(seed)?;
    let start = clock::now();
    let mut recorder =
        file.map(|file| GameRecorder::in_process(file, &scenario.name, env!("SQUALL_COMMIT")));
    let mut written = EventCursor::default();
    let mut entry_faults = vec![];
    let watch = |contest: &mut Contest, runner: &MindRunner| {
        if contest.is_over() || stop.load(Ordering::Relaxed) {
            let faults = runner.faults().map(|(vehicle, first, count)| EntryFaults {
                boat: scenario.vehicles[vehicle.index()].name.clone(),
                first,
                count,
            });
            entry_faults = faults.collect();
        }
        if let Some(recorder) = &mut recorder {
            let frame = Arc::new(contest.frame(&mut written));
            recorder.decision(contest, frame);
        }
        look(contest);
        !stop.load(Ordering::Relaxed)
    };
    let runner = arena::runner_of(agent::minds_of(&scenario)).on_threads(threads.get());
    let outcome = arena::play_on(&scenario, runner, seed, watch)?;
    let run = Run {
        pace: "in process".to_owned(),
        wall_s: start.elapsed().as_secs_f64(),
        cut_short: stop.load(Ordering::Relaxed),
        entry_faults,
        ..Run::default()
    };
    let mut report = Report { outcome, run };
    report.run.recording_problem = recorder.and_then(|recorder| recorder.end(&report).problem());
    Ok(report)
}
