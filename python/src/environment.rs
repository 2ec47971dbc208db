//! Parallel games for Python: steps without the interpreter's lock, into numpy arrays that are
//! reused.

use crate::arguments::{Arguments, refused};
use crate::{scene, standing};
use learn::environment::{
    Action, Event, Games, Logged, RecordingLog, RecordingNames, Recordings, Rows, Setup,
    check_recording_folder,
};
use numpy::{
    PyArray1, PyArray2, PyArrayMethods, PyReadonlyArray1, PyReadonlyArray2, PyUntypedArrayMethods,
};
use pyo3::exceptions::{PyIndexError, PyRuntimeError, PyRuntimeWarning};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use std::ffi::CString;
use std::path::PathBuf;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

/// Parallel games, explained in the stub.
#[pyclass(module = "squall._native")]
pub(crate) struct VectorEnvironment {
    games: Mutex<Games>,
    actions: Vec<Action>,
    arrays: Arrays,
    /// `None` if no games are recorded.
    recordings: Option<Arc<RecordingLog>>,
    /// The process in which the threads run.
    process: u32,
}

/// An event: name, time in s, boat, other boat, and team (the boat's, or the winner).
type EventParts = (
    &'static str,
    f64,
    Option<usize>,
    Option<usize>,
    Option<usize>,
);

/// The arrays that a step writes: rows × values, or rows.
struct Arrays {
    observations: Py<PyArray2<f32>>,
    final_observations: Py<PyArray2<f32>>,
    rewards: Py<PyArray1<f32>>,
    counts: Py<PyArray1<bool>>,
    terminated: Py<PyArray1<bool>>,
    truncated: Py<PyArray1<bool>>,
    /// The truth, rows × values; empty unless requested.
    states: Py<PyArray2<f32>>,
    final_states: Py<PyArray2<f32>>,
}

impl Arrays {
    fn new(py: Python<'_>, rows: usize, setup: &Setup) -> Arrays {
        let table = |numbers: usize| PyArray2::zeros(py, [rows, numbers], false).unbind();
        let numbers = setup.observation_size();
        let truths = setup.truth_size();
        let flags = || PyArray1::zeros(py, [rows], false).unbind();
        Arrays {
            observations: table(numbers),
            final_observations: table(numbers),
            rewards: PyArray1::zeros(py, [rows], false).unbind(),
            counts: flags(),
            terminated: flags(),
            truncated: flags(),
            states: table(truths),
            final_states: table(truths),
        }
    }

