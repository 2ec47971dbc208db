//! Searches for the parameters that best fit a log, and estimates their uncertainty.

use super::log::{CHANNELS, Log, Unit};
use super::parameter::{CURRENT, Knob, Model, PARAMETERS, Parameter, WIND};
use super::problem::{Problem, set_wind};
use super::rollout::Setting;
use levenberg_marquardt::{LeastSquaresProblem, LevenbergMarquardt};
use nalgebra::{DMatrix, DVector};
use primitives::Ned;
use primitives::angle::compass_deg_from_rad;
use scenario::boat::Boat;
use scenario::sea::Sea;
use statrs::distribution::{ContinuousCDF, StudentsT};
use std::cell::Cell;
use std::f64::consts::PI;
use thiserror::Error;

/// A fitted parameter.
#[derive(Clone, Copy, Debug)]
pub struct Estimate {
    /// The parameter.
    pub parameter: Parameter,
    /// Its value in the initial boat.
    pub before: f64,
    /// Its fitted value.
    pub value: f64,
    /// Half-width of the 95 % confidence interval, assuming that the errors of different segments
    /// are independent.
    pub plus_minus: f64,
}

/// The quality of the fit of a channel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Quality {
    /// Its name.
    pub channel: &'static str,
    /// Its unit.
    pub unit: &'static str,
    /// Root mean square of the residuals.
    pub rms: f64,
    /// Fraction of the measurements' variance that the model explains.
    pub r_squared: f64,
}

/// Two parameters that the log cannot separate.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Confused {
    /// Their names.
    pub names: [&'static str; 2],
    /// Their correlation.
    pub correlation: f64,
}

/// The fit of a boat to a log.
#[derive(Clone, Debug)]
pub struct Fit {
    /// The boat with the fitted parameters.
    pub boat: Boat,
    /// The estimated parameters.
    pub estimates: Vec<Estimate>,
    /// The quality of each channel.
    pub qualities: Vec<Quality>,
    /// Pairs of strongly correlated parameters.
    pub confused: Vec<Confused>,
    /// The number of segments.
    pub segments: usize,
    /// The number of measured values.
    pub measured: usize,
}

impl Fit {
    /// The fitted mean current: its speed (m/s) and the direction in which it flows (compass
    /// degrees); `None` if it was not fitted.
    pub fn current(&self) -> Option<(f64, f64)> {
        let (current, _) = self.vector(CURRENT)?;
        Some((
            current.length(),
            compass_deg_from_rad(current.direction_rad()),
        ))
    }

    /// The fitted mean wind 10 m above the water: its speed (m/s) and the direction from which it
    /// blows (compass degrees); `None` if it was not fitted.
    pub fn wind(&self) -> Option<(f64, f64)> {
        let (wind, _) = self.vector(WIND)?;
        Some((
            wind.length(),
            compass_deg_from_rad(wind.direction_rad() + PI),
        ))
    }

    /// A vector of the water, and the larger half-width of its two intervals.
    fn vector(&self, names: [&str; 2]) -> Option<(Ned, f64)> {
        let of = |name| {
            let mut all = self.estimates.iter();
            all.find(|estimate| estimate.parameter.name == name)
        };
        let (east, north) = (of(names[0])?, of(names[1])?);
        let vector = Ned {
            east: east.value,
            north: north.value,
        };
        Some((vector, east.plus_minus.max(north.plus_minus)))
    }

    /// Product of the residuals of all channels: the smaller, the better the fit.
    fn misfit(&self) -> f64 {
        self.qualities.iter().map(|quality| quality.rms).product()
    }
}

/// Why there is no fit.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum NoFit {
    /// A parameter name is unknown.
    #[error("{0} is not a parameter, expected one or more of {list}", list = names().join(", "))]
    Unknown(String),
    /// The boat has no such parameter.
    #[error("the boat has no parameter {0}")]
    NotThere(&'static str),
    /// There are no parameters to fit.
    #[error("no parameters to fit")]
    Nothing,
    /// There is no row at which a segment could begin.
    #[error("no row of the log has a value for every measured channel")]
    NoStart,
    /// The search did not converge.
    #[error("the search failed: {0}")]
    Search(String),
    /// Several winds explain the log.
    #[error(
        "the log does not determine the wind: {0} explain the log equally well; pass a sea file with the wind to --sea"
    )]
    Ambiguous(String),
    /// The log does not determine some parameters.
    #[error("the log does not determine {0}; omit some of them with --fit, or record more data")]
    Undetermined(String),
}

