//! Tests every reachable state of the supervisor with every input: none leads to unintended thrust.

use super::*;

const GOOD: Conditions = Conditions {
    link: true,
    hung_s: None,
    control: None,
    nav: None,
    thrust: None,
    recovery_point: true,
    inside: true,
    battery_low: false,
    blocked: false,
    order_fresh: true,
    may_rearm: false,
};

/// Failsafe actions for the causes that allow one: all equal, and all different.
fn all_actions() -> Vec<FailsafeActions> {
    use FailsafeAction::{GoToErp, Standby, StationKeep};
    let of = |[order_stale, geofence, battery_low, hung]: [FailsafeAction; 4]| FailsafeActions {
        order_stale,
        geofence,
        battery_low,
        hung,
        // The bridge uses this, not the supervisor.
        rearm_within_s: 0.0,
    };
    [
        [Standby; 4],
        [StationKeep; 4],
        [GoToErp; 4],
        [StationKeep, GoToErp, Standby, GoToErp],
        [GoToErp, Standby, StationKeep, Standby],
    ]
    .map(of)
    .to_vec()
}

fn all_conditions() -> Vec<Conditions> {
    use ControlFault::{Deaf, Disobeyed, ForeignOrders, TakenOver, Unknown};
    let controls = [
        None,
        Some(Unknown),
        Some(TakenOver(5)),
        Some(Disobeyed('L')),
        Some(Deaf),
        Some(ForeignOrders),
    ];
    let mut all = Vec::new();
    for bits in 0..1024_u16 {
        let is = |bit: u16| bits & (1 << bit) != 0;
        let nav = is(1).then_some(NavFault::NoFix);
        let of = |control| Conditions {
            link: is(0),
            hung_s: is(6).then_some(0.5),
            control,
            nav,
            thrust: is(7).then_some(ThrustFault::NoWay(0.0)),
            recovery_point: is(8),
            inside: is(2),
            battery_low: is(3),
            blocked: is(4),
            order_fresh: is(5),
            may_rearm: is(9),
        };
        all.extend(controls.map(of));
    }
    all
}

fn all_requests() -> Vec<Option<OperatorRequest>> {
    let heading = BoatMode::Heading {
        heading_deg: 90.0,
        thrust_pct: 20.0,
    };
    let tasks = [
        Task::StationKeep,
        Task::GoToErp,
        Task::Mission,
        Task::Mode(heading),
        Task::Mode(BoatMode::RiverNav),
    ];
    let tasks = tasks.map(OperatorRequest::Delegate);
    let scopes = [Scope::Boat, Scope::Fleet];
    let stops = scopes.into_iter().flat_map(|scope| {
        [
            OperatorRequest::EStop(scope),
            OperatorRequest::Release(scope),
        ]
    });
    [OperatorRequest::Arm, OperatorRequest::Disarm]
        .into_iter()
        .chain(tasks)
        .chain(stops)
        .map(Some)
        .chain([None])
        .collect()
}

/// Calls `check` with every step from every reachable supervisor. Arguments: supervisor before,
/// conditions, request, supervisor after, step.
fn explore(
    mut check: impl FnMut(&Supervisor, &Conditions, Option<OperatorRequest>, &Supervisor, &Step),
) -> usize {
    let conditions = all_conditions();
    let requests = all_requests();
    let starts = all_actions()
        .into_iter()
        .flat_map(|actions| [true, false].map(|by_itself| (by_itself, actions)));
    let mut known: Vec<Supervisor> = starts
        .map(|(by_itself, actions)| Supervisor::new(by_itself, actions))
        .collect();
    let mut next = 0;
    while next < known.len() {
        let before = known[next].clone();
        for (now, request) in conditions
            .iter()
            .flat_map(|now| requests.iter().map(move |request| (now, *request)))
        {
            let mut after = before.clone();
            let step = after.step(now, request);
            check(&before, now, request, &after, &step);
            if !known.contains(&after) {
                known.push(after);
            }
        }
        next += 1;
    }
    known.len()
}

/// Whether the boat's own controller can execute a task, apart from other faults: link, control,
/// position, thrusters.
fn can_do(now: &Conditions, task: Task) -> bool {
    let has_place = task != Task::GoToErp || now.recovery_point;
    now.link && now.control.is_none() && now.nav.is_none() && now.thrust.is_none() && has_place
}

