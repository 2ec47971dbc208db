//! A log of a boat: its commands and its measurements.

use super::rollout::Point;
use crate::{Engine, LONGEST_S, Mistake, Orders, Sheet};
use primitives::SimTime;
use primitives::angle::wrap_pi;
use scenario::boat::{Boat, Drive};

/// Measured channels: name, column, and conversion from the column's unit to SI.
pub(super) const CHANNELS: [(&str, &str, Unit); 6] = [
    ("x", "x_m", Unit::Plain),
    ("y", "y_m", Unit::Plain),
    ("heading", "heading_deg", Unit::Degrees),
    ("surge", "surge_m_s", Unit::Plain),
    ("sway", "sway_m_s", Unit::Plain),
    ("yaw rate", "yaw_rate_deg_s", Unit::Degrees),
];
/// Indices of the channels.
pub(super) const X: usize = 0;
pub(super) const HEADING: usize = 2;
pub(super) const SURGE: usize = 3;
pub(super) const SWAY: usize = 4;
pub(super) const YAW_RATE: usize = 5;

/// The unit of a column.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Unit {
    /// Already in SI.
    Plain,
    /// Degrees, or degrees per second.
    Degrees,
}

/// A log, prepared for comparison with a model.
#[derive(Clone, Debug)]
pub struct Log {
    pub(super) times: Vec<SimTime>,
    /// x east, y north, heading (unwrapped), surge, sway, yaw rate; NaN for missing measurements.
    pub(super) measured: Vec<[f64; 6]>,
    pub(super) orders: Orders,
    /// The row after the end of each appended log, and of each part of a log with gaps.
    ends: Vec<usize>,
}

/// Time without a row after which a new segment begins, s, because the commands and the motion in
/// the gap are unknown.
const GAP_MAX_S: f64 = 5.0;
/// Minimum number of rows for a fit.
const ROWS_MIN: usize = 20;

impl Log {
    /// Reads a log from a sheet: `t_s`, commands for the thrusters, and at least the trial columns
    /// `heading_deg`, `surge_m_s` and `yaw_rate_deg_s`. An empty cell, NaN or N/A is a missing
    /// measurement. Times are relative to the first row.
    ///
    /// # Errors
    /// If columns are missing or a cell is not a number.
    pub fn of_sheet(sheet: &Sheet, boat: &Boat) -> Result<Log, Mistake> {
        if matches!(boat.drive, Drive::Kinematic(_)) {
            return Err(sheet.mistake(
                None,
                format!("{} is kinematic and has no hull to identify", boat.name),
            ));
        }
        let times_s = sheet.times_from_first(LONGEST_S)?;
        let orders = Orders::at_times(sheet, &times_s, &Engine::new(boat))?;
        let columns = CHANNELS.map(|(_, head, _)| sheet.column(head));
        for needed in [HEADING, SURGE, YAW_RATE] {
            if columns[needed].is_none() {
                let message = format!(
                    "missing column {}; columns found: {}",
                    CHANNELS[needed].1,
                    sheet.heads().join(", ")
                );
                return Err(sheet.mistake(Some(1), message));
            }
        }
        if columns[0].is_some() != columns[1].is_some() {
            return Err(sheet.mistake(
                Some(1),
                "only one of the columns x_m and y_m, expected both or neither".to_owned(),
            ));
        }
        if times_s.len() < ROWS_MIN {
            return Err(sheet.mistake(
                None,
                format!("{} rows, expected at least {ROWS_MIN}", times_s.len()),
            ));
        }
        let mut measured = Vec::with_capacity(times_s.len());
        for row in 0..times_s.len() {
            let mut cells = [f64::NAN; 6];
            for (channel, column) in columns.iter().enumerate() {
                cells[channel] = column.map_or(Ok(f64::NAN), |column| {
                    cell(sheet, row, column, CHANNELS[channel].2)
                })?;
            }
            measured.push(cells);
        }
        unwrap_headings(&mut measured);
        let mut steps_s: Vec<f64> = times_s.windows(2).map(|pair| pair[1] - pair[0]).collect();
        let is_gap = |step_s: f64, usual_s: f64| step_s > f64::max(GAP_MAX_S, 3.0 * usual_s);
        steps_s.sort_by(f64::total_cmp);
        let usual_s = steps_s[steps_s.len() / 2];
        let gaps =
            (1..times_s.len()).filter(|row| is_gap(times_s[*row] - times_s[row - 1], usual_s));
        Ok(Log {
            ends: gaps.chain([measured.len()]).collect(),
            times: times_s.into_iter().map(SimTime::from_s).collect(),
            measured,
            orders,
        })
    }