/// Correlation above which a warning is given.
const CONFUSED: f64 = 0.95;
/// Number of standard deviations below which 97.5 % of a normal distribution lies.
const NORMAL_975: f64 = 1.96;
/// Speed of the winds from which searches start, m/s.
const START_M_S: f64 = 6.0;
/// Half-width of an interval above which the wind counts as undetermined, m/s.
const VAGUE_M_S: f64 = 2.0;
/// Ratio of misfits above which one fit is clearly better: 1 % in each of six channels.
const CLEARLY: f64 = 1.06;
/// Number of searches, each with channel weights from the previous residuals.
const WEIGHINGS: usize = 3;
/// Minimum standard deviation of a channel, as a fraction of the initial guess; needed because a
/// log from a simulation has no noise.
const LEAST_SIGMA: f64 = 1e-4;

/// The names of all parameters.
pub fn names() -> Vec<&'static str> {
    PARAMETERS.iter().map(|parameter| parameter.name).collect()
}

/// The parameters with these names; without names, the default parameters that have a non-zero
/// value in the boat's file.
///
/// # Errors
/// [`NoFit`] for an unknown name.
pub fn parameters(named: &[String], boat: &Boat) -> Result<Vec<Parameter>, NoFit> {
    if named.is_empty() {
        let usual = |parameter: &&Parameter| {
            parameter.by_default && parameter.value(boat).is_some_and(|v| v > 0.0)
        };
        return Ok(PARAMETERS.iter().filter(usual).copied().collect());
    }
    if let Some(unknown) = named
        .iter()
        .find(|name| PARAMETERS.iter().all(|known| known.name != name.as_str()))
    {
        return Err(NoFit::Unknown(unknown.clone()));
    }
    Ok(PARAMETERS
        .iter()
        .filter(|known| named.iter().any(|name| name == known.name))
        .copied()
        .collect())
}

/// A step of the search.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Step {
    /// Total number of searches, each with channel weights from the previous residuals.
    pub searches: usize,
    /// Number of the current search, from 1.
    pub search: usize,
    /// Root mean square of the residuals, in standard deviations of the channels. `None` if the
    /// boat cannot be simulated.
    pub rms: Option<f64>,
}

/// Fits `parameters` of `boat` to a log, and reports every step.
///
/// # Errors
/// The reason, as a [`NoFit`]; [`NoFit::Ambiguous`] if several winds explain the log.
pub fn fit(
    boat: &Boat,
    log: &Log,
    setting: &Setting,
    parameters: &[Parameter],
    tell: &dyn Fn(Step),
) -> Result<Fit, NoFit> {
    let from = |setting: &Setting| search(boat, log, setting, parameters, tell);
    if has_wind(parameters) {
        fit_wind(setting, from)
    } else {
        from(setting)
    }
}

fn has_wind(parameters: &[Parameter]) -> bool {
    parameters
        .iter()
        .any(|parameter| WIND.contains(&parameter.name))
}

/// Searches from the initial boat and the water of `setting`.
fn search(
    boat: &Boat,
    log: &Log,
    setting: &Setting,
    parameters: &[Parameter],
    tell: &dyn Fn(Step),
) -> Result<Fit, NoFit> {
    let search = Cell::new(1);
    let told = |rms| {
        tell(Step {
            searches: WEIGHINGS,
            search: search.get(),
            rms,
        })
    };
    let mut problem = problem(boat, log, setting, parameters, &told)?;
    let first_guess = problem.sigmas;
    for weighing in 0..WEIGHINGS {
        let (found, report) = LevenbergMarquardt::new()
            .with_tol(1e-9)
            .with_patience(20)
            .minimize(problem);
        problem = found;
        if problem.residuals().is_none() {
            return Err(lost());
        }
        if report.termination.was_usage_issue() {
            return Err(NoFit::Search(format!("{:?}", report.termination)));
        }
        if weighing + 1 < WEIGHINGS {
            search.set(weighing + 2);
            weigh(&mut problem, &first_guess);
        }
    }
    report(&problem)
}

/// The mean wind as a velocity, m/s.
fn wind_of(sea: &Sea) -> Ned {
    let wind = sea.wind.as_ref();
    wind.map_or(Ned::default(), |wind| {
        Ned::toward_deg(wind.from_rad.to_degrees() + 180.0).scaled(wind.speed_10m_m_s)
    })
}