#[test]
fn no_path_leads_to_thrust_without_link_control_navigation_and_a_fresh_order() {
    let reached = explore(|before, now, request, after, step| {
        let case = format!("{before:?}, {now:?}, {request:?} -> {step:?}");
        if step.action == Action::Follow {
            assert_eq!(
                Conditions {
                    recovery_point: true,
                    may_rearm: false,
                    ..*now
                },
                GOOD,
                "{case}"
            );
            assert_eq!(
                (after.state, after.stops),
                (State::Armed, [false; 2]),
                "{case}"
            );
        }
        assert_eq!(
            after.state == State::Armed,
            matches!(step.action, Action::Follow) || is_held(after, now, step),
            "{case}"
        );
    });
    assert!(reached > 40, "only {reached} supervisors were reached");
}

fn is_held(after: &Supervisor, now: &Conditions, step: &Step) -> bool {
    after.state == State::Armed && now.blocked && step.action == Action::Zero
}

#[test]
fn only_an_explicit_command_arms_but_once_at_first_and_after_stale_orders() {
    explore(|before, now, request, after, step| {
        if after.state == State::Armed && before.state != State::Armed {
            let by_itself =
                before.arms_itself && before.state == State::Disarmed && !before.is_stopped();
            let again = now.may_rearm
                && matches!(
                    before.state,
                    State::Failsafe {
                        cause: Cause::OrderStale,
                        ..
                    }
                );
            let case = format!("{before:?}, {now:?}, {request:?} -> {step:?}");
            assert!(
                request == Some(OperatorRequest::Arm) || by_itself || again,
                "{case}"
            );
        }
        let used_up = before.state != State::Disarmed
            || !before.arms_itself
            || request.is_some()
            || after.state != State::Disarmed;
        assert_eq!(
            after.arms_itself, !used_up,
            "{before:?}, {now:?}, {request:?}"
        );
    });
}

#[test]
fn a_boat_is_delegated_only_by_request_and_while_it_is_fit() {
    explore(|before, now, request, after, step| {
        let State::Delegated(task) = after.state else {
            return;
        };
        let case = format!("{before:?}, {now:?}, {request:?} -> {step:?}");
        assert_eq!(step.action, Action::Task(task), "{case}");
        let disobeys = matches!(
            now.control,
            Some(ControlFault::Disobeyed(_) | ControlFault::Deaf)
        );
        let is_fit = can_do(now, task) || (disobeys && step.before.is_some());
        assert!(
            is_fit && now.hung_s.is_none() && now.inside && !now.battery_low,
            "{case}"
        );
        assert!(
            request == Some(OperatorRequest::Delegate(task))
                || before.state == State::Delegated(task),
            "{case}"
        );
    });
}

#[test]
fn after_a_failsafe_a_task_is_what_the_file_says_for_its_cause_and_needs_nothing_that_failed() {
    let mut tasks = 0;
    explore(|before, now, request, after, step| {
        let case = format!("{before:?}, {now:?}, {request:?} -> {step:?}");
        let State::Failsafe { cause, task } = after.state else {
            return;
        };
        let wanted = match cause {
            Cause::OrderStale => after.actions.order_stale,
            Cause::Geofence => after.actions.geofence,
            Cause::BatteryLow => after.actions.battery_low,
            Cause::Hung(_) => after.actions.hung,
            _ => FailsafeAction::Standby,
        };
        let wanted = match wanted {
            FailsafeAction::Standby => None,
            FailsafeAction::StationKeep => Some(Task::StationKeep),
            FailsafeAction::GoToErp => Some(Task::GoToErp),
        };
        let Some(task) = task else {
            assert_eq!(step.action, Action::Standby, "{case}");
            // A wanted task is missing only if the boat cannot execute it now, or could not before.
            let stays = before.state == after.state;
            assert!(
                stays || wanted.is_none_or(|task| !can_do(now, task)),
                "{case}"
            );
            return;
        };
        tasks += 1;
        assert_eq!(
            (step.action, wanted),
            (Action::Task(task), Some(task)),
            "{case}"
        );
        assert!(can_do(now, task) && !after.is_stopped(), "{case}");
        // A task after a failsafe starts only on a boat that was driven or delegated.
        let was_driven = matches!(
            before.state,
            State::Armed | State::Delegated(_) | State::Failsafe { task: Some(_), .. }
        );
        let asked = matches!(
            request,
            Some(OperatorRequest::Arm | OperatorRequest::Delegate(_))
        );
        assert!(was_driven || asked || before.arms_itself, "{case}");
        // Outside the geofence, the cause is the geofence.
        assert!(
            now.inside
                || cause == Cause::Geofence
                || step.before.is_none_or(|_| matches!(cause, Cause::Hung(_))),
            "{case}"
        );
    });
    assert!(tasks > 1000, "only {tasks}");
}

