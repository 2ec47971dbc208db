//! Open-loop replay: turns a series of commands into a boat's track.

use super::orders::Orders;
use super::sample::Sample;
use super::trial_boat::TrialBoat;
use primitives::SimTime;
use thiserror::Error;

/// The time between two rows of a trial's file.
pub const ROW: SimTime = SimTime(100_000_000);

/// The boat's state became non-finite.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
#[error(
    "the boat's state became non-finite at {t_s:.2} s: the model is unstable with a tick this long; use a shorter one"
)]
pub struct Unsound {
    /// Time of the failure, s.
    pub t_s: f64,
}

/// The number of ticks between two rows.
///
/// # Errors
/// The allowed ticks, if this one does not divide [`ROW`].
pub fn ticks_per_row(tick: SimTime) -> Result<u32, String> {
    if tick < SimTime(1_000_000) || tick > ROW || ROW.0 % tick.0 != 0 {
        return Err(format!(
            "the tick is {:.4} s, expected 0.001 to 0.1 s and a divisor of 0.1 s",
            tick.as_s()
        ));
    }
    Ok((ROW.0 / tick.0) as u32)
}

/// Simulates a boat with `orders` for `duration`. Returns a sample every [`ROW`], beginning with
/// the start.
///
/// A command is in force from the first tick that begins at or after its time.
///
/// # Errors
/// [`Unsound`] if the boat's state becomes non-finite.
///
/// # Panics
/// If the tick does not divide [`ROW`]; see [`ticks_per_row`].
pub fn replay(
    trial_boat: &mut TrialBoat,
    orders: &Orders,
    duration: SimTime,
) -> Result<Vec<Sample>, Unsound> {
    let per_row = ticks_per_row(trial_boat.tick()).expect("the tick was checked");
    let start = trial_boat.now();
    let rows = duration.0 / ROW.0;
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
