//! The gap between a boat and its model: where the measured motion lies among simulated runs under
//! the same commands, and which number of the boat file, if changed, would close it.
//!
//! Every run restarts from the log at the beginning of each segment, with its own sea and sensor
//! errors. If the model is sound, every rank of the boat among the runs is therefore equally
//! probable (a rank histogram, Hamill 2001).

use super::fit::{Estimate, Fit, NoFit, Quality, fit, problem, promises, qualities, student_975};
use super::log::{HEADING, Log, SURGE, SWAY, X, YAW_RATE};
use super::rollout::{Point, Setting, View, rollout};
use primitives::math;
use scenario::boat::Boat;

/// The turn whose duration is compared, degrees.
pub const TURN_DEG: f64 = 45.0;
/// Time after a restart that is not compared, s: receivers still report the position from before
/// it.
const SETTLE_S: f64 = 1.0;
/// Maximum number of compared rows: a longer log is thinned.
const ROWS_MAX: usize = 20_000;
/// Speed ahead below which sideslip is undefined, m/s.
const SLIP_M_S: f64 = 0.3;
/// The quantiles that bound the central 95 %.
const TAILS: [f64; 2] = [0.025, 0.975];
/// Number of parameters to fit: the most promising ones.
const CANDIDATES: usize = 3;

/// The compared quantities: name and unit.
pub const QUANTITIES: [(&str, &str); 6] = [
    ("speed", "m/s"),
    ("yaw rate", "°/s"),
    ("sideslip", "°"),
    ("heading", "°"),
    ("distance ahead", "m"),
    ("distance abeam", "m"),
];

/// A log as it is compared: its segments, and the rows of each.
#[derive(Clone, Debug)]
pub struct Frames<'a> {
    log: &'a Log,
    segments: Vec<usize>,
    rows: Vec<Row>,
}

#[derive(Clone, Copy, Debug)]
struct Row {
    at: usize,
    segment: usize,
}

/// The values of a run, or of the boat, at the compared rows: as in [`QUANTITIES`].
type Values = Vec<[f32; 6]>;

/// A simulated run at the compared rows.
#[derive(Clone, Debug)]
pub struct Run {
    values: Values,
    /// The duration of the turn in each segment, s; that of the whole segment if there is no turn.
    turns_s: Vec<f64>,
}

/// Where a measured quantity lies among the runs.
#[derive(Clone, Debug)]
pub struct Place {
    /// Its name.
    pub name: String,
    /// Its unit.
    pub unit: &'static str,
    /// Mean difference between the measurement and the runs' median.
    pub off: f64,
    /// Half-width of that difference's 95 % interval, from the variation between segments; infinite
    /// for one segment.
    pub plus_minus: f64,
    /// Half the mean width of the runs' central 95 %.
    pub spread: f64,
    /// Fraction of the measurements within the runs' central 95 %.
    pub inside: f64,
    /// Mean fraction of the runs below the measurement.
    pub rank: f64,
}

/// A quantity over time: time (s), measurement, and the runs' 2.5 %, 50 % and 97.5 % quantiles;
/// NaN where a segment begins.
pub type Band = Vec<(f64, [f64; 4])>;

/// The comparison of a log with simulated runs.
#[derive(Clone, Debug)]
pub struct Gap {
    /// Each quantity that the log contains.
    pub places: Vec<Place>,
    /// The bands of the same quantities, in the same order; none for times of turns.
    pub bands: Vec<(&'static str, &'static str, Band)>,
    /// The number of segments.
    pub segments: usize,
}