#[test]
fn an_e_stop_beats_everything_until_each_is_released_and_leaves_the_boat_disarmed() {
    explore(|before, now, request, after, step| {
        let case = format!("{before:?}, {now:?}, {request:?} -> {step:?}");
        let stopped = after.is_stopped();
        assert_eq!(stopped, after.state == State::EStopped, "{case}");
        if stopped {
            assert_eq!(step.action, Action::Standby, "{case}");
        }
        if before.state == State::EStopped && !stopped {
            assert!(
                matches!(request, Some(OperatorRequest::Release(_)))
                    && after.state == State::Disarmed,
                "{case}"
            );
        }
        for scope in [Scope::Boat, Scope::Fleet] {
            let now_on = after.stops[scope as usize];
            let want = match request {
                Some(OperatorRequest::EStop(whom)) if whom == scope => true,
                Some(OperatorRequest::Release(whom)) if whom == scope => false,
                _ => before.stops[scope as usize],
            };
            assert_eq!(now_on, want, "{case}");
        }
    });
}

#[test]
fn every_failsafe_is_reported_with_its_true_cause_and_brings_standby_or_a_task() {
    explore(|before, now, request, after, step| {
        let case = format!("{before:?}, {now:?}, {request:?} -> {step:?}");
        assert_eq!(
            step.before,
            (before.state != after.state).then_some(before.state),
            "{case}"
        );
        if let State::Failsafe { cause, .. } = after.state
            && before.state != after.state
        {
            let is_true = match cause {
                Cause::OrderStale => !now.order_fresh,
                Cause::Nav(_) => now.nav.is_some(),
                Cause::Thrust(_) => now.thrust.is_some(),
                Cause::Geofence => !now.inside,
                Cause::BatteryLow => now.battery_low,
                Cause::Control(fault) => now.control == Some(fault),
                Cause::NoRecoveryPoint => !now.recovery_point,
                Cause::LinkLost => !now.link,
                Cause::Hung(_) => now.hung_s.is_some(),
            };
            assert!(is_true, "{case}");
        }
        let at_rest = matches!(
            after.state,
            State::Disarmed | State::Failsafe { task: None, .. }
        );
        if at_rest {
            assert_eq!(step.action, Action::Standby, "{case}");
        }
    });
}

#[test]
fn a_refused_request_names_what_is_missing_and_changes_nothing_else() {
    explore(|before, now, request, after, step| {
        let Some(refusal) = &step.refusal else { return };
        let case = format!("{before:?}, {now:?}, {request:?} -> {step:?}");
        match refusal {
            Refusal::EStopped(_) => assert!(before.is_stopped() && after.is_stopped(), "{case}"),
            Refusal::NotReady(missing) => assert!(!missing.is_empty() && *now != GOOD, "{case}"),
        }
        let mut quiet = before.clone();
        let mut asked = before.clone();
        quiet.arms_itself = false;
        asked.arms_itself = false;
        quiet.step(now, None);
        asked.step(now, request);
        assert_eq!(quiet, asked, "{case}");
    });
}

#[test]
fn from_every_state_the_boat_can_be_armed_again() {
    explore(|before, _, _, _, _| {
        let mut supervisor = before.clone();
        supervisor.step(&GOOD, Some(OperatorRequest::Release(Scope::Boat)));
        supervisor.step(&GOOD, Some(OperatorRequest::Release(Scope::Fleet)));
        let step = supervisor.step(&GOOD, Some(OperatorRequest::Arm));
        assert_eq!(
            (step.action, step.refusal),
            (Action::Follow, None),
            "{before:?}"
        );
    });
}

#[test]
fn the_gravest_cause_is_the_one_that_is_reported() {
    let mut supervisor = Supervisor::new(false, all_actions()[0]);
    supervisor.step(&GOOD, Some(OperatorRequest::Arm));
    let bad = Conditions {
        link: false,
        control: Some(ControlFault::TakenOver(1)),
        order_fresh: false,
        ..GOOD
    };
    supervisor.step(&bad, None);
    assert_eq!(
        supervisor.state(),
        State::Failsafe {
            cause: Cause::LinkLost,
            task: None
        }
    );
    assert_eq!(
        Cause::Control(ControlFault::TakenOver(5)).to_string(),
        "the remote control has taken over"
    );
}
