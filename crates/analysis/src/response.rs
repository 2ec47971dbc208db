//! A boat's response to its orders: delay, gain and drift.

use crate::series::{BoatSeries, GameSeries};
use crate::step::Sample;
use messages::Order;
use primitives::Ned;
use primitives::angle::wrap_pi;
use primitives::frame::{Rotation, body_from_ned};
use serde::{Deserialize, Serialize};

/// A boat's response to its orders. Values that cannot be determined from the game are `None`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Response {
    /// Heading delay, s: the delay at which heading and order agree best.
    pub heading_lag_s: Option<f64>,
    /// Remaining heading error at that delay, root mean square, degrees.
    pub heading_rms_deg: Option<f64>,
    /// Speed delay, s: the delay at which speed ahead and order correlate best.
    pub speed_lag_s: Option<f64>,
    /// Ratio of speed ahead to ordered speed at that delay, by least squares.
    pub speed_gain: Option<f64>,
    /// Remaining speed error at that delay, root mean square, m/s.
    pub speed_rms_m_s: Option<f64>,
    /// Mean velocity towards north and east under hold orders, from [`SETTLED_S`] on, m/s.
    pub hold_drift_m_s: Option<[f64; 2]>,
    /// Mean velocity to starboard of the ordered heading under steer orders, m/s.
    pub cross_track_m_s: Option<f64>,
}

/// The longest delay considered, s.
const LAG_MAX_S: f64 = 10.0;
/// Time after a hold order until a boat has stopped gliding, s.
pub const SETTLED_S: f64 = 10.0;
/// Minimum standard deviation of the ordered speed to determine a delay, m/s.
const VARIES_M_S: f64 = 0.05;
const VARIES_RAD: f64 = 0.05;
/// Minimum correlation to determine a delay: the search would find a best delay even for unrelated
/// speeds.
const CORRELATED: f64 = 0.5;
/// The minimum number of samples.
const SAMPLES_MIN: usize = 100;

/// An order and the response some time later.
type OrderAndAnswer = (f64, f64);

pub(crate) fn response(series: &GameSeries, boat: &BoatSeries) -> Response {
    let step_s = if series.times_s.len() > 1 {
        series.span_s() / (series.times_s.len() - 1) as f64
    } else {
        1.0
    };
    let run_ends = run_ends(&boat.samples);
    let lags = || 0..=(LAG_MAX_S / step_s.max(1e-3)).round() as usize;
    let pairs = |lag: usize| {
        let steered = boat
            .samples
            .iter()
            .zip(&run_ends)
            .enumerate()
            .filter(move |(i, (_, end))| i + lag < **end);
        steered.filter_map(move |(i, (sample, _))| {
            Some((sample.steered()?, boat.samples[i + lag].truth))
        })
    };
    let headings = |lag| -> Vec<OrderAndAnswer> {
        pairs(lag)
            .map(|(order, truth)| (order.0, truth.psi_rad))
            .collect()
    };
    let speeds = |lag| -> Vec<OrderAndAnswer> {
        pairs(lag)
            .map(|(order, truth)| (order.1, truth.surge_m_s))
            .collect()
    };
    let heading = lags()
        .filter_map(|lag| Some((lag, heading_rms_rad(&headings(lag))?)))
        .min_by(|a, b| a.1.total_cmp(&b.1));
    let speed = lags()
        .filter_map(|lag| Some((lag, correlation(&speeds(lag))?)))
        .max_by(|a, b| a.1.total_cmp(&b.1));
    let fit = speed.map(|(lag, _)| proportion(&speeds(lag)));
    Response {
        heading_lag_s: heading.map(|(lag, _)| lag as f64 * step_s),
        heading_rms_deg: heading.map(|(_, rms_rad)| rms_rad.to_degrees()),
        speed_lag_s: speed.map(|(lag, _)| lag as f64 * step_s),
        speed_gain: fit.map(|(gain, _)| gain),
        speed_rms_m_s: fit.map(|(_, rms_m_s)| rms_m_s),
        hold_drift_m_s: hold_drift(series, boat),
        cross_track_m_s: cross_track(boat),
    }
}

