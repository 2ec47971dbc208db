//! The collision halt: a boat that has come too close to another boat stops, whatever other
//! behaviours want, until it is released. In the 2023 games, people separated such boats.

use super::{BehaviourLogic, BehaviourOutput};
use crate::situation::Situation;
use primitives::SimTime;
use scenario::strategy::{AvoidCollision, Parameter};

/// Collision avoidance, with a halt as the last resort.
#[derive(Clone)]
pub(super) struct HaltingAvoidance {
    avoidance: AvoidCollision,
    halt: Halt,
}

#[derive(Clone, Copy)]
enum Halt {
    /// No boat has come too close.
    Clear,
    Halted {
        since: SimTime,
    },
    /// Released by the time limit while others were near; the boat halts again only once it has
    /// been clear of them.
    Released,
}

impl HaltingAvoidance {
    pub(super) fn new(avoidance: AvoidCollision) -> HaltingAvoidance {
        HaltingAvoidance {
            avoidance,
            halt: Halt::Clear,
        }
    }

    fn next(&self, situation: &Situation) -> Halt {
        let value = |parameter: &Option<Parameter>| {
            parameter
                .as_ref()
                .map(|parameter| parameter.value(situation))
        };
        let AvoidCollision {
            halt_m,
            release_m,
            release_s,
            ..
        } = &self.avoidance;
        let Some(halt_m) = value(halt_m) else {
            return Halt::Clear;
        };
        // The default is three times the halt distance: if a halt ended at the distance at which it
        // begins, it would start again at once.
        let release_m = value(release_m).unwrap_or(3.0 * halt_m);
        let release_s = value(release_s);
        let distances = situation
            .others()
            .map(|other| situation.at.distance(other.at));
        // Consider all boats, even those that `contacts` excludes: the halt concerns hulls, not
        // tags.
        let nearest_m = distances.fold(f64::INFINITY, f64::min);
        let is_clear = nearest_m >= release_m.max(halt_m);
        match self.halt {
            Halt::Clear if nearest_m < halt_m => Halt::Halted {
                since: situation.now,
            },
            Halt::Halted { .. } | Halt::Released if is_clear => Halt::Clear,
            Halt::Halted { since }
                if release_s.is_some_and(|limit_s| (situation.now - since).as_s() >= limit_s) =>
            {
                Halt::Released
            }
            halt => halt,
        }
    }
}

impl BehaviourLogic for HaltingAvoidance {
    fn begin(&mut self, _situation: &Situation) {
        self.halt = Halt::Clear;
    }

    fn run(&mut self, situation: &Situation, output: &mut BehaviourOutput<'_>) {
        // The avoidance also runs during a halt, so that its functions are visible and ready when
        // the halt ends.
        self.avoidance.run(situation, output);
        self.halt = self.next(situation);
        if matches!(self.halt, Halt::Halted { .. }) {
            output.stop();
        }
    }
}
