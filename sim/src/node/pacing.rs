//! Paused or not, and how fast: what people ask of a running game.

use messages::Control;

/// Paused or not, and how fast.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Pacing {
    is_paused: bool,
    /// Decisions that are still to be played although it is paused.
    steps: u32,
    /// Simulated seconds a second: aimed at by the clock, not exceeded in lockstep. None is as fast as can be.
    speed: Option<f64>,
    is_lockstep: bool,
    /// Whether there are real boats, which have a pace of their own.
    is_real: bool,
}

impl Pacing {
    /// The pacing of a game as it was started.
    pub(super) fn new(speed: Option<f64>, is_lockstep: bool, is_real: bool) -> Pacing {
        Pacing { is_paused: false, steps: 0, speed, is_lockstep, is_real }
    }

    /// Whether the game stands still now.
    pub(super) fn is_held(&self) -> bool {
        self.is_paused && self.steps == 0
    }

    /// Whether somebody paused it.
    pub(super) fn is_paused(&self) -> bool {
        self.is_paused
    }

    /// Simulated seconds a second; none is as fast as can be.
    pub(super) fn speed(&self) -> Option<f64> {
        self.speed
    }

    /// A decision was played.
    pub(super) fn played(&mut self) {
        self.steps = self.steps.saturating_sub(1);
    }

    /// Changes to what is asked for, and returns whether it can.
    pub(super) fn change(&mut self, control: Control) -> bool {
        match control {
            Control::Pause => (self.is_paused, self.steps) = (true, 0),
            Control::Resume => (self.is_paused, self.steps) = (false, 0),
            // Counted, since a person may press the key faster than a decision is played.
            Control::Step if self.is_paused => self.steps = self.steps.saturating_add(1),
            // Real boats have one speed.
            Control::Speed(Some(speed)) if Control::SPEEDS.contains(&speed) && !self.is_real => {
                self.speed = Some(speed);
            }
            Control::Speed(None) if self.is_lockstep => self.speed = None,
            _ => return false,
        }
        true
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_paused_game_plays_the_steps_that_it_is_asked_for() {
        let mut pacing = Pacing::new(None, true, false);
        assert!(!pacing.is_held() && !pacing.change(Control::Step), "it is going on");
        assert!(pacing.change(Control::Pause) && pacing.is_held());
        assert!(
            pacing.change(Control::Step) && pacing.change(Control::Step) && !pacing.is_held() && pacing.is_paused()
        );
        pacing.played();
        assert!(!pacing.is_held());
        pacing.played();
        assert!(pacing.is_held());
        assert!(pacing.change(Control::Resume) && !pacing.is_held() && !pacing.is_paused());
    }

    #[test]
    fn only_speeds_that_can_be_are_taken() {
        let mut lockstep = Pacing::new(None, true, false);
        assert!(lockstep.change(Control::Speed(Some(4.0))) && lockstep.speed() == Some(4.0));
        for bad in [0.0, -1.0, f64::NAN, f64::INFINITY, 1e4] {
            assert!(!lockstep.change(Control::Speed(Some(bad))), "{bad}");
        }
        assert!(lockstep.change(Control::Speed(None)) && lockstep.speed().is_none());
        let mut clock = Pacing::new(Some(1.0), false, false);
        assert!(!clock.change(Control::Speed(None)) && clock.change(Control::Speed(Some(2.0))));
        let mut real = Pacing::new(Some(1.0), false, true);
        assert!(!real.change(Control::Speed(Some(2.0))) && real.speed() == Some(1.0));
    }
}
