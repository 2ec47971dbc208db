//! A game's state of play as named numbers.

use learn::environment::Standing;
use pyo3::prelude::*;
use pyo3::types::PyDict;

/// The numbers of a state of play by name.
pub(crate) fn dict<'py>(py: Python<'py>, standing: &Standing) -> PyResult<Bound<'py, PyDict>> {
    let dict = PyDict::new(py);
    dict.set_item("seed", standing.seed)?;
    dict.set_item("team", standing.side.learner.index())?;
    dict.set_item("opponent", standing.side.opponent)?;
    dict.set_item("steps", standing.steps)?;
    for ((score, counts), prefix) in standing
        .score
        .into_iter()
        .zip(standing.counts)
        .zip(["", "enemy_"])
    {
        let numbers = [
            ("score", score),
            ("grabs", counts.grabs),
            ("captures", counts.captures),
            ("tags", counts.tags),
            ("tagged", counts.tagged),
            ("out_of_bounds", counts.out_of_bounds),
            ("collisions", counts.collisions),
        ];
        for (name, number) in numbers {
            dict.set_item(format!("{prefix}{name}"), number)?;
        }
    }
    Ok(dict)
}
