//! How much sea, noise and failure a team stands: the same games at many points of a space of scenarios.
//!
//! A [`Plan`] says which games a sweep file means. [`play()`] plays any stretch of them, in this process, on several threads, in order, and gives a
//! [`Row`] of each.
//! A [`Study`] keeps what came of them in a folder and is taken up again from it; [`Report`] is what all of it says. Everything
//! depends on the plan alone: not on the number of threads, not on who played which games, not on when it was stopped.

mod axis;
mod condition;
mod effects;
mod file;
mod find;
mod html;
mod journal;
mod metric;
mod plan;
mod play;
mod report;
mod study;
mod table;
mod text;
mod until;

pub use axis::{Axis, AxisValue};
pub use condition::{Condition, ConditionError};
pub use effects::{Effect, Interaction, Level};
pub use file::{Design, Sweep};
pub use find::{FindError, Found, find};
pub use html::served;
pub use journal::Journal;
pub use metric::{METRICS, Metric, Metrics, TeamMetrics};
pub use plan::{Job, Plan, Point};
pub use play::{BoatRow, Played, play};
pub use report::{Difference, EntryAtPoint, Failure, PointReport, Report, Worst};
pub use study::{GAMES, PACKED_PLAN, Study, StudyError, lines, rows_in};
pub use table::Row;
pub use text::{found_text, text};
pub use until::{BreakingPoint, Tried, UntilError, breaking_point};
