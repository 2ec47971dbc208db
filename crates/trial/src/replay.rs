//! Commands replayed: an open-loop series in, a boat's track out.

use super::orders::Orders;
use super::sample::Sample;
use super::trial_boat::TrialBoat;
use primitives::SimTime;
use thiserror::Error;

/// The time between two rows of a trial's file.
pub const ROW: SimTime = SimTime(100_000_000);

/// The boat's numbers went bad.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
#[error("the boat's numbers went bad at {t_s:.2} s: the model is unstable at this tick, try a shorter one")]
pub struct Unsound {
    /// When, s.
    pub t_s: f64,
}

/// How many ticks there are between two rows.
///
/// # Errors
/// Says what is allowed, where the tick does not fit.
pub fn ticks_per_row(tick: SimTime) -> Result<u32, String> {
    if tick < SimTime(1_000_000) || tick > ROW || ROW.0 % tick.0 != 0 {
        return Err(format!("a tick of {} s, expected 0.001 to 0.1 and a whole number of ticks in 0.1 s", tick.as_s()));
    }
    Ok((ROW.0 / tick.0) as u32)
}

/// Sails a boat by `orders` for `duration` and gives a sample every [`ROW`], that of the start first.
///
/// A command is in force from the first tick that begins at its time or later.
///
/// # Errors
/// [`Unsound`] where the boat's numbers go bad.
///
/// # Panics
/// If the tick does not fit into [`ROW`]; see [`ticks_per_row`].
pub fn replay(trial_boat: &mut TrialBoat, orders: &Orders, duration: SimTime) -> Result<Vec<Sample>, Unsound> {
    let per_row = ticks_per_row(trial_boat.tick()).expect("the tick was checked");
    let (start, rows) = (trial_boat.now(), duration.0 / ROW.0);
    let mut samples = Vec::with_capacity(rows as usize + 1);
    samples.push(trial_boat.sample(0.0, orders.at(SimTime::ZERO)));
    for row in 1..=rows {
        for _ in 0..per_row {
            trial_boat.step(orders.at(trial_boat.now() - start));
        }
        let t_s = (ROW * row).as_s();
        if !trial_boat.is_sound() {
            return Err(Unsound { t_s });
        }
        samples.push(trial_boat.sample(t_s, orders.at(ROW * row)));
    }
    Ok(samples)
}