impl<'a> Frames<'a> {
    /// The segments of a log, each of this length.
    ///
    /// # Errors
    /// [`NoFit::NoStart`] if there are none.
    pub fn new(log: &'a Log, setting: &Setting) -> Result<Frames<'a>, NoFit> {
        let segments = log.segments(setting.segment);
        let mut rows = vec![];
        for (segment, border) in segments.windows(2).enumerate() {
            let start = log.times[border[0]];
            let is_settled = |at: &usize| (log.times[*at] - start).as_s() >= SETTLE_S;
            let settled = (border[0]..border[1]).filter(is_settled);
            rows.extend(settled.map(|at| Row { at, segment }));
        }
        if rows.is_empty() {
            return Err(NoFit::NoStart);
        }
        let every = rows.len().div_ceil(ROWS_MAX);
        Ok(Frames {
            log,
            segments,
            rows: rows.into_iter().step_by(every).collect(),
        })
    }

    /// A run of this boat, as its sensors see it; `None` if its state becomes non-finite.
    pub fn run(&self, boat: &Boat, setting: &Setting) -> Option<Run> {
        let firsts = &self.segments[..self.segments.len() - 1];
        let starts: Vec<Point> = firsts.iter().map(|row| self.log.start(*row)).collect();
        let view = View::Sensors;
        let points = rollout(boat, setting, self.log, (&self.segments, &starts), view)?;
        Some(self.of(&points))
    }

    fn of(&self, points: &[Point]) -> Run {
        let value = |row: &Row| {
            let first = self.segments[row.segment];
            values(&self.log.start(first), &points[row.at]).map(|value| value as f32)
        };
        let turn = |border: &[usize]| {
            let start_s = self.log.times[border[0]].as_s();
            let turned = |at: &usize| {
                let turned_rad = points[*at][HEADING] - self.log.measured[border[0]][HEADING];
                turned_rad.to_degrees().abs() >= TURN_DEG
            };
            let at = (border[0]..border[1]).find(turned).unwrap_or(border[1] - 1);
            self.log.times[at].as_s() - start_s
        };
        Run {
            values: self.rows.iter().map(value).collect(),
            turns_s: self.segments.windows(2).map(turn).collect(),
        }
    }

    /// Compares the log with runs.
    pub fn compare(&self, runs: &[Run]) -> Gap {
        let real = self.of(&self.log.measured);
        let mut gap = Gap {
            places: vec![],
            bands: vec![],
            segments: self.segments.len() - 1,
        };
        for (quantity, (name, unit)) in QUANTITIES.into_iter().enumerate() {
            let mut ranking = Ranking::new(gap.segments);
            let mut band = Band::new();
            for (i, row) in self.rows.iter().enumerate() {
                if i > 0 && self.rows[i - 1].segment != row.segment {
                    band.push((f64::NAN, [f64::NAN; 4]));
                }
                let real = f64::from(real.values[i][quantity]);
                let simulated = runs.iter().map(|run| f64::from(run.values[i][quantity]));
                if let Some(limits) = ranking.add(row.segment, real, simulated.collect()) {
                    let [low, middle, high] = limits;
                    let at_s = self.log.times[row.at].as_s();
                    band.push((at_s, [real, low, middle, high]));
                }
            }
            if let Some(place) = ranking.place(name, unit) {
                gap.places.push(place);
                gap.bands.push((name, unit, band));
            }
        }
        let mut ranking = Ranking::new(gap.segments);
        let mut turns = 0;
        for (segment, border) in self.segments.windows(2).enumerate() {
            let whole = self.log.times[border[1] - 1] - self.log.times[border[0]];
            let real_s = real.turns_s[segment];
            if real_s < whole.as_s() {
                turns += 1;
                let simulated = runs.iter().map(|run| run.turns_s[segment]);
                ranking.add(segment, real_s, simulated.collect());
            }
        }
        let name = format!("time to turn {TURN_DEG}° ({turns})");
        gap.places.extend(ranking.place(&name, "s"));
        gap
    }
}

/// The compared values of a state; distances are along and across the heading at the start.
fn values(start: &Point, point: &Point) -> [f64; 6] {
    let speed_m_s = math::length(point[SURGE], point[SWAY]);
    let slip_rad = if point[SURGE] > SLIP_M_S {
        math::atan2(point[SWAY], point[SURGE])
    } else {
        f64::NAN
    };
    let (sin, cos) = math::sin_cos(start[HEADING]);
    let [east, north] = [point[X] - start[X], point[X + 1] - start[X + 1]];
    [
        speed_m_s,
        point[YAW_RATE].to_degrees(),
        slip_rad.to_degrees(),
        (point[HEADING] - start[HEADING]).to_degrees(),
        north * cos + east * sin,
        east * cos - north * sin,
    ]
}

/// Collects where measurements lie among runs.
struct Ranking {
    /// By segment: the sum of differences and their number.
    offs: Vec<(f64, usize)>,
    inside: usize,
    ranks: f64,
    widths: f64,
}

impl Ranking {
    fn new(segments: usize) -> Ranking {
        Ranking {
            offs: vec![(0.0, 0); segments],
            inside: 0,
            ranks: 0.0,
            widths: 0.0,
        }
    }