/// For each sample, the end of its uninterrupted run of steering; 0 if the boat was not steered.
fn run_ends(samples: &[Sample]) -> Vec<usize> {
    let mut ends = vec![0; samples.len()];
    let mut end = samples.len();
    for (i, sample) in samples.iter().enumerate().rev() {
        if sample.steered().is_some() {
            ends[i] = end
        } else {
            end = i
        }
    }
    ends
}

/// Root mean square of heading minus order, if the order varies.
fn heading_rms_rad(pairs: &[OrderAndAnswer]) -> Option<f64> {
    let first = pairs.first()?.0;
    let turned: Vec<OrderAndAnswer> = pairs
        .iter()
        .map(|(order, _)| (wrap_pi(order - first), 0.0))
        .collect();
    varies(&turned, VARIES_RAD)?;
    crate::statistics::rms(
        pairs
            .iter()
            .map(|(order, psi_rad)| wrap_pi(psi_rad - order)),
    )
}

/// Pearson's correlation coefficient of two series.
fn correlation(pairs: &[OrderAndAnswer]) -> Option<f64> {
    varies(pairs, VARIES_M_S)?;
    let count = pairs.len() as f64;
    let mean_x = pairs.iter().map(|t| t.0).sum::<f64>() / count;
    let mean_y = pairs.iter().map(|t| t.1).sum::<f64>() / count;
    let mut xx = 0.0;
    let mut yy = 0.0;
    let mut xy = 0.0;
    for (x, y) in pairs {
        let x = x - mean_x;
        let y = y - mean_y;
        (xx, yy, xy) = (xx + x * x, yy + y * y, xy + x * y);
    }
    let coefficient = xy / (xx * yy).sqrt();
    (coefficient >= CORRELATED).then_some(coefficient)
}

/// `Some` if there are enough orders with enough variation.
fn varies(pairs: &[OrderAndAnswer], least: f64) -> Option<()> {
    let count = pairs.len() as f64;
    let mean = pairs.iter().map(|t| t.0).sum::<f64>() / count;
    let variance = pairs
        .iter()
        .map(|t| (t.0 - mean) * (t.0 - mean))
        .sum::<f64>()
        / count;
    (pairs.len() >= SAMPLES_MIN && variance > least * least).then_some(())
}

/// The gain from order to response, and the root mean square of the residual.
fn proportion(pairs: &[OrderAndAnswer]) -> (f64, f64) {
    let (xx, xy) = pairs
        .iter()
        .fold((0.0, 0.0), |(xx, xy), (x, y)| (xx + x * x, xy + x * y));
    let gain = if xx > 0.0 { xy / xx } else { 0.0 };
    (
        gain,
        crate::statistics::rms(pairs.iter().map(|(x, y)| y - x)).unwrap_or(0.0),
    )
}

fn hold_drift(series: &GameSeries, boat: &BoatSeries) -> Option<[f64; 2]> {
    let mut held_s = 0.0;
    let mut sum = Ned::default();
    let mut count = 0_u32;
    let mut before_s = None;
    for (sample, time_s) in boat.samples.iter().zip(&series.times_s) {
        let step_s = time_s - before_s.replace(*time_s).unwrap_or(*time_s);
        let holds = sample.order == Order::Hold && (sample.is_free || sample.agent_lost);
        held_s = if holds { held_s + step_s } else { 0.0 };
        if held_s > SETTLED_S {
            sum = sum + sample.truth.velocity_m_s();
            count += 1;
        }
    }
    (count > 0).then(|| [sum.north / f64::from(count), sum.east / f64::from(count)])
}

