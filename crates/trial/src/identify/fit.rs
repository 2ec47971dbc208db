//! The search for the parameters that fit a log best, and how well they are known.

use super::log::{CHANNELS, Log, Unit};
use super::parameter::{Knob, PARAMETERS, Parameter};
use super::problem::Problem;
use super::rollout::Setting;
use levenberg_marquardt::{LeastSquaresProblem, LevenbergMarquardt};
use nalgebra::DMatrix;
use scenario::boat::Boat;
use std::cell::Cell;
use thiserror::Error;

/// A fitted parameter.
#[derive(Clone, Copy, Debug)]
pub struct Estimate {
    /// Which.
    pub parameter: Parameter,
    /// Its value in the boat that was given.
    pub before: f64,
    /// Its value now.
    pub value: f64,
    /// Within how much of that the true value lies with 95 % probability, if the model is right and the noise white.
    pub plus_minus: f64,
}

/// How well a channel is fitted.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Quality {
    /// Its name.
    pub channel: &'static str,
    /// Its unit.
    pub unit: &'static str,
    /// Root of the mean squared residual.
    pub rms: f64,
    /// Share of the measurements' variance that the model explains.
    pub r_squared: f64,
}

/// Two parameters that the log can hardly tell apart.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Confused {
    /// Their names.
    pub names: [&'static str; 2],
    /// Their correlation.
    pub correlation: f64,
}

/// What a log says about a boat.
#[derive(Clone, Debug)]
pub struct Fit {
    /// The boat with the fitted parameters.
    pub boat: Boat,
    /// The parameters.
    pub estimates: Vec<Estimate>,
    /// The channels.
    pub qualities: Vec<Quality>,
    /// Pairs that are hardly told apart.
    pub confused: Vec<Confused>,
    /// In how many segments.
    pub segments: usize,
    /// How many numbers were measured.
    pub measured: usize,
}

/// Why there is no fit.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum NoFit {
    /// A name that is none of a parameter.
    #[error("{0} is no parameter, expected some of {list}", list = names().join(", "))]
    Unknown(String),
    /// The boat has no such number.
    #[error("the boat has no {0}")]
    NotThere(&'static str),
    /// Nothing to fit.
    #[error("no parameter to fit")]
    Nothing,
    /// No row that a segment could begin with.
    #[error("no row of the log has heading, surge and yaw rate at once, and whatever else the log measures")]
    NoStart,
    /// The search did not come to an end.
    #[error("the search failed: {0}")]
    Search(String),
    /// The log says nothing about some parameters.
    #[error("the log does not determine {0}: leave some out with --fit, or record more")]
    Undetermined(String),
}

/// A correlation beyond this is worth a warning.
const CONFUSED: f64 = 0.95;
/// 97.5 % of a normal distribution lie below this many standard deviations.
const NORMAL_975: f64 = 1.96;
/// How often channels are weighed anew by what is left of them.
const WEIGHINGS: usize = 3;
/// Channels are not taken to be better than this share of the first guess: a log without noise is a simulation.
const LEAST_SIGMA: f64 = 1e-4;

/// The names of all parameters.
#[must_use]
pub fn names() -> Vec<&'static str> {
    PARAMETERS.iter().map(|parameter| parameter.name).collect()
}

/// The parameters of these names; of none, those that are usual and that the boat's file does not have as zero.
///
/// # Errors
/// [`NoFit`] for a name that is none.
pub fn parameters(named: &[String], boat: &Boat) -> Result<Vec<Parameter>, NoFit> {
    if named.is_empty() {
        let usual = |parameter: &&Parameter| parameter.by_default && parameter.value(boat).is_some_and(|v| v > 0.0);
        return Ok(PARAMETERS.iter().filter(usual).copied().collect());
    }
    if let Some(unknown) = named.iter().find(|name| PARAMETERS.iter().all(|known| known.name != name.as_str())) {
        return Err(NoFit::Unknown(unknown.clone()));
    }
    Ok(PARAMETERS.iter().filter(|known| named.iter().any(|name| name == known.name)).copied().collect())
}

/// A step of the search.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Step {
    /// The search is made so many times, each with channels weighed by what the one before left of them.
    pub searches: usize,
    /// Which of them it is, from 1.
    pub search: usize,
    /// What is left, in standard deviations of the channels: their root mean square. None where the boat cannot be sailed.
    pub rms: Option<f64>,
}