/// A fit with the mean wind. A wind and its opposite can explain a log almost equally well, since
/// drag hides the difference. The search therefore starts from several winds, and a wind that is
/// not clearly better than another is rejected.
fn fit_wind(
    setting: &Setting,
    search: impl Fn(&Setting) -> Result<Fit, NoFit>,
) -> Result<Fit, NoFit> {
    let mut fits: Vec<Fit> = vec![];
    let mut failed = NoFit::Nothing;
    for from_deg in [None, Some(0.0), Some(90.0), Some(180.0), Some(270.0)] {
        let mut setting = setting.clone();
        if let Some(from_deg) = from_deg {
            set_wind(
                &mut setting.sea,
                Ned::toward_deg(from_deg + 180.0).scaled(START_M_S),
            );
        }
        match search(&setting) {
            Ok(fit) => fits.push(fit),
            Err(why) => failed = why,
        }
    }
    fits.sort_by(|a, b| a.misfit().total_cmp(&b.misfit()));
    let Some(best) = fits.first() else {
        return Err(failed);
    };
    let wind = |fit: &Fit| fit.vector(WIND).unwrap_or_default();
    let (best_m_s, plus_minus) = wind(best);
    if plus_minus > VAGUE_M_S {
        return Err(NoFit::Undetermined(WIND.join(", ")));
    }
    let rivals = fits.iter().filter(|fit| {
        let (other_m_s, other_plus_minus) = wind(fit);
        let is_elsewhere = (other_m_s - best_m_s).length() > plus_minus.min(other_plus_minus);
        is_elsewhere && fit.misfit() < CLEARLY * best.misfit()
    });
    let winds: Vec<String> = std::iter::once(best)
        .chain(rivals)
        .filter_map(Fit::wind)
        .map(|(speed_m_s, from_deg)| format!("{speed_m_s:.1} m/s from {from_deg:.0}°"))
        .collect();
    if winds.len() > 1 {
        return Err(NoFit::Ambiguous(winds.join(", ")));
    }
    Ok(fits.remove(0))
}

/// The fit before its first step.
pub(super) fn problem<'a>(
    boat: &Boat,
    log: &'a Log,
    setting: &'a Setting,
    parameters: &[Parameter],
    tell: &'a dyn Fn(Option<f64>),
) -> Result<Problem<'a>, NoFit> {
    let model = Model {
        boat: boat.clone(),
        current: setting.sea.current.mean_m_s,
        wind: has_wind(parameters).then(|| wind_of(&setting.sea)),
    };
    let knob = |parameter: &Parameter| {
        Knob::new(*parameter, &model).ok_or(NoFit::NotThere(parameter.name))
    };
    let knobs = parameters
        .iter()
        .map(knob)
        .collect::<Result<Vec<Knob>, NoFit>>()?;
    if knobs.is_empty() {
        return Err(NoFit::Nothing);
    }
    if log.segments(setting.segment).len() < 2 {
        return Err(NoFit::NoStart);
    }
    Ok(Problem::new(model, setting, log, knobs, tell))
}

/// Weighs each channel by its residuals.
fn weigh(problem: &mut Problem<'_>, first_guess: &[f64; 6]) {
    let sigma = |channel: usize| {
        rms(&problem.residuals_of(channel)).max(LEAST_SIGMA * first_guess[channel])
    };
    let sigmas = std::array::from_fn(sigma);
    problem.weigh(sigmas);
}

/// For each parameter, the fraction of the squared residuals that its change alone would remove, to
/// first order.
pub(super) fn promises(problem: &mut Problem<'_>) -> Result<Vec<f64>, NoFit> {
    let first_guess = problem.sigmas;
    weigh(problem, &first_guess);
    let jacobian = problem.jacobian().ok_or_else(lost)?;
    let residuals = problem.residuals().ok_or_else(lost)?;
    let squares = residuals.norm_squared();
    let promise = |i: usize| {
        let column = jacobian.column(i);
        let along = column.dot(&residuals);
        along * along / (column.norm_squared() * squares)
    };
    Ok((0..jacobian.ncols()).map(promise).collect())
}

fn lost() -> NoFit {
    NoFit::Search("the boat's state becomes non-finite near the best fit".to_owned())
}

/// Reports the fitted parameters and their uncertainty.
fn report(problem: &Problem<'_>) -> Result<Fit, NoFit> {
    let at = &problem.at;
    let jacobian = problem.jacobian().ok_or_else(lost)?;
    let residuals = problem.residuals().ok_or_else(lost)?;
    let (measured, fitted) = problem.sizes();
    let variance = residuals.norm_squared() / measured.saturating_sub(fitted).max(1) as f64;
    let covariance = covariance(&jacobian, variance, problem)?;
    let deviation = |i: usize| covariance[(i, i)].sqrt();
    let by_segment = deviations_by_segment(&jacobian, &residuals, problem);
    let student = student_975(problem.segments.len() - 1);
    let estimate = |(i, knob): (usize, &Knob)| {
        let value = knob.value(at[i]);
        let slope = knob.slope(at[i]);
        Estimate {
            parameter: knob.parameter,
            before: knob.before,
            value,
            plus_minus: slope * f64::max(NORMAL_975 * deviation(i), student * by_segment[i]),
        }
    };
    let mut confused = vec![];
    for i in 0..problem.knobs.len() {
        for j in 0..i {
            let correlation = covariance[(i, j)] / (deviation(i) * deviation(j));
            if correlation.abs() > CONFUSED {
                let names = [
                    problem.knobs[j].parameter.name,
                    problem.knobs[i].parameter.name,
                ];
                confused.push(Confused { names, correlation });
            }
        }
    }
    Ok(Fit {
        boat: problem.model_at(at).boat,
        estimates: problem.knobs.iter().enumerate().map(estimate).collect(),
        qualities: qualities(problem),
        confused,
        segments: problem.segments.len() - 1,
        measured,
    })
}

