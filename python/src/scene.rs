//! A game seen from above, for images: the truth along and across the field.

use learn::environment::Games;
use numpy::PyArray2;
use pyo3::prelude::*;
use pyo3::types::PyDict;

/// The scene of a game. Positions are in metres along the field from the first team's end, and
/// across it to that team's port side. Angles are in rad, anticlockwise from the direction along
/// the field.
pub(crate) fn dict<'py>(
    py: Python<'py>,
    games: &Games,
    game: usize,
) -> PyResult<Bound<'py, PyDict>> {
    let (contest, _) = games.last_step(game);
    let scenario = contest.scenario();
    let field = &scenario.field;
    let frame = contest.frame(&mut Default::default());
    let along_rad = field.plan.along_deg.to_radians();
    let boats: Vec<Vec<f64>> = frame
        .vehicles
        .iter()
        .zip(&scenario.vehicles)
        .map(|(truth, vehicle)| {
            let (along_m, across_m) = field.along_across(truth.nav.at());
            let [tagged, carrying] =
                [truth.tagged, truth.carrying >= 0].map(|is| f64::from(u8::from(is)));
            vec![
                along_m,
                across_m,
                along_rad - truth.nav.psi_rad,
                vehicle.team.index() as f64,
                tagged,
                carrying,
            ]
        })
        .collect();
    let flags = field.flags.iter().zip(&frame.flags).map(|(flag, view)| {
        let (along_m, across_m) = field.along_across(flag.home(contest.now()));
        vec![
            along_m,
            across_m,
            flag.team.index() as f64,
            f64::from(view.carrier),
        ]
    });
    let dict = PyDict::new(py);
    dict.set_item("width_m", field.plan.width_m)?;
    dict.set_item("depth_m", field.plan.depth_m)?;
    dict.set_item("boats", PyArray2::from_vec2(py, &boats)?)?;
    dict.set_item(
        "flags",
        PyArray2::from_vec2(py, &flags.collect::<Vec<_>>())?,
    )?;
    dict.set_item("score", contest.score().to_vec())?;
    dict.set_item("time_s", contest.now().as_s())?;
    Ok(dict)
}