fn cross_track(boat: &BoatSeries) -> Option<f64> {
    let across = |sample: &Sample| {
        let (heading_rad, _) = sample.steered()?;
        Some(
            body_from_ned(
                Rotation::from_heading(heading_rad),
                sample.truth.velocity_m_s(),
            )
            .starboard,
        )
    };
    let (sum, count) = boat
        .samples
        .iter()
        .filter_map(across)
        .fold((0.0, 0_u32), |(sum, count), v| (sum + v, count + 1));
    (count as usize >= SAMPLES_MIN).then(|| sum / f64::from(count))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::made_up;
    use messages::picture::Nav;
    use std::f64::consts::TAU;

    /// Oscillating orders, and a boat that follows with this delay and speed gain.
    fn late(lag_s: f64, gain: f64) -> GameSeries {
        let heading_rad =
            |time_s: f64| 3.0 + 0.8 * primitives::math::sin_cos(TAU * time_s / 40.0).0;
        let speed_m_s = |time_s: f64| 1.5 + 0.5 * primitives::math::sin_cos(TAU * time_s / 23.0).0;
        made_up::game(120.0, |time_s| {
            let psi_rad = heading_rad(time_s - lag_s) + TAU;
            let surge_m_s = gain * speed_m_s(time_s - lag_s);
            let order = Order::Steer {
                heading_rad: wrap_pi(heading_rad(time_s)),
                speed_m_s: speed_m_s(time_s),
            };
            let truth = Nav {
                psi_rad,
                surge_m_s,
                sway_m_s: 0.0,
                ..Nav::default()
            };
            Sample {
                truth,
                order,
                is_free: true,
                ..Sample::default()
            }
        })
    }

    #[test]
    fn a_late_copy_has_that_lag_and_that_gain() {
        for (lag_s, gain) in [(0.0, 1.0), (1.5, 1.0), (4.0, 0.8)] {
            let series = late(lag_s, gain);
            let got = response(&series, &series.boats[0]);
            let near =
                |got: Option<f64>, want: f64| got.is_some_and(|got| (got - want).abs() < 1e-6);
            assert!(
                near(got.heading_lag_s, lag_s) && near(got.heading_rms_deg, 0.0),
                "{lag_s} {gain}: {got:?}"
            );
            assert!(
                near(got.speed_lag_s, lag_s) && near(got.speed_gain, gain),
                "{lag_s} {gain}: {got:?}"
            );
        }
    }

    #[test]
    fn a_break_in_steering_is_not_steered_over() {
        let mut series = late(3.0, 1.0);
        // While the boat is not free, its heading is arbitrary.
        for sample in &mut series.boats[0].samples[500..600] {
            sample.is_free = false;
            sample.truth.psi_rad = 0.0;
            sample.truth.surge_m_s = -9.0;
        }
        let got = response(&series, &series.boats[0]);
        assert!(
            got.heading_lag_s
                .is_some_and(|lag_s| (lag_s - 3.0).abs() < 1e-6),
            "{got:?}"
        );
        assert!(
            got.heading_rms_deg.is_some_and(|rms_deg| rms_deg < 1e-6),
            "{got:?}"
        );
    }

    #[test]
    fn drift_is_told_once_a_boat_has_settled() {
        let series = made_up::game(60.0, |time_s| {
            let surge_m_s = if time_s <= SETTLED_S { 3.0 } else { 0.0 };
            // With heading east, starboard is south.
            let truth = Nav {
                psi_rad: TAU / 4.0,
                surge_m_s,
                sway_m_s: 0.2,
                ..Nav::default()
            };
            Sample {
                truth,
                is_free: true,
                ..Sample::default()
            }
        });
        let [north_m_s, east_m_s] = response(&series, &series.boats[0])
            .hold_drift_m_s
            .expect("it held");
        assert!(
            (north_m_s + 0.2).abs() < 1e-9 && east_m_s.abs() < 1e-9,
            "{north_m_s} {east_m_s}"
        );
    }

    #[test]
    fn a_boat_that_is_set_to_starboard_says_so() {
        let series = made_up::game(60.0, |_| {
            let order = Order::Steer {
                heading_rad: 1.0,
                speed_m_s: 2.0,
            };
            let truth = Nav {
                psi_rad: 1.0,
                surge_m_s: 2.0,
                sway_m_s: 0.3,
                ..Nav::default()
            };
            Sample {
                truth,
                order,
                is_free: true,
                ..Sample::default()
            }
        });
        let got = response(&series, &series.boats[0]);
        assert!(
            got.cross_track_m_s
                .is_some_and(|across_m_s| (across_m_s - 0.3).abs() < 1e-9),
            "{got:?}"
        );
        assert_eq!(
            (got.heading_lag_s, got.speed_lag_s),
            (None, None),
            "an order that never varies determines no delay"
        );
    }
}