/// The covariance of the search coordinates, s² (JᵀJ)⁻¹.
fn covariance(
    jacobian: &DMatrix<f64>,
    variance: f64,
    problem: &Problem<'_>,
) -> Result<DMatrix<f64>, NoFit> {
    let blind = |i: &usize| jacobian.column(*i).norm() < 1e-9;
    let undetermined: Vec<&str> = (0..jacobian.ncols())
        .filter(blind)
        .map(|i| problem.knobs[i].parameter.name)
        .collect();
    if !undetermined.is_empty() {
        return Err(NoFit::Undetermined(undetermined.join(", ")));
    }
    let inverse = jacobian
        .tr_mul(jacobian)
        .cholesky()
        .map(|factors| factors.inverse());
    let names = || {
        problem
            .knobs
            .iter()
            .map(|knob| knob.parameter.name)
            .collect::<Vec<_>>()
            .join(", ")
    };
    inverse
        .map(|inverse| inverse * variance)
        .ok_or_else(|| NoFit::Undetermined(names()))
}

/// The standard deviations of the search coordinates by the delete-one jackknife over segments. For
/// white noise, the result equals [`covariance`]. However, the errors of a real log persist for
/// seconds, and intervals that assume white noise are then several times too narrow.
fn deviations_by_segment(
    jacobian: &DMatrix<f64>,
    residuals: &DVector<f64>,
    problem: &Problem<'_>,
) -> Vec<f64> {
    let all = jacobian.tr_mul(jacobian);
    let mut squares = vec![0.0; jacobian.ncols()];
    for border in problem.borders.windows(2) {
        let count = border[1] - border[0];
        let rows = jacobian.rows(border[0], count);
        // The change of the fit without this segment, to first order.
        let others = &all - rows.tr_mul(&rows);
        let Some(factors) = others.cholesky() else {
            // Some parameter is determined by this segment alone.
            return vec![f64::INFINITY; jacobian.ncols()];
        };
        let change = factors.solve(&rows.tr_mul(&residuals.rows(border[0], count)));
        for (square, change) in squares.iter_mut().zip(change.iter()) {
            *square += change * change;
        }
    }
    let segments = (problem.borders.len() - 1) as f64;
    let scale = (segments - 1.0) / segments;
    squares
        .iter()
        .map(|square| (scale * square).sqrt())
        .collect()
}

/// The 97.5 % quantile of Student's distribution for this many segments; infinite for one.
pub(crate) fn student_975(segments: usize) -> f64 {
    let student = StudentsT::new(0.0, 1.0, segments as f64 - 1.0);
    student.map_or(f64::INFINITY, |student| student.inverse_cdf(0.975))
}

/// The quality of each measured channel.
pub(super) fn qualities(problem: &Problem<'_>) -> Vec<Quality> {
    (0..6)
        .filter_map(|channel| quality(problem, channel))
        .collect()
}

fn quality(problem: &Problem<'_>, channel: usize) -> Option<Quality> {
    let residuals = problem.residuals_of(channel);
    let measured: Vec<f64> = problem.log.measured[problem.segments[0]..]
        .iter()
        .map(|cells| cells[channel])
        .filter(|c| c.is_finite())
        .collect();
    if residuals.is_empty() {
        return None;
    }
    let mean = measured.iter().sum::<f64>() / measured.len() as f64;
    let spread: f64 = measured
        .iter()
        .map(|cell| (cell - mean) * (cell - mean))
        .sum();
    let left: f64 = residuals.iter().map(|residual| residual * residual).sum();
    let (name, head, unit) = CHANNELS[channel];
    let rms = rms(&residuals);
    Some(Quality {
        channel: name,
        unit: match (unit, head.ends_with("_s")) {
            (Unit::Degrees, true) => "°/s",
            (Unit::Degrees, false) => "°",
            (Unit::Plain, true) => "m/s",
            (Unit::Plain, false) => "m",
        },
        rms: if unit == Unit::Degrees {
            rms.to_degrees()
        } else {
            rms
        },
        r_squared: 1.0 - left / spread,
    })
}

fn rms(numbers: &[f64]) -> f64 {
    (numbers.iter().map(|number| number * number).sum::<f64>() / numbers.len().max(1) as f64).sqrt()
}
