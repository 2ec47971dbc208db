//! A series of commands: what was recorded in the field, or what somebody wants to see.

use super::command::{Command, Engine, Pair};
use super::sheet::{Mistake, Sheet};
use primitives::SimTime;

/// The longest trial, s: a day. Times count from the start of the trial.
pub const LONGEST_S: f64 = 86_400.0;

/// Commands, each of which holds from its time until the next one's.
#[derive(Clone, Debug, PartialEq)]
pub struct Orders {
    /// Rising times, and what is commanded from then on.
    steps: Vec<(SimTime, Command)>,
}

impl Orders {
    /// The commands in a sheet, for a boat with this engine. Columns that are no commands are ignored.
    ///
    /// # Errors
    /// Where the columns are missing or ambiguous, the boat does not understand them, or a number is beyond what it can
    /// do.
    pub fn of_sheet(sheet: &Sheet, engine: &Engine) -> Result<Orders, Mistake> {
        let times_s = sheet.times(LONGEST_S)?;
        let (pair, columns) = pair_of(sheet)?;
        let ranges = engine
            .ranges(pair)
            .map_err(|lack| sheet.mistake(Some(1), format!("columns {}: {lack}", pair.columns().join(","))))?;
        let mut steps = Vec::with_capacity(times_s.len());
        for (row, t_s) in times_s.into_iter().enumerate() {
            let a = sheet.number(row, columns[0], ranges[0])?;
            let b = sheet.number(row, columns[1], ranges[1])?;
            steps.push((SimTime::from_s(t_s), engine.command(pair, [a, b])));
        }
        Ok(Orders { steps })
    }

    /// The time of the last command.
    #[must_use]
    pub fn end(&self) -> SimTime {
        self.steps.last().map_or(SimTime::ZERO, |(at, _)| *at)
    }

    /// What is commanded at `now`: the last command that is not later; before the first, nothing.
    #[must_use]
    pub fn at(&self, now: SimTime) -> Command {
        let passed = self.steps.partition_point(|(at, _)| *at <= now);
        passed.checked_sub(1).map_or(Command::Hold, |last| self.steps[last].1)
    }
}

/// Which commands the columns are, and their places. Beside another pair `port_newton,starboard_newton` are the thrusts
/// that were had, not those that were wanted: a trial's own file has them.
fn pair_of(sheet: &Sheet) -> Result<(Pair, [usize; 2]), Mistake> {
    let place = |head: &str| {
        // The heading in a trial's own file is the one it had; the one it was told has a name of its own.
        let told = if head == "heading_deg" { sheet.column("heading_order_deg") } else { None };
        told.or_else(|| sheet.column(head))
    };
    let mut found = vec![];
    for pair in Pair::ALL {
        match pair.columns().map(place) {
            [Some(a), Some(b)] => found.push((pair, [a, b])),
            // A heading alone is a measurement.
            [None, None] => {}
            [None, Some(_)] if pair == Pair::SpeedHeading => {}
            places => {
                let (here, gone) = if places[0].is_some() { (0, 1) } else { (1, 0) };
                let message = format!("column {} without {}", pair.columns()[here], pair.columns()[gone]);
                return Err(sheet.mistake(Some(1), message));
            }
        }
    }
    if found.len() > 1 {
        found.retain(|(pair, _)| *pair != Pair::Newton);
    }
    let names = |pairs: &[Pair]| pairs.iter().map(|pair| pair.columns().join(",")).collect::<Vec<_>>().join("; ");
    match found[..] {
        [one] => Ok(one),
        [] => {
            let message = format!(
                "no columns of commands among {}, expected one of {}",
                sheet.heads().join(", "),
                names(&Pair::ALL)
            );
            Err(sheet.mistake(Some(1), message))
        }
        _ => {
            let pairs: Vec<Pair> = found.iter().map(|(pair, _)| *pair).collect();
            Err(sheet.mistake(Some(1), format!("several kinds of commands: {}; expected one", names(&pairs))))
        }
    }
}
