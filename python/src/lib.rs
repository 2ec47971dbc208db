//! The native module of the Python package `squall`: games as environments with shared arrays,
//! sweeps and tournaments.

mod arguments;
mod environment;
mod scene;
mod signals;
mod standing;
mod sweep;
mod tournament;

use pyo3::prelude::*;

/// `squall._native`, which is private: use `squall`.
#[pymodule]
fn _native(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add("__version__", env!("CARGO_PKG_VERSION"))?;
    module.add_class::<environment::VectorEnvironment>()?;
    module.add_class::<sweep::SweepPlan>()?;
    module.add_class::<sweep::SweepStudy>()?;
    module.add_class::<tournament::TournamentPlan>()
}
