//! A sweep for Python: its plan, ranges of games played in this process, and the folder with the
//! results.

use crate::arguments::{PackedParts, games_and_seed, packed_of, parts_of, refused, stretch};
use crate::signals;
use experiment::sweep::Sweep;
use experiment::sweep::{self, Plan, Study, StudyError};
use pyo3::exceptions::{PyIndexError, PyOSError};
use pyo3::prelude::*;
use scenario::load_file;
use std::convert::Infallible;
use std::num::NonZeroUsize;
use std::ops::Range;
use std::path::PathBuf;
use std::sync::{Arc, Mutex, PoisonError};

/// The games of a sweep, explained in the stub.
#[pyclass(frozen, module = "squall._native")]
pub(crate) struct SweepPlan(Arc<Plan>);

#[pymethods]
impl SweepPlan {
    #[staticmethod]
    #[pyo3(signature = (path, games=None, seed=None))]
    fn open(
        py: Python<'_>,
        path: PathBuf,
        games: Option<u32>,
        seed: Option<u64>,
    ) -> PyResult<SweepPlan> {
        let (games, seed) = games_and_seed(games, seed)?;
        let plan = py.detach(|| {
            let file = load_file::<Sweep>(&path)?;
            Plan::new(&Sweep {
                games: games.unwrap_or(file.games),
                seed: seed.unwrap_or(file.seed),
                ..file
            })
        });
        plan.map(|plan| SweepPlan(Arc::new(plan))).map_err(refused)
    }

    #[staticmethod]
    fn unpack(py: Python<'_>, packed: PackedParts) -> PyResult<SweepPlan> {
        let plan = py.detach(|| Plan::unpack(packed_of(packed)));
        plan.map(|plan| SweepPlan(Arc::new(plan))).map_err(refused)
    }

    fn pack(&self) -> PackedParts {
        parts_of(self.0.pack())
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
    fn lines(
        &self,
        py: Python<'_>,
        begin: usize,
        end: usize,
        threads: usize,
    ) -> PyResult<Vec<(String, String)>> {
        let (games, threads) = stretch((begin, end), self.0.games(), threads)?;
        py.detach(|| played(&self.0, games, threads))
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
        Ok(SweepStudy {
            plan: Arc::clone(&self.0),
            study: Mutex::new(study),
        })
    }
}

/// Plays games on other threads, while this one lets Python handle signals.
fn played(
    plan: &Plan,
    games: Range<usize>,
    threads: NonZeroUsize,
) -> PyResult<Vec<(String, String)>> {
    signals::heeded(|stop| {
        let mut lines = Vec::with_capacity(games.len());
        let Ok(()) = sweep::play(plan, (games.start, games.end), threads, stop, |played| {
            lines.push(sweep::lines(plan, &played));
            Ok::<(), Infallible>(())
        });
        lines
    })
}

/// The results of a sweep in a folder, explained in the stub.
#[pyclass(frozen, module = "squall._native")]
pub(crate) struct SweepStudy {
    plan: Arc<Plan>,
    study: Mutex<Study>,
}

#[pymethods]
impl SweepStudy {
    #[getter]
    fn done(&self) -> usize {
        self.study
            .lock()
            .unwrap_or_else(PoisonError::into_inner)
            .done()
    }

    fn add(&self, index: usize, game_line: &str, boat_lines: &str) -> PyResult<()> {
        let mut study = self.study.lock().unwrap_or_else(PoisonError::into_inner);
        if index != study.done() {
            return Err(PyIndexError::new_err(format!(
                "game is {index}, expected the next one, {}",
                study.done()
            )));
        }
        study
            .add_lines(index, game_line, boat_lines)
            .map_err(failed)
    }

    fn report(&self, py: Python<'_>) -> PyResult<(String, usize)> {
        py.detach(|| {
            let report = self
                .study
                .lock()
                .unwrap_or_else(PoisonError::into_inner)
                .report(&self.plan)
                .map_err(failed)?;
            Ok((sweep::text(&report), report.failures.len()))
        })
    }
}

/// Converts a study's error, caused by the disk or by the folder's content.
fn failed(error: StudyError) -> PyErr {
    match error {
        StudyError::Io { .. } | StudyError::Table { .. } => PyOSError::new_err(error.to_string()),
        StudyError::Exists { .. } | StudyError::Missing { .. } | StudyError::Other { .. } => {
            refused(error)
        }
    }
}
