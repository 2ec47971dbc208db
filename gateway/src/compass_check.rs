//! Checks a compass against the course over the ground: does the boat move where it points, apart
//! from leeway and current?
//!
//! On one heading, a compass offset cannot be distinguished from a cross current. On several
//! headings it can: a current is the same on all of them, whereas an offset turns with the boat.
//! Let V be the velocity over the ground, psi the compass heading, and m the speed through the
//! water expected from the orders. Then V = k m exp(i psi) + c. The drift c (current, leeway) is
//! the same on all headings, |k| is the fraction of the speed that the boat makes, and the angle of
//! k is the compass offset. Both are fitted by complex linear least squares.

use primitives::SimTime;
use primitives::angle::wrap_pi;
use primitives::frame::{Ned, Rotation};
use std::collections::VecDeque;

/// Number and duration (s) of the pieces of a straight run; the boat settles during the first.
const PIECES: usize = 4;
const PIECE_S: f64 = 1.5;
/// Maximum spread of the headings of a run's pieces, rad.
const STRAIGHT_RAD: f64 = 0.3;
/// Minimum ordered speed of a run, m/s.
const SPEED_FROM_M_S: f64 = 0.7;
/// Approximate lag with which a boat reaches its speed, s.
const SPEED_LAG_S: f64 = 2.0;
/// Maximum gap between orders and velocities of the same run, s.
const GAP_MAX_S: f64 = 1.5;
/// Maximum number of runs, and their maximum age (s), since currents change.
const RUNS_MAX: usize = 40;
const RUN_AGE_MAX_S: f64 = 240.0;
/// Minimum number of runs.
const RUNS_MIN: usize = 6;
/// Minimum scatter of the runs' velocities, m/s: a few runs may agree by chance.
const SCATTER_MIN_M_S: f64 = 0.15;
/// An offset is a fault if it exceeds this angle (rad) by this many standard deviations.
/// Consecutive runs are correlated, so 4.5 were too few in a simulated day in a gale
/// (`tests/gale`).
const OFFSET_MAX_RAD: f64 = 0.25;
const SIGMAS: f64 = 5.0;
/// Maximum length of the mean of all headings as unit vectors: two headings must be at least 57
/// degrees apart.
const MEAN_HEADING_MAX: f64 = 0.88;
/// A boat that makes a smaller fraction of its ordered speed reveals nothing about its compass.
const SHARE_MIN: f64 = 0.2;

/// Sums over a piece of a run.
#[derive(Clone, Copy, Debug, Default)]
struct Piece {
    count: f64,
    /// Direction of the bow.
    ahead: Ned,
    /// The ordered speed, along the bow, m/s.
    ordered: Ned,
    /// Velocity over the ground, m/s.
    velocity: Ned,
}

/// A straight run: the mean ordered velocity, by the compass, and the mean velocity over the
/// ground, m/s.
#[derive(Clone, Copy, Debug)]
struct Run {
    at: SimTime,
    ordered: Ned,
    velocity: Ned,
}

/// The data for the check of a boat's compass.
#[derive(Clone, Debug, Default)]
pub(crate) struct CompassCheck {
    /// Start of the current piece, and its last update.
    began: Option<(SimTime, SimTime)>,
    piece: Piece,
    pieces: VecDeque<Piece>,
    /// The ordered speed, delayed by the boat's lag, m/s.
    speed_m_s: f64,
    runs: VecDeque<Run>,
}

impl CompassCheck {
    /// Adds the compass heading (rad), the velocity over the ground and the ordered forward speed.
    pub(crate) fn observe(&mut self, now: SimTime, psi_rad: f64, velocity: Ned, ordered_m_s: f64) {
        let gap_s = self
            .began
            .map_or(f64::INFINITY, |(_, last)| (now - last).as_s());
        // A piece assumes that data arrive steadily: the boat may have turned during a gap.
        if gap_s > GAP_MAX_S {
            self.interrupt();
            self.speed_m_s = ordered_m_s;
        } else {
            // A Surveyor takes its reported speed from GPS, so its speed through the water is
            // unknown. The delayed order replaces it; only its direction matters, not its scale.
            self.speed_m_s += (ordered_m_s - self.speed_m_s) * (gap_s / SPEED_LAG_S).min(1.0);
        }
        let (began, _) = self.began.unwrap_or((now, now));
        self.began = Some((began, now));
        let ahead = Rotation::from_heading(psi_rad).ahead();
        self.piece.count += 1.0;
        self.piece.ahead = self.piece.ahead + ahead;
        self.piece.ordered = self.piece.ordered + ahead.scaled(self.speed_m_s);
        self.piece.velocity = self.piece.velocity + velocity;
        if (now - began).as_s() >= PIECE_S {
            self.pieces.push_back(std::mem::take(&mut self.piece));
            self.began = Some((now, now));
            self.end_piece(now);
        }
    }

    /// Starts a new run, because the boat was stopped or its receiver jumped.
    pub(crate) fn interrupt(&mut self) {
        (self.began, self.piece) = (None, Piece::default());
        self.pieces.clear();
    }