/// Fits `parameters` of `boat` to a log, and tells of every step.
///
/// # Errors
/// [`NoFit`] says why there is none.
pub fn fit(
    boat: &Boat,
    log: &Log,
    setting: &Setting,
    parameters: &[Parameter],
    tell: &dyn Fn(Step),
) -> Result<Fit, NoFit> {
    let knob = |parameter: &Parameter| Knob::new(*parameter, boat).ok_or(NoFit::NotThere(parameter.name));
    let knobs = parameters.iter().map(knob).collect::<Result<Vec<Knob>, NoFit>>()?;
    if knobs.is_empty() {
        return Err(NoFit::Nothing);
    }
    if log.segments(setting.segment).len() < 2 {
        return Err(NoFit::NoStart);
    }
    let search = Cell::new(1);
    let told = |rms| tell(Step { searches: WEIGHINGS, search: search.get(), rms });
    let mut problem = Problem::new(boat, setting, log, knobs, &told);
    let first_guess = problem.sigmas;
    for weighing in 0..WEIGHINGS {
        let (found, report) = LevenbergMarquardt::new().with_tol(1e-9).with_patience(20).minimize(problem);
        problem = found;
        if report.termination.was_usage_issue() || problem.residuals().is_none() {
            return Err(NoFit::Search(format!("{:?}", report.termination)));
        }
        if weighing + 1 < WEIGHINGS {
            search.set(weighing + 2);
            let sigma = |channel: usize| rms(&problem.residuals_of(channel)).max(LEAST_SIGMA * first_guess[channel]);
            let sigmas = std::array::from_fn(sigma);
            problem.weigh(sigmas);
        }
    }
    report(&problem)
}

/// What was found, and how well it is known.
fn report(problem: &Problem<'_>) -> Result<Fit, NoFit> {
    let at = problem.place();
    let lost = || NoFit::Search("the boat's numbers go bad near the best fit".to_owned());
    let jacobian = problem.jacobian().ok_or_else(lost)?;
    let residuals = problem.residuals().ok_or_else(lost)?;
    let (measured, fitted) = problem.sizes();
    let variance = residuals.norm_squared() / measured.saturating_sub(fitted).max(1) as f64;
    let covariance = covariance(&jacobian, variance, problem)?;
    let deviation = |i: usize| covariance[(i, i)].sqrt();
    let estimate = |(i, knob): (usize, &Knob)| {
        let value = knob.value(at[i]);
        // The search moves the logarithm: d value = value d log.
        Estimate {
            parameter: knob.parameter,
            before: knob.before,
            value,
            plus_minus: NORMAL_975 * value * deviation(i),
        }
    };
    let mut confused = vec![];
    for i in 0..problem.knobs.len() {
        for j in 0..i {
            let correlation = covariance[(i, j)] / (deviation(i) * deviation(j));
            if correlation.abs() > CONFUSED {
                let names = [problem.knobs[j].parameter.name, problem.knobs[i].parameter.name];
                confused.push(Confused { names, correlation });
            }
        }
    }
    Ok(Fit {
        boat: problem.boat_at(at),
        estimates: problem.knobs.iter().enumerate().map(estimate).collect(),
        qualities: (0..6).filter_map(|channel| quality(problem, channel)).collect(),
        confused,
        segments: problem.segments.len() - 1,
        measured,
    })
}

/// The covariance of the parameters' logarithms, s² (JᵀJ)⁻¹.
fn covariance(jacobian: &DMatrix<f64>, variance: f64, problem: &Problem<'_>) -> Result<DMatrix<f64>, NoFit> {
    let blind = |i: &usize| jacobian.column(*i).norm() < 1e-9;
    let undetermined: Vec<&str> =
        (0..jacobian.ncols()).filter(blind).map(|i| problem.knobs[i].parameter.name).collect();
    if !undetermined.is_empty() {
        return Err(NoFit::Undetermined(undetermined.join(", ")));
    }
    let inverse = jacobian.tr_mul(jacobian).cholesky().map(|factors| factors.inverse());
    let names = || problem.knobs.iter().map(|knob| knob.parameter.name).collect::<Vec<_>>().join(", ");
    inverse.map(|inverse| inverse * variance).ok_or_else(|| NoFit::Undetermined(names()))
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
    let spread: f64 = measured.iter().map(|cell| (cell - mean) * (cell - mean)).sum();
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
        rms: if unit == Unit::Degrees { rms.to_degrees() } else { rms },
        r_squared: 1.0 - left / spread,
    })
}

fn rms(numbers: &[f64]) -> f64 {
    (numbers.iter().map(|number| number * number).sum::<f64>() / numbers.len().max(1) as f64).sqrt()
}
