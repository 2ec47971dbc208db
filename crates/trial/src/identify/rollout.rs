//! Simulates the model along a log: its state at each of the log's rows.

use super::log::{HEADING, Log, SURGE, SWAY, YAW_RATE};
use crate::{Command, Sample, Start, TrialBoat};
use primitives::angle::wrap_pi;
use primitives::{Ned, Pose, SimTime};
use scenario::boat::Boat;
use scenario::sea::Sea;
use sim::hull::Planar;

/// A boat's state in the order of the log's channels.
pub(super) type Point = [f64; 6];

/// The water and the time steps.
#[derive(Clone, Debug)]
pub struct Setting {
    /// The water.
    pub sea: Sea,
    /// The sea's random seed.
    pub seed: u64,
    /// Physics tick.
    pub tick: SimTime,
    /// The duration of a simulated segment from a start.
    pub segment: SimTime,
}

/// What a rollout reports.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum View {
    /// The boat's motion.
    Truth,
    /// What its sensors measure. Starts are then measurements, too.
    Sensors,
}

/// The motion of `boat` from each segment's start under the log's commands, at the rows from the
/// first start on; `None` if its state becomes non-finite. The thrusters run continuously through
/// all segments.
pub(super) fn rollout(
    boat: &Boat,
    setting: &Setting,
    log: &Log,
    (segments, starts): (&[usize], &[Point]),
    view: View,
) -> Option<Vec<Point>> {
    let mut trial_boat = TrialBoat::new(
        boat,
        &setting.sea,
        setting.tick,
        setting.seed,
        &Start::default(),
    );
    let mut points = vec![[f64::NAN; 6]; segments[0]];
    for (segment, start) in segments.windows(2).zip(starts) {
        // First, the thrusters follow the earlier commands; the boat's motion during this time does
        // not matter.
        while trial_boat.now() + SimTime(setting.tick.0 / 2) < log.times[segment[0]] {
            trial_boat.step(log.orders.at(trial_boat.now()));
        }
        let measured = start;
        let start = without_errors(measured, &trial_boat, view);
        let pose = Pose {
            at: Ned::from_xy(start[0], start[1]),
            psi_rad: wrap_pi(start[HEADING]),
        };
        trial_boat.relocate(
            pose,
            Planar {
                surge: start[SURGE],
                sway: start[SWAY],
                yaw: start[YAW_RATE],
            },
        );
        let mut before = (trial_boat.now(), *measured);
        let mut now = before;
        for row in segment[0]..segment[1] {
            while now.0 < log.times[row] {
                before = now;
                trial_boat.step(log.orders.at(trial_boat.now()));
                if !trial_boat.is_sound() {
                    return None;
                }
                now = (
                    trial_boat.now(),
                    point(&trial_boat, before.1[HEADING], view),
                );
            }
            points.push(between(before, now, log.times[row]));
        }
    }
    Some(points)
}

/// The true state behind a measured one, given the current sensor errors.
fn without_errors(measured: &Point, trial_boat: &TrialBoat, view: View) -> Point {
    if view == View::Truth {
        return *measured;
    }
    let [sensed, truth] = [view, View::Truth].map(|view| point(trial_boat, 0.0, view));
    std::array::from_fn(|i| match i {
        HEADING => measured[i] - wrap_pi(sensed[i] - truth[i]),
        _ => measured[i] - (sensed[i] - truth[i]),
    })
}

/// The boat's position and motion, with its heading within half a turn of the previous one.
fn point(trial_boat: &TrialBoat, heading_before: f64, view: View) -> Point {
    let reading = trial_boat.reading().filter(|_| view == View::Sensors);
    let [east, north, psi_rad, surge, sway, yaw] = match reading {
        Some(nav) => [
            nav.east_m,
            nav.north_m,
            nav.psi_rad,
            nav.surge_m_s,
            nav.sway_m_s,
            nav.yaw_rate_rad_s,
        ],
        None => {
            let Sample {
                at, psi_rad, nu, ..
            } = trial_boat.sample(0.0, Command::Hold);
            [at.east, at.north, psi_rad, nu.surge, nu.sway, nu.yaw]
        }
    };
    let heading = heading_before + wrap_pi(psi_rad - heading_before);
    [east, north, heading, surge, sway, yaw]
}

/// Linear interpolation between two ticks.
fn between(before: (SimTime, Point), now: (SimTime, Point), at: SimTime) -> Point {
    let span = (now.0 - before.0).as_s();
    let share = if span > 0.0 {
        ((at - before.0).as_s() / span).clamp(0.0, 1.0)
    } else {
        1.0
    };
    std::array::from_fn(|i| before.1[i] + share * (now.1[i] - before.1[i]))
}
