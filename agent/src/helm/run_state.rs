//! The run state of a behaviour: idle, running, active or complete.

use messages::helm::RunState;
use primitives::SimTime;
use scenario::strategy::Moment;

/// A behaviour's run state, and the start of its current run.
#[derive(Clone, Copy, Debug)]
pub(crate) struct BehaviourRun {
    pub(crate) state: RunState,
    /// When the behaviour last started running.
    since: SimTime,
}

impl BehaviourRun {
    pub(crate) fn new() -> BehaviourRun {
        BehaviourRun {
            state: RunState::Idle,
            since: SimTime::ZERO,
        }
    }

    /// Allows or forbids running. Returns whether the behaviour starts running now.
    pub(crate) fn allow(
        &mut self,
        may_run: bool,
        now: SimTime,
        mut post: impl FnMut(Moment),
    ) -> bool {
        match (self.state, may_run) {
            (RunState::Idle, true) => {
                (self.state, self.since) = (RunState::Running, now);
                post(Moment::Run);
                true
            }
            (RunState::Running | RunState::Active, false) => {
                if self.state == RunState::Active {
                    post(Moment::Inactive);
                }
                post(Moment::Idle);
                self.state = RunState::Idle;
                false
            }
            _ => false,
        }
    }

    /// Whether the behaviour is running.
    pub(crate) fn runs(&self) -> bool {
        matches!(self.state, RunState::Running | RunState::Active)
    }

    /// How long the behaviour has been running.
    pub(crate) fn running_s(&self, now: SimTime) -> f64 {
        (now - self.since).as_s()
    }

    /// Records whether the behaviour produced a function.
    pub(crate) fn produced(&mut self, active: bool, mut post: impl FnMut(Moment)) {
        match (self.state, active) {
            (RunState::Running, true) => {
                self.state = RunState::Active;
                post(Moment::Active);
            }
            (RunState::Active, false) => {
                self.state = RunState::Running;
                post(Moment::Inactive);
            }
            _ => {}
        }
    }

    /// Ends a run. A perpetual behaviour restarts at the next decision.
    pub(crate) fn complete(&mut self, perpetual: bool, mut post: impl FnMut(Moment)) {
        if self.state == RunState::Active {
            post(Moment::Inactive);
        }
        post(Moment::Complete);
        self.state = if perpetual {
            RunState::Idle
        } else {
            RunState::Complete
        };
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The moments posted for given steps of (may run, active, complete).
    fn posted(perpetual: bool, steps: &[(bool, bool, bool)]) -> (Vec<Moment>, RunState) {
        let mut run = BehaviourRun::new();
        let mut moments = vec![];
        for (i, (may_run, active, complete)) in steps.iter().enumerate() {
            run.allow(*may_run, SimTime(i as i64), |moment| moments.push(moment));
            if run.runs() {
                run.produced(*active, |moment| moments.push(moment));
            }
            if run.runs() && *complete {
                run.complete(perpetual, |moment| moments.push(moment));
            }
        }
        (moments, run.state)
    }

    #[test]
    fn every_change_of_run_state_is_posted_once() {
        use Moment::{Active, Complete, Idle, Inactive, Run};
        let steps = [
            (false, true, false),
            (true, false, false),
            (true, true, false),
            (true, true, false),
        ];
        assert_eq!(posted(false, &steps), (vec![Run, Active], RunState::Active));
        assert_eq!(
            posted(
                false,
                &[
                    (true, true, false),
                    (false, true, false),
                    (true, true, false)
                ]
            ),
            (
                vec![Run, Active, Inactive, Idle, Run, Active],
                RunState::Active
            )
        );
        let done = [
            (true, true, true),
            (true, true, false),
            (false, true, false),
            (true, true, false),
        ];
        assert_eq!(
            posted(false, &done),
            (vec![Run, Active, Inactive, Complete], RunState::Complete)
        );
        assert_eq!(
            posted(true, &done[..2]),
            (
                vec![Run, Active, Inactive, Complete, Run, Active],
                RunState::Active
            )
        );
    }
}
