//! The life of a behaviour: idle, running, active, complete.

use game::SimTime;
use game::strategy::Moment;

/// Where a behaviour is in its life.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Stage {
    /// It may not run.
    Idle,
    /// It runs but asks for nothing.
    Running,
    /// It runs and influences the helm.
    Active,
    /// It is done.
    Complete,
}

/// One behaviour's life.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Life {
    pub(crate) stage: Stage,
    /// When it last began to run.
    since: SimTime,
}

impl Life {
    pub(crate) fn new() -> Life {
        Life { stage: Stage::Idle, since: SimTime::ZERO }
    }

    /// It may run, or not. Says whether it begins to run now.
    pub(crate) fn allow(&mut self, may_run: bool, now: SimTime, mut post: impl FnMut(Moment)) -> bool {
        match (self.stage, may_run) {
            (Stage::Idle, true) => {
                (self.stage, self.since) = (Stage::Running, now);
                post(Moment::Run);
                true
            }
            (Stage::Running | Stage::Active, false) => {
                if self.stage == Stage::Active {
                    post(Moment::Inactive);
                }
                post(Moment::Idle);
                self.stage = Stage::Idle;
                false
            }
            _ => false,
        }
    }

    /// Whether it runs.
    pub(crate) fn runs(&self) -> bool {
        matches!(self.stage, Stage::Running | Stage::Active)
    }

    /// How long it has been running.
    pub(crate) fn running_s(&self, now: SimTime) -> f64 {
        (now - self.since).as_s()
    }

    /// It has asked for something, or nothing.
    pub(crate) fn asked(&mut self, active: bool, mut post: impl FnMut(Moment)) {
        match (self.stage, active) {
            (Stage::Running, true) => {
                self.stage = Stage::Active;
                post(Moment::Active);
            }
            (Stage::Active, false) => {
                self.stage = Stage::Running;
                post(Moment::Inactive);
            }
            _ => {}
        }
    }

    /// It is done; one that is perpetual begins anew at the next decision.
    pub(crate) fn complete(&mut self, perpetual: bool, mut post: impl FnMut(Moment)) {
        if self.stage == Stage::Active {
            post(Moment::Inactive);
        }
        post(Moment::Complete);
        self.stage = if perpetual { Stage::Idle } else { Stage::Complete };
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What is posted while a behaviour may or may not run, is active or not, and completes.
    fn posted(perpetual: bool, steps: &[(bool, bool, bool)]) -> (Vec<Moment>, Stage) {
        let (mut life, mut moments) = (Life::new(), vec![]);
        for (i, (may_run, active, complete)) in steps.iter().enumerate() {
            life.allow(*may_run, SimTime(i as i64), |moment| moments.push(moment));
            if life.runs() {
                life.asked(*active, |moment| moments.push(moment));
            }
            if life.runs() && *complete {
                life.complete(perpetual, |moment| moments.push(moment));
            }
        }
        (moments, life.stage)
    }

    #[test]
    fn every_turn_of_a_life_is_posted_once() {
        use Moment::{Active, Complete, Idle, Inactive, Run};
        let steps = [(false, true, false), (true, false, false), (true, true, false), (true, true, false)];
        assert_eq!(posted(false, &steps), (vec![Run, Active], Stage::Active));
        assert_eq!(
            posted(false, &[(true, true, false), (false, true, false), (true, true, false)]),
            (vec![Run, Active, Inactive, Idle, Run, Active], Stage::Active)
        );
        let done = [(true, true, true), (true, true, false), (false, true, false), (true, true, false)];
        assert_eq!(posted(false, &done), (vec![Run, Active, Inactive, Complete], Stage::Complete));
        assert_eq!(posted(true, &done[..2]), (vec![Run, Active, Inactive, Complete, Run, Active], Stage::Active));
    }
}
