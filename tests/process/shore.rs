//! Operators on shore control a game: they pause it, step it, slow it down, and make boats hold.

use crate::support::{FOUR, LIMIT, Sim, newest, own, result_of};
use bus::{Bus, Declaration, Watched};
use messages::run_state::{Phase, RunState};
use messages::topic::{self, GameName};
use messages::{Control, Frame};
use primitives::{codec, math};
use serde_json::Value;
use std::sync::Arc;

/// An operator on shore.
struct Shore {
    bus: Bus,
    name: GameName,
    run: Arc<Watched<RunState>>,
    frame: Arc<Watched<Frame>>,
    _standing: [Declaration; 2],
}

impl Shore {
    fn of(sim: &Sim) -> Shore {
        let bus = sim.bus();
        let name = sim.name();
        let (run, runs) = newest(&bus, topic::run(&name), |bytes| {
            serde_json::from_slice(bytes).expect("a state")
        });
        let (frame, frames) = newest(&bus, topic::frame(&name), |bytes| {
            codec::decode(bytes).expect("a frame")
        });
        Shore {
            bus,
            name,
            run,
            frame,
            _standing: [runs, frames],
        }
    }

    fn ask(&self, control: Control) {
        // Some of these requests are refused.
        drop(bus::control(&self.bus, &self.name, control));
    }

    fn wait_for_run(&self, what: &str, is_it: impl Fn(&RunState) -> bool) -> RunState {
        assert!(
            self.run.wait(LIMIT, is_it),
            "{what}: {:?}",
            self.run.visit(|run| run.clone())
        );
        self.run.visit(|run| run.clone())
    }

    fn wait_for_frame(&self, what: &str, is_it: impl Fn(&Frame) -> bool) {
        assert!(self.frame.wait(LIMIT, is_it), "{what}");
    }

    fn pause(&self) -> RunState {
        self.ask(Control::Pause);
        self.wait_for_run("it pauses", |run| run.phase == Phase::Paused)
    }
}

#[test]
fn a_paused_game_stands_still_is_stepped_and_goes_on_as_if_nothing_had_been() {
    let want = result_of(&[&own("pav01_120s"), "--in-process"])["digest"].clone();
    let sim = Sim::start("pav01_120s", &["--speed", "20x"]);
    let shore = Shore::of(&sim);
    let _agents = [sim.agent(&FOUR[..2]), sim.agent(&FOUR[2..])];
    sim.play_on(2.0);
    let paused_s = shore.pause().now_s;
    // The sim repeats that the game is paused, always with the same time.
    for _ in 0..5 {
        shore.run.visit(|run| run.now_s = -1.0);
        assert_eq!(
            shore
                .wait_for_run("it is told", |run| run.now_s >= 0.0)
                .now_s,
            paused_s
        );
    }
    for step in 1..=3 {
        shore.ask(Control::Step);
        let want_s = paused_s + 0.1 * f64::from(step);
        let is_there =
            |run: &RunState| (run.now_s - want_s).abs() < 1e-9 && run.phase == Phase::Paused;
        shore.wait_for_run("it plays one decision", is_there);
    }
    shore.ask(Control::Resume);
    shore.wait_for_run("it continues", |run| run.phase == Phase::Playing);
    shore.ask(Control::Speed(None));
    let done = sim.wait_for_kind("done");
    assert_eq!(
        done["outcome"]["digest"], want,
        "pauses are not part of a game"
    );
    assert_eq!(done["run"]["refused"]["out_of_place"], 0);
}

#[test]
fn a_game_goes_as_fast_as_it_is_asked_to() {
    for (pace, is_lockstep) in [("lockstep", true), ("realtime", false)] {
        let sim = Sim::start("long", &["--pace", pace]);
        let shore = Shore::of(&sim);
        let _agent = sim.agent(&FOUR);
        sim.play_on(0.5);
        shore.ask(Control::Speed(Some(3.0)));
        shore.wait_for_run("it runs at that speed", |run| {
            run.speed == Some(3.0) && (2.0..4.0).contains(&run.rate)
        });
        shore.ask(Control::Speed(Some(12.0)));
        shore.wait_for_run("it goes faster", |run| {
            run.speed == Some(12.0) && run.rate > 6.0
        });
        shore.ask(Control::Speed(None));
        shore.ask(Control::Step);
        let refused = if is_lockstep { 1 } else { 2 };
        let is_refused =
            |run: &RunState| run.refused == refused && run.speed.is_none() == is_lockstep;
        shore.wait_for_run("the impossible is refused", is_refused);
        sim.stop();
    }
}

#[test]
fn boats_hold_for_as_long_as_an_operator_wants_it() {
    let sim = Sim::start("long", &["--pace", "20x"]);
    let shore = Shore::of(&sim);
    let _agent = sim.agent(&FOUR);
    let speed = |frame: &Frame| {
        let speeds = frame
            .vehicles
            .iter()
            .map(|boat| math::length(boat.nav.surge_m_s, boat.nav.sway_m_s));
        speeds.fold(0.0, f64::max)
    };
    for (stop, go, stopped, gone_on) in [
        (Control::Halt, Control::GoOn, "halted", "went_on"),
        (Control::EStop, Control::Release, "e_stopped", "released"),
    ] {
        shore.wait_for_frame("they are under way", |frame| speed(frame) > 1.0);
        shore.ask(stop);
        sim.wait_for_event(stopped, Value::Null);
        shore.wait_for_frame("all stop", |frame| frame.stopped && speed(frame) < 0.1);
        shore.ask(go);
        sim.wait_for_event(gone_on, Value::Null);
    }
    // Resuming after a halt does not lift an E-stop.
    for control in [Control::Halt, Control::EStop, Control::GoOn] {
        shore.ask(control);
    }
    sim.wait_for_event("went_on", Value::Null);
    shore.wait_for_frame("they stay stopped", |frame| {
        frame.stopped && speed(frame) < 0.1
    });
    sim.stop();
}
