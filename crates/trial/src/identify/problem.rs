//! The fit as a least-squares problem: residuals, and their derivatives with respect to the
//! parameters.
//!
//! Multiple shooting: the model restarts in every segment, from a state that is itself fitted,
//! since measured starts contain noise. For given parameters, finding the best starts is a small
//! linear problem per segment, so the search varies only the parameters (variable projection, Golub
//! and Pereyra 1973, with Kaufman's simplification of the Jacobian, 1975).

use super::log::Log;
use super::parameter::{Knob, Model};
use super::rollout::{Point, Setting, View, rollout};
use levenberg_marquardt::LeastSquaresProblem;
use nalgebra::{DMatrix, DVector, Dyn, Owned};
use primitives::Ned;
use primitives::angle::wrap_pi;
use scenario::sea::{Gusts, PROFILE_EXPONENT, Sea, Wind};
use std::f64::consts::PI;

/// Step of a parameter's logarithm for finite differences.
const PARAMETER_STEP: f64 = 1e-4;
/// Step of a start for finite differences, in standard deviations of its channel.
const START_STEP: f64 = 1e-2;
/// Number of corrections of the starts for each set of parameters; a few are enough, since the
/// search continues from the last starts.
const CORRECTIONS: usize = 2;

/// The fit of one log.
#[derive(Clone)]
pub(super) struct Problem<'a> {
    model: Model,
    pub(super) setting: &'a Setting,
    pub(super) log: &'a Log,
    pub(super) segments: Vec<usize>,
    pub(super) knobs: Vec<Knob>,
    /// Standard deviation of each channel, which divides its residuals.
    pub(super) sigmas: [f64; 6],
    /// Measured cells: row and channel, by row.
    cells: Vec<(usize, usize)>,
    /// The first cell of each segment, with the end appended.
    pub(super) borders: Vec<usize>,
    /// The fitted channels of a start: the measured ones.
    fitted: Vec<usize>,
    /// The search coordinate.
    pub(super) at: DVector<f64>,
    starts: Vec<Point>,
    /// Whitened residuals at `at`; `None` if the model cannot be simulated.
    residuals: Option<DVector<f64>>,
    /// Called at every step with the root mean square of the residuals.
    tell: &'a dyn Fn(Option<f64>),
}

