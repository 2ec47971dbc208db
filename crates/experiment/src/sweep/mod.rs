//! Sweeps measure how much sea, noise and failure a team tolerates: the same games at many points
//! of a space of scenarios.
//!
//! A [`Plan`] lists the games of a sweep file. [`play()`] plays any range of them in this process,
//! on several threads, and returns a [`Row`] for each, in order. A [`Study`] stores the results in
//! a folder and can be resumed; a [`Report`] summarises them. Results depend only on the plan, not
//! on the number of threads, the machines that played the games, or interruptions.

mod axis;
mod effects;
mod file;
mod metric;
mod plan;
mod play;
mod report;
mod study;
mod table;
mod text;

pub use axis::{Axis, AxisValue};
pub use effects::{Effect, Interaction, Level};
pub use file::{Design, Sweep};
pub use metric::{METRICS, Metric, Metrics};
pub use plan::{Job, Plan, Point};
pub use play::{BoatRow, Played, play};
pub use report::{Difference, EntryAtPoint, Failure, PointReport, Report, Worst};
pub use study::{GAMES, PACKED_PLAN, Study, StudyError, lines, rows_in};
pub use table::Row;
pub use text::text;
