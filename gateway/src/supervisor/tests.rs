//! Every state the machine can reach, with every input: nothing leads to thrust that should not.

use super::*;

const GOOD: Conditions = Conditions {
    link: true,
    control: Control::Granted,
    nav: None,
    inside: true,
    battery_low: false,
    blocked: false,
    order_fresh: true,
};

const BATTERIES: [LowBattery; 3] = [LowBattery::Standby, LowBattery::StationKeep, LowBattery::GoToErp];

fn all_conditions() -> Vec<Conditions> {
    let controls = [Control::Granted, Control::Unknown, Control::Other(5), Control::Disobeys('L')];
    let mut all = Vec::new();
    for bits in 0..64_u8 {
        let is = |bit: u8| bits & (1 << bit) != 0;
        let nav = is(1).then_some(NavFault::NoFix);
        let of = |control| Conditions {
            link: is(0),
            control,
            nav,
            inside: is(2),
            battery_low: is(3),
            blocked: is(4),
            order_fresh: is(5),
        };
        all.extend(controls.map(of));
    }
    all
}

fn all_wishes() -> Vec<Option<Wish>> {
    let tasks = [Task::StationKeep, Task::GoToErp, Task::Mission].map(Wish::Delegate);
    let reaches = [Reach::Boat, Reach::Fleet];
    let stops = reaches.into_iter().flat_map(|reach| [Wish::EStop(reach), Wish::Release(reach)]);
    [Wish::Arm, Wish::Disarm].into_iter().chain(tasks).chain(stops).map(Some).chain([None]).collect()
}

/// Calls `check` with every step from every machine that can be reached: before, inputs, after, what it brought.
fn explore(mut check: impl FnMut(&Supervisor, &Conditions, Option<Wish>, &Supervisor, &Step)) -> usize {
    let (conditions, wishes) = (all_conditions(), all_wishes());
    let starts = BATTERIES.into_iter().flat_map(|battery| [true, false].map(|by_itself| (by_itself, battery)));
    let mut known: Vec<Supervisor> = starts.map(|(by_itself, battery)| Supervisor::new(by_itself, battery)).collect();
    let mut next = 0;
    while next < known.len() {
        let before = known[next].clone();
        for (now, wish) in conditions.iter().flat_map(|now| wishes.iter().map(move |wish| (now, *wish))) {
            let mut after = before.clone();
            let step = after.step(now, wish);
            check(&before, now, wish, &after, &step);
            if !known.contains(&after) {
                known.push(after);
            }
        }
        next += 1;
    }
    known.len()
}

/// Whether the boat may be told to move by its own means now; `at_low_battery` is whether this task is meant for one.
fn is_fit(now: &Conditions, at_low_battery: bool) -> bool {
    let listens = matches!(now.control, Control::Granted | Control::Disobeys(_));
    now.link && listens && now.nav.is_none() && now.inside && (!now.battery_low || at_low_battery)
}

#[test]
fn no_path_leads_to_thrust_without_link_control_navigation_and_a_fresh_order() {
    let reached = explore(|before, now, wish, after, step| {
        let case = format!("{before:?}, {now:?}, {wish:?} -> {step:?}");
        if step.action == Action::Follow {
            assert_eq!(*now, GOOD, "{case}");
            assert_eq!((after.state, after.stops), (State::Armed, [false; 2]), "{case}");
        }
        assert_eq!(
            after.state == State::Armed,
            matches!(step.action, Action::Follow) || is_held(after, now, step),
            "{case}"
        );
    });
    assert!(reached > 40, "only {reached} machines were reached");
}

fn is_held(after: &Supervisor, now: &Conditions, step: &Step) -> bool {
    after.state == State::Armed && now.blocked && step.action == Action::Zero
}

#[test]
fn only_an_explicit_command_arms_and_only_once_by_itself() {
    explore(|before, now, wish, after, step| {
        if after.state == State::Armed && before.state != State::Armed {
            let by_itself = before.arms_itself && before.state == State::Safed && !before.is_stopped();
            assert!(wish == Some(Wish::Arm) || by_itself, "{before:?}, {now:?}, {wish:?} -> {step:?}");
        }
        let used_up =
            before.state != State::Safed || !before.arms_itself || wish.is_some() || after.state != State::Safed;
        assert_eq!(after.arms_itself, !used_up, "{before:?}, {now:?}, {wish:?}");
    });
}