    /// Lets `work` write without the interpreter's lock.
    fn write<T: Send>(
        &self,
        py: Python<'_>,
        work: impl FnOnce(Rows<'_>) -> T + Send,
    ) -> PyResult<T> {
        let mut observations = self.observations.bind(py).try_readwrite()?;
        let mut final_observations = self.final_observations.bind(py).try_readwrite()?;
        let mut rewards = self.rewards.bind(py).try_readwrite()?;
        let mut counts = self.counts.bind(py).try_readwrite()?;
        let rows = Rows {
            observations: observations.as_slice_mut()?,
            final_observations: final_observations.as_slice_mut()?,
            rewards: rewards.as_slice_mut()?,
            counts: counts.as_slice_mut()?,
        };
        Ok(py.detach(|| work(rows)))
    }

    /// Records which games ended in the step, and the truth about all games.
    fn end(&self, py: Python<'_>, games: &Games) -> PyResult<()> {
        self.write_states(py, games)?;
        let mut terminated = self.terminated.bind(py).try_readwrite()?;
        let mut truncated = self.truncated.bind(py).try_readwrite()?;
        let terminated = terminated.as_slice_mut()?;
        let truncated = truncated.as_slice_mut()?;
        terminated.fill(false);
        truncated.fill(false);
        let per_game = games.rows().1;
        for one in games.finished() {
            let rows = one.game * per_game..(one.game + 1) * per_game;
            (if one.cut_off {
                &mut truncated[rows]
            } else {
                &mut terminated[rows]
            })
            .fill(true);
        }
        Ok(())
    }

    fn write_states(&self, py: Python<'_>, games: &Games) -> PyResult<()> {
        let numbers = games.setup().truth_size() * games.rows().1;
        if numbers == 0 {
            return Ok(());
        }
        let mut states = self.states.bind(py).try_readwrite()?;
        let mut final_states = self.final_states.bind(py).try_readwrite()?;
        // Boats without actions come last in a game's rows; their states stay 0.
        let write = |rows: &mut [f32], truth: &[f32]| {
            rows[..truth.len()].copy_from_slice(truth);
            rows[truth.len()..].fill(0.0);
        };
        for (game, rows) in states.as_slice_mut()?.chunks_exact_mut(numbers).enumerate() {
            write(rows, games.truth(game).0);
        }
        let final_states = final_states.as_slice_mut()?;
        for one in games.finished() {
            write(
                &mut final_states[one.game * numbers..(one.game + 1) * numbers],
                games.truth(one.game).1,
            );
        }
        Ok(())
    }
}

#[pymethods]
impl VectorEnvironment {
    #[new]
    #[pyo3(signature = (setup, seed, games, threads, record=None))]
    fn new(
        py: Python<'_>,
        setup: Arguments,
        seed: u64,
        games: usize,
        threads: usize,
        record: Option<(PathBuf, u64)>,
    ) -> PyResult<VectorEnvironment> {
        for (name, number, most) in [("games", games, 1_000_000), ("threads", threads, 1024)] {
            if !(1..=most).contains(&number) {
                return Err(refused(format!("{name} is {number}, expected 1 to {most}")));
            }
        }
        let setup = setup.setup()?;
        let recordings = record.as_ref().map(|_| Arc::<RecordingLog>::default());
        if let Some((folder, _)) = &record {
            let wrong = |error: std::io::Error| {
                format!("record is {folder:?}, expected a folder for recordings: {error}")
            };
            check_recording_folder(folder)
                .map_err(wrong)
                .map_err(refused)?;
        }
        let watches = record
            .zip(recordings.clone())
            .map(|((folder, every), log)| {
                let recorded = Recordings {
                    folder,
                    names: RecordingNames::ByTime,
                    every,
                    commit: "unknown".to_owned(),
                };
                recorded.watches(log)
            });
        let begin = || {
            setup
                .check()
                .and_then(|setup| Games::new(setup, games, threads, seed, watches))
        };
        let games = py.detach(begin).map_err(refused)?;
        let arrays = Arrays::new(py, games.rows().0, games.setup());
        let mut environment = VectorEnvironment {
            games: Mutex::new(games),
            actions: Vec::new(),
            arrays,
            recordings,
            process: std::process::id(),
        };
        environment.show(py)?;
        Ok(environment)
    }

    #[pyo3(signature = (actions, restarts=true))]
    fn step(&mut self, py: Python<'_>, actions: &Bound<'_, PyAny>, restarts: bool) -> PyResult<()> {
        self.continue_after_fork()?;
        let VectorEnvironment {
            games,
            actions: read,
            arrays,
            ..
        } = self;
        let games = games.get_mut().unwrap_or_else(PoisonError::into_inner);
        match games.setup().actions() {
            Some(count) => read_discrete(actions, games.rows().0, count, read)?,
            None => read_continuous(actions, games.rows().0, read)?,
        }
        arrays
            .write(py, |rows| games.step(read, restarts, rows))?
            .map_err(refused)?;
        arrays.end(py, games)?;
        self.warn(py)
    }

    #[pyo3(signature = (seed=None))]
    fn restart(&mut self, py: Python<'_>, seed: Option<u64>) -> PyResult<()> {
        self.continue_after_fork()?;
        let games = self.games.get_mut().unwrap_or_else(PoisonError::into_inner);
        py.detach(|| games.restart(seed)).map_err(refused)?;
        self.show(py)?;
        self.warn(py)
    }

    fn restart_games(&mut self, py: Python<'_>, chosen: Vec<(usize, Option<u64>)>) -> PyResult<()> {
        self.continue_after_fork()?;
        let games = self.games.get_mut().unwrap_or_else(PoisonError::into_inner);
        for (game, seed) in chosen {
            check_index(games, game)?;
            py.detach(|| games.restart_game(game, seed))
                .map_err(refused)?;
        }
        self.show(py)?;
        self.warn(py)
    }

    fn end_recordings(&mut self, py: Python<'_>) -> PyResult<()> {
        if self.recordings.is_none() || self.process != std::process::id() {
            return Ok(());
        }
        let games = self.games.get_mut().unwrap_or_else(PoisonError::into_inner);
        py.detach(|| games.end_watches());
        self.warn(py)
    }

    fn take_recording(&self) -> Option<PathBuf> {
        self.recordings.as_ref()?.take_newest()
    }

    #[getter]
    fn rows(&self) -> usize {
        self.games().rows().0
    }

