//! A tournament for Python: its plan, ranges of games played in this process, and the results.

use crate::arguments::{PackedParts, games_and_seed, packed_of, parts_of, refused, stretch};
use crate::signals;
use experiment::tournament::Tournament;
use experiment::tournament::{Plan, Record, Report, WIDTH, csv, play, text};
use pyo3::exceptions::PyIndexError;
use pyo3::prelude::*;
use scenario::load_file;
use std::num::NonZeroUsize;
use std::ops::Range;
use std::path::PathBuf;
use std::sync::Arc;

/// The games of a tournament, explained in the stub.
#[pyclass(frozen, module = "squall._native")]
pub(crate) struct TournamentPlan(Arc<Plan>);

#[pymethods]
impl TournamentPlan {
    #[staticmethod]
    #[pyo3(signature = (path, games=None, seed=None))]
    fn open(
        py: Python<'_>,
        path: PathBuf,
        games: Option<u32>,
        seed: Option<u64>,
    ) -> PyResult<TournamentPlan> {
        let (games, seed) = games_and_seed(games, seed)?;
        let plan = py.detach(|| {
            let file = load_file::<Tournament>(&path)?;
            Plan::new(&Tournament {
                games: games.unwrap_or(file.games),
                seed: seed.unwrap_or(file.seed),
                ..file
            })
        });
        plan.map(|plan| TournamentPlan(Arc::new(plan)))
            .map_err(refused)
    }

    #[staticmethod]
    fn unpack(py: Python<'_>, packed: PackedParts) -> PyResult<TournamentPlan> {
        let plan = py.detach(|| Plan::unpack(packed_of(packed)));
        plan.map(|plan| TournamentPlan(Arc::new(plan)))
            .map_err(refused)
    }

    fn pack(&self) -> PackedParts {
        parts_of(self.0.pack())
    }

    #[getter]
    fn name(&self) -> &str {
        &self.0.tournament().name
    }

    #[getter]
    fn digest(&self) -> String {
        self.0.digest()
    }

    #[getter]
    fn games(&self) -> usize {
        self.0.games()
    }

    #[pyo3(signature = (begin, end, threads=1))]
    fn records(
        &self,
        py: Python<'_>,
        begin: usize,
        end: usize,
        threads: usize,
    ) -> PyResult<Vec<String>> {
        let (games, threads) = stretch((begin, end), self.0.games(), threads)?;
        py.detach(|| played(&self.0, games, threads))
    }

    fn report(
        &self,
        py: Python<'_>,
        records: Vec<String>,
    ) -> PyResult<(String, String, String, usize)> {
        py.detach(|| {
            let records = records
                .iter()
                .map(|record| serde_json::from_str(record))
                .collect::<Result<Vec<Record>, _>>();
            let records =
                records.map_err(|error| refused(format!("a record cannot be read: {error}")))?;
            if (0..records.len())
                .any(|i| i >= self.0.games() || records[i].of != self.0.match_at(i).0)
            {
                return Err(PyIndexError::new_err(
                    "the records are not the tournament's first games in order",
                ));
            }
            let report = Report::new(&self.0, &records);
            let json = serde_json::to_string_pretty(&report).expect("the report can be encoded");
            Ok((
                text(&report, WIDTH),
                json + "\n",
                csv(&report),
                report.failures.len(),
            ))
        })
    }
}

/// Plays games on other threads, while this one lets Python handle signals.
fn played(plan: &Plan, games: Range<usize>, threads: NonZeroUsize) -> PyResult<Vec<String>> {
    let games: Vec<usize> = games.collect();
    signals::heeded(|stop| {
        let mut records = Vec::with_capacity(games.len());
        play(plan, &games, threads, stop, |record| {
            records.push(serde_json::to_string(&record).expect("the record can be encoded"));
        });
        records
    })
}