    /// Adds a measurement if it and the runs have a value; returns the runs' quantiles.
    fn add(&mut self, segment: usize, real: f64, mut simulated: Vec<f64>) -> Option<[f64; 3]> {
        simulated.retain(|value| value.is_finite());
        if simulated.is_empty() || !real.is_finite() {
            return None;
        }
        simulated.sort_by(f64::total_cmp);
        let quantile = |share: f64| {
            let at = share * (simulated.len() - 1) as f64;
            let (low, high) = (simulated[at as usize], simulated[at.ceil() as usize]);
            low + (high - low) * at.fract()
        };
        let limits = [quantile(TAILS[0]), quantile(0.5), quantile(TAILS[1])];
        let [low, middle, high] = limits;
        let (sum, count) = &mut self.offs[segment];
        *sum += real - middle;
        *count += 1;
        self.inside += usize::from((low..=high).contains(&real));
        let below = simulated.partition_point(|value| *value < real);
        let up_to = simulated.partition_point(|value| *value <= real);
        self.ranks += 0.5 * (below + up_to) as f64 / simulated.len() as f64;
        self.widths += high - low;
        Some(limits)
    }

    fn place(&self, name: &str, unit: &'static str) -> Option<Place> {
        let means: Vec<f64> = self
            .offs
            .iter()
            .filter(|(_, count)| *count > 0)
            .map(|(sum, count)| sum / *count as f64)
            .collect();
        if means.is_empty() {
            return None;
        }
        let count = self.offs.iter().map(|(_, count)| count).sum::<usize>() as f64;
        let segments = means.len() as f64;
        let off = means.iter().sum::<f64>() / segments;
        let squares: f64 = means.iter().map(|mean| (mean - off) * (mean - off)).sum();
        let deviation = (squares / f64::max(segments - 1.0, 1.0) / segments).sqrt();
        let interval = student_975(means.len()) * deviation;
        Some(Place {
            name: name.to_owned(),
            unit,
            off,
            plus_minus: if means.len() > 1 {
                interval
            } else {
                f64::INFINITY
            },
            spread: 0.5 * self.widths / count,
            inside: self.inside as f64 / count,
            rank: self.ranks / count,
        })
    }
}

/// A change of one number of the boat file.
#[derive(Clone, Copy, Debug)]
pub struct Change {
    /// The number, with the value for which the boat fits the log best.
    pub estimate: Estimate,
    /// Fraction of the squared residuals that the change removes.
    pub explains: f64,
}

/// The numbers of the boat file that, changed one at a time, would bring the model closest to the
/// log, best first. Only changes larger than their intervals are included.
///
/// # Errors
/// [`NoFit`] if the boat cannot be simulated.
pub fn changes(boat: &Boat, log: &Log, setting: &Setting) -> Result<Vec<Change>, NoFit> {
    let parameters = super::parameters(&[], boat)?;
    let mut model = problem(boat, log, setting, &parameters, &|_| {})?;
    let mut promising: Vec<(f64, usize)> = promises(&mut model)?.into_iter().zip(0..).collect();
    let before = qualities(&model);
    promising.sort_by(|a, b| b.0.total_cmp(&a.0));
    let left = |qualities: &[Quality]| {
        let ratio = |(after, before): (&Quality, &Quality)| {
            (after.rms * after.rms) / (before.rms * before.rms)
        };
        qualities.iter().zip(&before).map(ratio).sum::<f64>() / qualities.len() as f64
    };
    let mut changes = vec![];
    for (_, i) in promising.into_iter().take(CANDIDATES) {
        let Ok(Fit {
            estimates,
            qualities,
            ..
        }) = fit(boat, log, setting, &parameters[i..=i], &|_| {})
        else {
            continue;
        };
        let estimate = estimates[0];
        if (estimate.value - estimate.before).abs() > estimate.plus_minus {
            let explains = 1.0 - left(&qualities);
            changes.push(Change { estimate, explains });
        }
    }
    changes.retain(|change| change.explains > 0.0);
    changes.sort_by(|a, b| b.explains.total_cmp(&a.explains));
    Ok(changes)
}