    #[getter]
    fn rows_per_game(&self) -> usize {
        self.games().rows().1
    }

    #[getter]
    fn rows_per_team(&self) -> usize {
        self.games().setup().rows_per_team()
    }

    #[getter]
    fn observation_names(&self) -> Vec<String> {
        self.games().setup().observation_names()
    }

    #[getter]
    fn state_names(&self) -> Vec<String> {
        self.games().setup().truth_names()
    }

    #[getter]
    fn action_count(&self) -> Option<usize> {
        self.games().setup().actions()
    }

    #[getter]
    fn action_names(&self) -> Option<Vec<String>> {
        let games = self.games();
        let setup = games.setup();
        let space = setup.spaces.action;
        let words = || {
            setup
                .actions()
                .map(|count| (0..count).map(|action| space.words(action)).collect())
        };
        setup.options().map(<[String]>::to_vec).or_else(words)
    }

    #[getter]
    fn step_s(&self) -> f64 {
        let games = self.games();
        games.setup().scenario.decision().as_s() * f64::from(games.setup().decisions_per_step)
    }

    #[getter]
    fn boat_names(&self) -> Vec<String> {
        self.games()
            .setup()
            .scenario
            .vehicles
            .iter()
            .map(|vehicle| vehicle.name.clone())
            .collect()
    }

    #[getter]
    fn boat_teams(&self) -> Vec<usize> {
        let games = self.games();
        let vehicles = games.setup().scenario.vehicles.iter();
        vehicles.map(|vehicle| vehicle.team.index()).collect()
    }

    #[getter]
    fn team_names(&self) -> Vec<String> {
        self.games()
            .setup()
            .scenario
            .teams
            .iter()
            .map(|team| team.name.clone())
            .collect()
    }

    fn boats(&self, game: usize) -> PyResult<Vec<Option<usize>>> {
        let games = self.games();
        check_index(&games, game)?;
        let played = games.contest(game).scenario();
        let boats = games.boats(game).iter();
        let index = |boat| games.setup().whole_game_boat(played, boat).index();
        Ok(boats.map(|boat| boat.map(index)).collect())
    }

    fn standing<'py>(&self, py: Python<'py>, game: usize) -> PyResult<Bound<'py, PyDict>> {
        let games = self.games();
        check_index(&games, game)?;
        standing::dict(py, &games.standing(game))
    }

    fn finished<'py>(&self, py: Python<'py>) -> PyResult<Vec<(usize, bool, Bound<'py, PyDict>)>> {
        let games = self.games();
        let one = |one: &learn::environment::Finished| {
            Ok((one.game, one.cut_off, standing::dict(py, &one.standing)?))
        };
        games.finished().iter().map(one).collect()
    }

    fn events(&self, game: usize) -> PyResult<Vec<EventParts>> {
        let games = self.games();
        check_index(&games, game)?;
        let (contest, events) = games.last_step(game);
        let played = contest.scenario();
        let index = |boat| games.setup().whole_game_boat(played, boat).index();
        let parts = |logged: &Logged| {
            let boat = logged.event.vehicle();
            let team = match logged.event {
                Event::Ended { winner } => winner,
                _ => boat.map(|boat| contest.scenario().team_of(boat)),
            };
            (
                logged.event.into(),
                logged.at.as_s(),
                boat.map(index),
                logged.event.other().map(index),
                team.map(|team| team.index()),
            )
        };
        Ok(events.iter().map(parts).collect())
    }

    fn digest(&self, game: usize) -> PyResult<String> {
        let games = self.games();
        check_index(&games, game)?;
        Ok(format!("{:032x}", games.contest(game).digest()))
    }

    fn scene<'py>(&self, py: Python<'py>, game: usize) -> PyResult<Bound<'py, PyDict>> {
        let games = self.games();
        check_index(&games, game)?;
        scene::dict(py, &games, game)
    }

    #[getter]
    fn observations(&self, py: Python<'_>) -> Py<PyArray2<f32>> {
        self.arrays.observations.clone_ref(py)
    }

    #[getter]
    fn final_observations(&self, py: Python<'_>) -> Py<PyArray2<f32>> {
        self.arrays.final_observations.clone_ref(py)
    }

    #[getter]
    fn states(&self, py: Python<'_>) -> Py<PyArray2<f32>> {
        self.arrays.states.clone_ref(py)
    }

    #[getter]
    fn final_states(&self, py: Python<'_>) -> Py<PyArray2<f32>> {
        self.arrays.final_states.clone_ref(py)
    }

    #[getter]
    fn rewards(&self, py: Python<'_>) -> Py<PyArray1<f32>> {
        self.arrays.rewards.clone_ref(py)
    }

    #[getter]
    fn counts(&self, py: Python<'_>) -> Py<PyArray1<bool>> {
        self.arrays.counts.clone_ref(py)
    }

    #[getter]
    fn terminated(&self, py: Python<'_>) -> Py<PyArray1<bool>> {
        self.arrays.terminated.clone_ref(py)
    }

    #[getter]
    fn truncated(&self, py: Python<'_>) -> Py<PyArray1<bool>> {
        self.arrays.truncated.clone_ref(py)
    }
}