impl<'a> Problem<'a> {
    pub(super) fn new(
        model: Model,
        setting: &'a Setting,
        log: &'a Log,
        knobs: Vec<Knob>,
        tell: &'a dyn Fn(Option<f64>),
    ) -> Problem<'a> {
        let segments = log.segments(setting.segment);
        let rows = segments[0]..log.measured.len();
        let measured =
            |row: usize| (0..6).filter(move |channel| log.measured[row][*channel].is_finite());
        let cells: Vec<(usize, usize)> = rows
            .flat_map(|row| measured(row).map(move |channel| (row, channel)))
            .collect();
        let borders = segments
            .iter()
            .map(|start| cells.partition_point(|(row, _)| row < start))
            .collect();
        let fitted = (0..6)
            .filter(|channel| cells.iter().any(|(_, of)| of == channel))
            .collect();
        let starts = segments[..segments.len() - 1]
            .iter()
            .map(|row| log.start(*row))
            .collect();
        let at = DVector::zeros(knobs.len());
        let mut problem = Problem {
            model,
            setting,
            log,
            segments,
            knobs,
            // Typical accuracies of such instruments; the residuals later give better values.
            sigmas: [0.3, 0.3, 0.02, 0.05, 0.05, 0.01],
            cells,
            borders,
            fitted,
            at,
            starts,
            residuals: None,
            tell,
        };
        // A model that starts from a noisy measurement is wrong from the first row on, and the
        // search would distort parameters to compensate.
        problem.settle();
        problem
    }

    /// Sets the channels' standard deviations.
    pub(super) fn weigh(&mut self, sigmas: [f64; 6]) {
        self.sigmas = sigmas;
        self.settle();
    }

    /// Boat and water at a search coordinate.
    pub(super) fn model_at(&self, at: &DVector<f64>) -> Model {
        let mut model = self.model.clone();
        self.knobs
            .iter()
            .zip(at.iter())
            .for_each(|(knob, at)| knob.turn(&mut model, *at));
        model
    }

    /// The numbers of measured values and of fitted values, including starts.
    pub(super) fn sizes(&self) -> (usize, usize) {
        (
            self.cells.len(),
            self.knobs.len() + self.fitted.len() * self.starts.len(),
        )
    }

    /// The residuals of a channel in its own unit.
    pub(super) fn residuals_of(&self, channel: usize) -> Vec<f64> {
        let Some(residuals) = &self.residuals else {
            return vec![];
        };
        let of = self
            .cells
            .iter()
            .zip(residuals.iter())
            .filter(|((_, of), _)| *of == channel);
        of.map(|(_, residual)| residual * self.sigmas[channel])
            .collect()
    }

    fn weighed(&self, model: &Model, starts: &[Point]) -> Option<DVector<f64>> {
        let mut setting = self.setting.clone();
        setting.sea.current.mean_m_s = model.current;
        if let Some(wind) = model.wind {
            set_wind(&mut setting.sea, wind);
        }
        let segments = (self.segments.as_slice(), starts);
        let points = rollout(&model.boat, &setting, self.log, segments, View::Truth)?;
        let residual = |(row, channel): &(usize, usize)| {
            (points[*row][*channel] - self.log.measured[*row][*channel]) / self.sigmas[*channel]
        };
        let residuals = DVector::from_iterator(self.cells.len(), self.cells.iter().map(residual));
        residuals
            .iter()
            .all(|residual| residual.is_finite())
            .then_some(residuals)
    }

    /// Derivatives of the residuals with respect to the starts: a segment's start columns are
    /// stored in its rows.
    fn by_starts(&self, model: &Model, residuals: &DVector<f64>) -> Option<DMatrix<f64>> {
        let mut columns = Vec::with_capacity(self.fitted.len());
        for channel in &self.fitted {
            let mut moved = self.starts.clone();
            moved
                .iter_mut()
                .for_each(|start| start[*channel] += START_STEP * self.sigmas[*channel]);
            columns.push((self.weighed(model, &moved)? - residuals) / START_STEP);
        }
        Some(DMatrix::from_columns(&columns))
    }

    /// For each segment, the change of its start that best cancels `from`, in the columns of
    /// `by_starts`; `None` if undetermined.
    fn corrections(
        &self,
        by_starts: &DMatrix<f64>,
        from: &DVector<f64>,
    ) -> Option<Vec<DVector<f64>>> {
        let correction = |border: &[usize]| {
            let columns = by_starts.rows(border[0], border[1] - border[0]);
            let mut normal = columns.tr_mul(&columns);
            // This is so small that it matters only for a channel without information.
            (0..normal.nrows()).for_each(|i| normal[(i, i)] += 1e-9);
            Some(
                normal
                    .cholesky()?
                    .solve(&columns.tr_mul(&from.rows(border[0], border[1] - border[0]))),
            )
        };
        self.borders.windows(2).map(correction).collect()
    }

    /// The part of a vector that the starts cannot cancel.
    fn project(&self, by_starts: &DMatrix<f64>, from: &DVector<f64>) -> Option<DVector<f64>> {
        let mut left = from.clone();
        for (border, change) in self
            .borders
            .windows(2)
            .zip(self.corrections(by_starts, from)?)
        {
            let begin = border[0];
            let count = border[1] - border[0];
            let taken = by_starts.rows(begin, count) * change;
            left.rows_mut(begin, count)
                .iter_mut()
                .zip(taken.iter())
                .for_each(|(left, taken)| *left -= taken);
        }
        Some(left)
    }

    /// Computes the best starts for these parameters.
    fn settle(&mut self) {
        let model = self.model_at(&self.at);
        self.residuals = self.weighed(&model, &self.starts);
        for _ in 0..CORRECTIONS {
            let Some(residuals) = &self.residuals else {
                return;
            };
            let corrections = self
                .by_starts(&model, residuals)
                .and_then(|by| self.corrections(&by, residuals));
            let Some(corrections) = corrections else {
                return;
            };
            let mut starts = self.starts.clone();
            for (start, change) in starts.iter_mut().zip(&corrections) {
                for (channel, change) in self.fitted.iter().zip(change.iter()) {
                    start[*channel] -= change * self.sigmas[*channel];
                }
            }
            // A correction that increases the residuals has left the nearly linear range of the
            // model.
            match self.weighed(&model, &starts) {
                Some(better) if better.norm_squared() < residuals.norm_squared() => {
                    (self.starts, self.residuals) = (starts, Some(better));
                }
                _ => return,
            }
        }
    }
}

/// Replaces the mean wind 10 m above the water.
pub(super) fn set_wind(sea: &mut Sea, velocity_m_s: Ned) {
    let before = sea.wind.take().unwrap_or(Wind {
        speed_10m_m_s: 0.0,
        from_rad: 0.0,
        profile_exponent: PROFILE_EXPONENT,
        gusts: Gusts::None,
    });
    sea.wind = Some(Wind {
        speed_10m_m_s: velocity_m_s.length(),
        from_rad: wrap_pi(velocity_m_s.direction_rad() + PI),
        ..before
    });
}

impl LeastSquaresProblem<f64, Dyn, Dyn> for Problem<'_> {
    type ResidualStorage = Owned<f64, Dyn>;
    type JacobianStorage = Owned<f64, Dyn, Dyn>;
    type ParameterStorage = Owned<f64, Dyn>;

    fn set_params(&mut self, at: &DVector<f64>) {
        self.at.copy_from(at);
        self.settle();
        let rms =
            |residuals: &DVector<f64>| (residuals.norm_squared() / residuals.len() as f64).sqrt();
        (self.tell)(self.residuals.as_ref().map(rms));
    }

    fn params(&self) -> DVector<f64> {
        self.at.clone()
    }

    fn residuals(&self) -> Option<DVector<f64>> {
        self.residuals.clone()
    }

    fn jacobian(&self) -> Option<DMatrix<f64>> {
        let residuals = self.residuals.as_ref()?;
        let by_starts = self.by_starts(&self.model_at(&self.at), residuals)?;
        let mut columns = Vec::with_capacity(self.knobs.len());
        for i in 0..self.knobs.len() {
            let mut up = self.at.clone();
            let mut down = self.at.clone();
            up[i] += PARAMETER_STEP;
            down[i] -= PARAMETER_STEP;
            let up = self.weighed(&self.model_at(&up), &self.starts)?;
            let down = self.weighed(&self.model_at(&down), &self.starts)?;
            columns.push(self.project(&by_starts, &((up - down) / (2.0 * PARAMETER_STEP)))?);
        }
        Some(DMatrix::from_columns(&columns))
    }
}