    /// Appends another log of the boat, after a pause that is longer than a segment, so that the
    /// next segment begins with it.
    pub fn append(&mut self, other: &Log, segment: SimTime) {
        let end = *self.times.last().unwrap_or(&SimTime::ZERO);
        let shift = end + segment + SimTime::from_s(1.0);
        self.times.extend(other.times.iter().map(|at| *at + shift));
        let rows = self.measured.len();
        self.ends.extend(other.ends.iter().map(|end| rows + end));
        self.measured.extend_from_slice(&other.measured);
        self.orders.append(&other.orders, shift);
    }

    /// The measured state at a row; missing measurements are zero.
    pub(super) fn start(&self, row: usize) -> Point {
        self.measured[row].map(|cell| if cell.is_finite() { cell } else { 0.0 })
    }

    fn are_of_one_log(&self, a: usize, b: usize) -> bool {
        let log_of = |row: usize| self.ends.partition_point(|end| *end <= row);
        log_of(a) == log_of(b)
    }

    /// The first rows of segments: each is the first row at least `segment` after the previous one
    /// that has all measurements needed for a start. The last entry is the end of the last segment.
    pub(super) fn segments(&self, segment: SimTime) -> Vec<usize> {
        let has_sway = self.measured.iter().any(|cells| cells[SWAY].is_finite());
        let has_place = self.measured.iter().any(|cells| cells[X].is_finite());
        let is_start = |cells: &[f64; 6]| {
            let needed = [(X, has_place), (X + 1, has_place), (SWAY, has_sway)];
            let always = [HEADING, SURGE, YAW_RATE]
                .iter()
                .all(|channel| cells[*channel].is_finite());
            always
                && needed
                    .iter()
                    .all(|(channel, needed)| !needed || cells[*channel].is_finite())
        };
        let mut starts: Vec<usize> = vec![];
        for (row, cells) in self.measured.iter().enumerate() {
            let due = starts
                .last()
                .is_none_or(|last| self.times[row] - self.times[*last] >= segment);
            // A remainder shorter than half a segment is added to the previous segment.
            let end = self.ends[self.ends.partition_point(|end| *end <= row)];
            let left = self.times[end - 1] - self.times[row];
            let is_first = starts
                .last()
                .is_none_or(|last| !self.are_of_one_log(*last, row));
            if is_start(cells) && (is_first || due && left.0 * 2 >= segment.0) {
                starts.push(row);
            }
        }
        starts.push(self.measured.len());
        starts
    }
}

/// A measurement in SI; NaN if missing.
fn cell(sheet: &Sheet, row: usize, column: usize, unit: Unit) -> Result<f64, Mistake> {
    if sheet.is_missing(row, column) {
        return Ok(f64::NAN);
    }
    let number = sheet.number(row, column, (-1e7, 1e7))?;
    Ok(if unit == Unit::Degrees {
        number.to_radians()
    } else {
        number
    })
}

/// Unwraps headings: removes jumps of a whole turn.
fn unwrap_headings(measured: &mut [[f64; 6]]) {
    let mut before: Option<f64> = None;
    for cells in measured
        .iter_mut()
        .filter(|cells| cells[HEADING].is_finite())
    {
        cells[HEADING] = before.map_or(cells[HEADING], |before| {
            before + wrap_pi(cells[HEADING] - before)
        });
        before = Some(cells[HEADING]);
    }
}
