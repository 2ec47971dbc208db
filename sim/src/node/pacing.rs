//! Pause and speed of a running game, as set by operators.

use messages::Control;

#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Pacing {
    /// Whether an operator has paused the game.
    pub(super) is_paused: bool,
    /// Number of decisions still to be played while paused.
    steps: u32,
    /// Simulated seconds per second: a target in real time, a limit in lockstep. `None`: unlimited.
    pub(super) speed: Option<f64>,
    is_lockstep: bool,
    /// Whether there are real boats, whose speed cannot change.
    is_real: bool,
}

impl Pacing {
    /// The initial pacing of a game.
    pub(super) fn new(speed: Option<f64>, is_lockstep: bool, is_real: bool) -> Pacing {
        Pacing {
            is_paused: false,
            steps: 0,
            speed,
            is_lockstep,
            is_real,
        }
    }

    /// Whether the game must not advance now.
    pub(super) fn is_held(&self) -> bool {
        self.is_paused && self.steps == 0
    }

    /// Counts a played decision.
    pub(super) fn played(&mut self) {
        self.steps = self.steps.saturating_sub(1);
    }

    /// Applies a command if the game allows it. Returns whether it was applied.
    pub(super) fn change(&mut self, control: Control) -> bool {
        match control {
            Control::Pause => (self.is_paused, self.steps) = (true, 0),
            Control::Resume => (self.is_paused, self.steps) = (false, 0),
            // Count the steps, because an operator may press the key faster than decisions are
            // played.
            Control::Step if self.is_paused => self.steps = self.steps.saturating_add(1),
            // A game with real boats cannot change its speed.
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
        assert!(
            !pacing.is_held() && !pacing.change(Control::Step),
            "a running game needs no step"
        );
        assert!(pacing.change(Control::Pause) && pacing.is_held());
        assert!(
            pacing.change(Control::Step)
                && pacing.change(Control::Step)
                && !pacing.is_held()
                && pacing.is_paused
        );
        pacing.played();
        assert!(!pacing.is_held());
        pacing.played();
        assert!(pacing.is_held());
        assert!(pacing.change(Control::Resume) && !pacing.is_held() && !pacing.is_paused);
    }

    #[test]
    fn only_speeds_that_can_be_are_taken() {
        let mut lockstep = Pacing::new(None, true, false);
        assert!(lockstep.change(Control::Speed(Some(4.0))) && lockstep.speed == Some(4.0));
        for bad in [0.0, -1.0, f64::NAN, f64::INFINITY, 1e4] {
            assert!(!lockstep.change(Control::Speed(Some(bad))), "{bad}");
        }
        assert!(lockstep.change(Control::Speed(None)) && lockstep.speed.is_none());
        let mut clock = Pacing::new(Some(1.0), false, false);
        assert!(!clock.change(Control::Speed(None)) && clock.change(Control::Speed(Some(2.0))));
        let mut real = Pacing::new(Some(1.0), false, true);
        assert!(!real.change(Control::Speed(Some(2.0))) && real.speed == Some(1.0));
    }
}
