//! A sweep for Python: its plan, stretches of its games played in this process, and the folder that keeps what came of them.

use crate::arguments::refused;
use game::scenario::{Sweep, load_sweep};
use pyo3::exceptions::{PyIndexError, PyOSError};
use pyo3::prelude::*;
use std::convert::Infallible;
use std::num::NonZeroUsize;
use std::path::PathBuf;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;
use sweep::{Packed, Plan, Study, StudyError};

/// How often Python is asked whether somebody has pressed Ctrl-C.
const SIGNALS_EVERY: Duration = Duration::from_millis(100);

/// Which games a sweep consists of; the stub explains it.
#[pyclass(frozen, module = "squall._native")]
pub(crate) struct SweepPlan(Arc<Plan>);

#[pymethods]
impl SweepPlan {
    #[staticmethod]
    #[pyo3(signature = (path, games=None, seed=None))]
    fn open(py: Python<'_>, path: PathBuf, games: Option<u32>, seed: Option<u64>) -> PyResult<SweepPlan> {
        if let Some(games) = games.filter(|games| !(2..=1_000_000).contains(games)) {
            return Err(refused(format!("games is {games}, expected 2 to 1000000")));
        }
        if let Some(seed) = seed.filter(|seed| i64::try_from(*seed).is_err()) {
            return Err(refused(format!("seed is {seed}, expected 0 to {}", i64::MAX)));
        }
        let plan = py.detach(|| {
            let file = load_sweep(&path)?;
            Plan::new(&Sweep { games: games.unwrap_or(file.games), seed: seed.unwrap_or(file.seed), ..file })
        });
        plan.map(|plan| SweepPlan(Arc::new(plan))).map_err(refused)
    }

    #[staticmethod]
    fn unpack(py: Python<'_>, packed: (String, Vec<(PathBuf, Vec<u8>)>, String)) -> PyResult<SweepPlan> {
        let (sweep, files, digest) = packed;
        let plan = py.detach(|| Packed { sweep, files, digest }.unpack());
        plan.map(|plan| SweepPlan(Arc::new(plan))).map_err(refused)
    }

    fn pack(&self) -> (String, Vec<(PathBuf, Vec<u8>)>, String) {
        let Packed { sweep, files, digest } = Packed::new(&self.0);
        (sweep, files, digest)
    }

    #[getter]
    fn name(&self) -> &str {
        &self.0.sweep().name
    }

    #[getter]
    fn digest(&self) -> String {
        self.0.digest()
    }

    #[getter]
    fn points(&self) -> usize {
        self.0.points().len()
    }

    #[getter]
    fn games_per_point(&self) -> usize {
        self.0.games_per_point()
    }

    #[getter]
    fn games(&self) -> usize {
        self.0.games()
    }

    #[pyo3(signature = (begin, end, threads=1))]
    fn lines(&self, py: Python<'_>, begin: usize, end: usize, threads: usize) -> PyResult<Vec<(String, String)>> {
        if begin > end || end > self.0.games() {
            let games = self.0.games();
            return Err(PyIndexError::new_err(format!(
                "games {begin} to {end}, expected from 0 to {games} and in order"
            )));
        }
        let Some(threads) = NonZeroUsize::new(threads) else {
            return Err(refused("threads is 0, expected at least 1"));
        };
        py.detach(|| play(&self.0, (begin, end), threads))
    }

    fn begin(&self, folder: PathBuf) -> PyResult<SweepStudy> {
        self.kept(Study::begin(&folder, &self.0))
    }

    fn resume(&self, folder: PathBuf) -> PyResult<SweepStudy> {
        self.kept(Study::resume(&folder, &self.0))
    }
}

impl SweepPlan {
    fn kept(&self, study: Result<Study, StudyError>) -> PyResult<SweepStudy> {
        let study = study.map_err(failed)?;
        Ok(SweepStudy { plan: Arc::clone(&self.0), study: Mutex::new(study) })
    }
}

/// Plays games on other threads than this one, which has Python look after its signals.
fn play(plan: &Plan, games: (usize, usize), threads: NonZeroUsize) -> PyResult<Vec<(String, String)>> {
    let stop = AtomicBool::new(false);
    std::thread::scope(|scope| {
        let (sender, receiver) = channel();
        let stop = &stop;
        scope.spawn(move || {
            let played = sweep::play(plan, games, threads, stop, |played| {
                // Nobody listens any more after a signal.
                drop(sender.send(sweep::lines(plan, &played)));
                Ok::<(), Infallible>(())
            });
            let Ok(()) = played;
        });
        let mut lines = Vec::with_capacity(games.1 - games.0);
        loop {
            match receiver.recv_timeout(SIGNALS_EVERY) {
                Ok(line) => lines.push(line),
                Err(RecvTimeoutError::Timeout) => {}
                Err(RecvTimeoutError::Disconnected) => return Ok(lines),
            }
            // Else the scope waits for games that nobody wants.
            Python::attach(|py| py.check_signals()).inspect_err(|_| stop.store(true, Ordering::Relaxed))?;
        }
    })
}

/// A sweep that is kept in a folder; the stub explains it.
#[pyclass(frozen, module = "squall._native")]
pub(crate) struct SweepStudy {
    plan: Arc<Plan>,
    study: Mutex<Study>,
}

#[pymethods]
impl SweepStudy {
    #[getter]
    fn done(&self) -> usize {
        self.study.lock().unwrap_or_else(PoisonError::into_inner).done()
    }

    fn add(&self, index: usize, game_line: &str, boat_lines: &str) -> PyResult<()> {
        let mut study = self.study.lock().unwrap_or_else(PoisonError::into_inner);
        if index != study.done() {
            return Err(PyIndexError::new_err(format!("game {index}, expected the next one, {}", study.done())));
        }
        study.add_lines(index, game_line, boat_lines).map_err(failed)
    }

    fn report(&self, py: Python<'_>) -> PyResult<(String, usize)> {
        py.detach(|| {
            let report =
                self.study.lock().unwrap_or_else(PoisonError::into_inner).report(&self.plan).map_err(failed)?;
            Ok((sweep::text(&report), report.failures.len()))
        })
    }
}

/// A study's error: of the disk, or of what the folder holds.
fn failed(error: StudyError) -> PyErr {
    match error {
        StudyError::Io { .. } | StudyError::Table { .. } => PyOSError::new_err(error.to_string()),
        StudyError::Exists { .. } | StudyError::Missing { .. } | StudyError::Other { .. } => refused(error),
    }
}