    fn end_piece(&mut self, now: SimTime) {
        if self.pieces.len() > PIECES {
            self.pieces.pop_front();
        }
        if self.pieces.len() < PIECES {
            return;
        }
        let first_rad = self.pieces[0].ahead.direction_rad();
        let is_straight = self
            .pieces
            .iter()
            .all(|piece| wrap_pi(piece.ahead.direction_rad() - first_rad).abs() < STRAIGHT_RAD);
        // After a turn the boat still slides: the first 1.5 s would show as leeway that turns with
        // the heading, like an offset.
        let settled = self.pieces.iter().skip(1);
        let [mut ordered, mut velocity] = [Ned::default(); 2];
        let count = settled.fold(0.0, |count, piece| {
            (ordered, velocity) = (ordered + piece.ordered, velocity + piece.velocity);
            count + piece.count
        });
        let run = Run {
            at: now,
            ordered: ordered.scaled(1.0 / count),
            velocity: velocity.scaled(1.0 / count),
        };
        if is_straight && run.ordered.length() >= SPEED_FROM_M_S {
            // The last piece of this run is the first of the next, where it only serves as the
            // lead-in. Otherwise it would count twice.
            self.pieces.drain(..PIECES - 1);
            self.runs.push_back(run);
        }
        while self.runs.len() > RUNS_MAX
            || self
                .runs
                .front()
                .is_some_and(|run| (now - run.at).as_s() > RUN_AGE_MAX_S)
        {
            self.runs.pop_front();
        }
    }

    /// The compass offset (rad), to be added to the compass heading, and its standard deviation.
    pub(crate) fn offset_rad(&self) -> Option<(f64, f64)> {
        if self.runs.len() < RUNS_MIN {
            return None;
        }
        let count = self.runs.len() as f64;
        let mean = |of: fn(&Run) -> Ned| {
            self.runs
                .iter()
                .fold(Ned::default(), |sum, run| sum + of(run))
                .scaled(1.0 / count)
        };
        let heading = mean(|run| run.ordered.scaled(1.0 / run.ordered.length()));
        // On one heading, an offset cannot be distinguished from a cross current. A fixed limit on
        // the angle between heading and course either misses offsets of 30 degrees or gives false
        // alarms in a current.
        if heading.length() > MEAN_HEADING_MAX {
            return None;
        }
        let ordered = mean(|run| run.ordered);
        let velocity = mean(|run| run.velocity);
        let mut share = Ned::default();
        let mut spread = 0.0;
        for run in &self.runs {
            // Subtracting the means removes the drift c, whatever its value.
            let z = run.ordered - ordered;
            let v = run.velocity - velocity;
            share = share + over(v, z);
            spread += z.dot(z);
        }
        let share = share.scaled(1.0 / spread);
        let rest = self.runs.iter().map(|run| {
            let z = run.ordered - ordered;
            let v = run.velocity - velocity;
            let left = v - times(share, z);
            left.dot(left)
        });
        // The runs have two components each; four parameters were fitted.
        let scatter_m_s = (rest.sum::<f64>() / (2.0 * count - 4.0))
            .sqrt()
            .max(SCATTER_MIN_M_S);
        // To first order, the error of the angle of k is the error across k, divided by the length
        // of k.
        let sigma_rad = scatter_m_s / (spread.sqrt() * share.length());
        (share.length() >= SHARE_MIN && sigma_rad.is_finite())
            .then(|| (share.direction_rad(), sigma_rad))
    }

    /// The compass offset (rad), if it is large enough to be a fault.
    pub(crate) fn fault_rad(&self) -> Option<f64> {
        let (offset_rad, sigma_rad) = self.offset_rad()?;
        // Deviations of up to 14 degrees are not a fault: such a boat can be driven, and a compass
        // swing finds them.
        (offset_rad.abs() - SIGMAS * sigma_rad > OFFSET_MAX_RAD).then_some(offset_rad)
    }
}

/// The product of two complex numbers, north real and east imaginary.
fn times(a: Ned, b: Ned) -> Ned {
    Ned {
        north: a.north * b.north - a.east * b.east,
        east: a.north * b.east + a.east * b.north,
    }
}

/// The product of `a` and the conjugate of `b`.
fn over(a: Ned, b: Ned) -> Ned {
    times(
        a,
        Ned {
            north: b.north,
            east: -b.east,
        },
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Runs of 24 s on these headings, ordered at 1.5 m/s and driven at a fraction of that speed,
    /// with a compass offset and a current.
    fn sailed(headings_deg: &[f64], off_deg: f64, share: f64, current: Ned) -> CompassCheck {
        let mut check = CompassCheck::default();
        for i in 0..240 * headings_deg.len() {
            let true_deg = headings_deg[i / 240];
            let velocity = Ned::toward_deg(true_deg).scaled(1.5 * share) + current;
            let psi_rad = wrap_pi((true_deg - off_deg).to_radians());
            check.observe(SimTime::from_s(0.1 * i as f64), psi_rad, velocity, 1.5);
        }
        check
    }

    #[test]
    fn a_compass_that_is_off_is_found_on_several_headings_whatever_the_current() {
        for current in [
            Ned::default(),
            Ned {
                north: 0.8,
                east: -0.4,
            },
        ] {
            for off_deg in [30.0, -30.0, 150.0] {
                for share in [0.7, 1.1] {
                    let off_rad =
                        sailed(&[10.0, 100.0, 190.0], off_deg, share, current).fault_rad();
                    assert!(
                        off_rad.is_some_and(|rad| (rad.to_degrees() - off_deg).abs() < 0.1),
                        "{off_deg} {off_rad:?}"
                    );
                }
            }
            assert_eq!(
                sailed(&[10.0, 100.0, 250.0], 5.0, 1.0, current).fault_rad(),
                None,
                "that is a normal deviation"
            );
        }
    }

    #[test]
    fn a_current_across_is_no_fault_of_the_compass() {
        let across = Ned {
            north: 0.0,
            east: 0.9,
        };
        assert_eq!(
            sailed(&[0.0], 0.0, 1.0, across).fault_rad(),
            None,
            "on one heading"
        );
        assert_eq!(
            sailed(&[0.0, 90.0, 180.0], 0.0, 1.0, across).fault_rad(),
            None,
            "on several"
        );
    }
}
