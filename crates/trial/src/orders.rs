//! A series of commands: recorded in the field, or written by a user.

use super::command::{Command, Engine, Pair};
use super::sheet::{Mistake, Sheet};
use primitives::SimTime;

/// The longest trial (a day), s. Times are relative to the start of the trial.
pub const LONGEST_S: f64 = 86_400.0;

/// Commands, each in force until the time of the next.
#[derive(Clone, Debug, PartialEq)]
pub struct Orders {
    /// Ascending times, each with its command.
    steps: Vec<(SimTime, Command)>,
}

impl Orders {
    /// Reads the commands of a sheet for a boat with this engine. Other columns are ignored.
    ///
    /// # Errors
    /// If the columns are missing or ambiguous, the boat does not accept them, or a number is out
    /// of its range.
    pub fn of_sheet(sheet: &Sheet, engine: &Engine) -> Result<Orders, Mistake> {
        Orders::at_times(sheet, &sheet.times(LONGEST_S)?, engine)
    }

    /// Like [`Orders::of_sheet`], with the times of the rows.
    pub(crate) fn at_times(
        sheet: &Sheet,
        times_s: &[f64],
        engine: &Engine,
    ) -> Result<Orders, Mistake> {
        let (pair, columns) = pair_of(sheet)?;
        let ranges = engine.ranges(pair).map_err(|lack| {
            sheet.mistake(
                Some(1),
                format!("columns {}: {lack}", pair.columns().join(",")),
            )
        })?;
        let mut steps = Vec::with_capacity(times_s.len());
        for (row, t_s) in times_s.iter().enumerate() {
            let a = sheet.number(row, columns[0], ranges[0])?;
            let b = sheet.number(row, columns[1], ranges[1])?;
            steps.push((SimTime::from_s(*t_s), engine.command(pair, [a, b])));
        }
        Ok(Orders { steps })
    }

    /// Appends other commands, this much later.
    pub(crate) fn append(&mut self, other: &Orders, shift: SimTime) {
        let later = other
            .steps
            .iter()
            .map(|(at, command)| (*at + shift, *command));
        self.steps.extend(later);
    }

    /// The time of the last command.
    pub fn end(&self) -> SimTime {
        self.steps.last().map_or(SimTime::ZERO, |(at, _)| *at)
    }

    /// The last command at or before `now`; before the first command, a hold.
    pub fn at(&self, now: SimTime) -> Command {
        let passed = self.steps.partition_point(|(at, _)| *at <= now);
        passed
            .checked_sub(1)
            .map_or(Command::Hold, |last| self.steps[last].1)
    }
}

/// The pair of command columns and their indices. In a trial's own file,
/// `port_newton,starboard_newton` are actual thrusts, not commands; such a file also has a
/// different pair.
fn pair_of(sheet: &Sheet) -> Result<(Pair, [usize; 2]), Mistake> {
    let place = |head: &str| {
        // The heading in a trial's own file is the actual one; the ordered heading has its own
        // column.
        let told = if head == "heading_deg" {
            sheet.column("heading_order_deg")
        } else {
            None
        };
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
                let message = format!(
                    "found column {} without {}, expected both",
                    pair.columns()[here],
                    pair.columns()[gone]
                );
                return Err(sheet.mistake(Some(1), message));
            }
        }
    }
    if found.len() > 1 {
        found.retain(|(pair, _)| *pair != Pair::Newton);
    }
    let names = |pairs: &[Pair]| {
        pairs
            .iter()
            .map(|pair| pair.columns().join(","))
            .collect::<Vec<_>>()
            .join("; ")
    };
    match found[..] {
        [one] => Ok(one),
        [] => {
            let message = format!(
                "no command columns among {}, expected one of {}",
                sheet.heads().join(", "),
                names(&Pair::ALL)
            );
            Err(sheet.mistake(Some(1), message))
        }
        _ => {
            let pairs: Vec<Pair> = found.iter().map(|(pair, _)| *pair).collect();
            Err(sheet.mistake(
                Some(1),
                format!("several kinds of commands: {}; expected one", names(&pairs)),
            ))
        }
    }
}