#[test]
fn a_boat_sails_by_itself_only_when_asked_or_when_its_battery_is_low() {
    explore(|before, now, wish, after, step| {
        let State::Delegated(task) = after.state else {
            assert!(!matches!(step.action, Action::Task(_)));
            return;
        };
        let case = format!("{before:?}, {now:?}, {wish:?} -> {step:?}");
        assert_eq!(step.action, Action::Task(task), "{case}");
        let for_low = after.low_battery_task() == Some(task) && now.battery_low;
        assert!(is_fit(now, for_low), "{case}");
        let driven = matches!(before.state, State::Armed | State::Delegated(_)) || wish == Some(Wish::Arm);
        let asked = wish == Some(Wish::Delegate(task)) || before.state == State::Delegated(task);
        assert!(asked || (driven || matches!(wish, Some(Wish::Delegate(_)))) && for_low, "{case}");
    });
}

#[test]
fn an_e_stop_beats_everything_until_each_is_released_and_leaves_the_boat_safed() {
    explore(|before, now, wish, after, step| {
        let case = format!("{before:?}, {now:?}, {wish:?} -> {step:?}");
        let stopped = after.is_stopped();
        assert_eq!(stopped, after.state == State::EStopped, "{case}");
        if stopped {
            assert_eq!(step.action, Action::Standby, "{case}");
        }
        if before.state == State::EStopped && !stopped {
            assert!(matches!(wish, Some(Wish::Release(_))) && after.state == State::Safed, "{case}");
        }
        for reach in [Reach::Boat, Reach::Fleet] {
            let now_on = after.stops[reach as usize];
            let want = match wish {
                Some(Wish::EStop(whom)) if whom == reach => true,
                Some(Wish::Release(whom)) if whom == reach => false,
                _ => before.stops[reach as usize],
            };
            assert_eq!(now_on, want, "{case}");
        }
    });
}

#[test]
fn whatever_stops_a_boat_is_told_and_true_and_brings_standby() {
    explore(|before, now, wish, after, step| {
        let case = format!("{before:?}, {now:?}, {wish:?} -> {step:?}");
        assert_eq!(step.before, (before.state != after.state).then_some(before.state), "{case}");
        if let State::Failsafe(cause) = after.state
            && before.state != after.state
        {
            let is_true = match cause {
                Cause::OrderStale => !now.order_fresh,
                Cause::Nav(_) => now.nav.is_some(),
                Cause::Geofence => !now.inside,
                Cause::BatteryLow => now.battery_low,
                Cause::TakenOver(by) => now.control == Control::Other(by),
                Cause::ControlUnknown => now.control == Control::Unknown,
                Cause::Disobeyed(mode) => now.control == Control::Disobeys(mode),
                Cause::LinkLost => !now.link,
            };
            assert!(is_true, "{case}");
        }
        let at_rest = matches!(after.state, State::Safed | State::Failsafe(_));
        if at_rest {
            assert_eq!(step.action, Action::Standby, "{case}");
        }
    });
}

#[test]
fn a_refused_wish_says_what_is_missing_and_changes_nothing_else() {
    explore(|before, now, wish, after, step| {
        let Some(refusal) = &step.refusal else { return };
        let case = format!("{before:?}, {now:?}, {wish:?} -> {step:?}");
        match refusal {
            Refusal::EStopped => assert!(before.is_stopped() && after.is_stopped(), "{case}"),
            Refusal::NotReady(missing) => assert!(!missing.is_empty() && *now != GOOD, "{case}"),
        }
        let (mut quiet, mut asked) = (before.clone(), before.clone());
        quiet.arms_itself = false;
        asked.arms_itself = false;
        quiet.step(now, None);
        asked.step(now, wish);
        assert_eq!(quiet, asked, "{case}");
    });
}

#[test]
fn from_every_state_the_boat_can_be_armed_again() {
    explore(|before, _, _, _, _| {
        let mut machine = before.clone();
        machine.step(&GOOD, Some(Wish::Release(Reach::Boat)));
        machine.step(&GOOD, Some(Wish::Release(Reach::Fleet)));
        let step = machine.step(&GOOD, Some(Wish::Arm));
        assert_eq!((step.action, step.refusal), (Action::Follow, None), "{before:?}");
    });
}

#[test]
fn the_gravest_cause_is_the_one_that_is_told() {
    let mut machine = Supervisor::new(false, LowBattery::Standby);
    machine.step(&GOOD, Some(Wish::Arm));
    let bad = Conditions { link: false, control: Control::Other(1), order_fresh: false, ..GOOD };
    machine.step(&bad, None);
    assert_eq!(machine.state(), State::Failsafe(Cause::LinkLost));
    assert_eq!(Cause::TakenOver(5).to_string(), "the remote control has taken over");
}