impl VectorEnvironment {
    fn games(&self) -> MutexGuard<'_, Games> {
        self.games.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Restarts the threads after a fork.
    fn continue_after_fork(&mut self) -> PyResult<()> {
        if self.process == std::process::id() {
            return Ok(());
        }
        if self.recordings.is_some() {
            return Err(PyRuntimeError::new_err(
                "this environment records its games in the process in which it was created: create another one in \
                this process",
            ));
        }
        let games = self.games.get_mut().unwrap_or_else(PoisonError::into_inner);
        games.continue_after_fork();
        self.process = std::process::id();
        Ok(())
    }

    /// Warns about failed recordings; the games continue.
    fn warn(&self, py: Python<'_>) -> PyResult<()> {
        let Some(recordings) = &self.recordings else {
            return Ok(());
        };
        for problem in recordings.take_problems() {
            // A file name contains no NUL byte.
            let text = CString::new(problem).unwrap_or_default();
            PyErr::warn(py, &py.get_type::<PyRuntimeWarning>(), &text, 2)?;
        }
        Ok(())
    }

    fn show(&mut self, py: Python<'_>) -> PyResult<()> {
        let games = self.games.get_mut().unwrap_or_else(PoisonError::into_inner);
        self.arrays.write(py, |rows| games.show(rows))?;
        self.arrays.end(py, games)
    }
}

impl Drop for VectorEnvironment {
    fn drop(&mut self) {
        if self.process != std::process::id() {
            let games = self.games.get_mut().unwrap_or_else(PoisonError::into_inner);
            games.continue_after_fork();
        }
    }
}

fn check_index(games: &Games, game: usize) -> PyResult<()> {
    let count = games.rows().0 / games.rows().1;
    if game < count {
        return Ok(());
    }
    Err(PyIndexError::new_err(format!(
        "game is {game}, expected 0 to {}",
        count - 1
    )))
}

/// Reads one index per row.
fn read_discrete(
    actions: &Bound<'_, PyAny>,
    rows: usize,
    count: usize,
    into: &mut Vec<Action>,
) -> PyResult<()> {
    let actions: PyReadonlyArray1<'_, i64> = actions.extract().map_err(|_| {
        refused(format!(
            "actions must be an int64 array with the shape ({rows},)"
        ))
    })?;
    check_rows(actions.shape(), &[rows])?;
    into.clear();
    for (row, action) in actions.as_array().iter().enumerate() {
        let action = usize::try_from(*action)
            .ok()
            .filter(|action| *action < count);
        let wrong = || {
            refused(format!(
                "the action in row {row} is {}, expected 0 to {}",
                actions.as_array()[row],
                count - 1
            ))
        };
        into.push(Action::Discrete(action.ok_or_else(wrong)?));
    }
    Ok(())
}

/// Reads two numbers per row.
fn read_continuous(
    actions: &Bound<'_, PyAny>,
    rows: usize,
    into: &mut Vec<Action>,
) -> PyResult<()> {
    let actions: PyReadonlyArray2<'_, f32> = actions.extract().map_err(|_| {
        refused(format!(
            "actions must be a float32 array with the shape ({rows}, 2)"
        ))
    })?;
    check_rows(actions.shape(), &[rows, 2])?;
    into.clear();
    for (row, action) in actions.as_array().outer_iter().enumerate() {
        let action = [action[0], action[1]];
        if !action.iter().all(|number| number.is_finite()) {
            return Err(refused(format!(
                "the action in row {row} is {action:?}, expected two finite numbers"
            )));
        }
        into.push(Action::Continuous(action));
    }
    Ok(())
}

fn check_rows(shape: &[usize], expected: &[usize]) -> PyResult<()> {
    if shape == expected {
        return Ok(());
    }
    Err(refused(format!(
        "actions have the shape {shape:?}, expected {expected:?}"
    )))
}
