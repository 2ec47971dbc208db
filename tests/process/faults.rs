//! Nodes that die or fall silent: the game continues, and no node waits forever.

use crate::support::{FOUR, Process, Sim, squall};
use std::time::Instant;

fn game(pace: &str) -> (Sim, Vec<Process>) {
    Sim::start_with_agents("impatient", &["--pace", pace])
}

/// The agents exit with an error that names the cause.
fn expect_sim_gone(agents: &mut [Process]) {
    for agent in agents {
        let said = agent.refusal();
        assert!(said.contains("lost the sim"), "{said}");
    }
}

#[test]
fn a_killed_agents_boat_holds_until_a_new_agent_takes_over() {
    for pace in ["lockstep", "20x"] {
        let (sim, mut agents) = game(pace);
        sim.play_on(5.0);
        agents[1].kill();
        let killed = Instant::now();
        sim.wait_for_event("agent_lost", "blue_two");
        // Patience is 2 s; the rest allows for a busy machine.
        assert!(
            killed.elapsed().as_secs_f64() < 12.0,
            "{pace}: lost after {:?}",
            killed.elapsed()
        );
        sim.play_on(5.0);
        agents[1] = sim.agent(&["blue_two"]);
        sim.wait_for_event("agent_back", "blue_two");
        sim.play_on(5.0);
        let done = sim.stop();
        assert_eq!(
            done["outcome"]["counts"]["boats"]["blue_two"]["agents_lost"], 1,
            "{pace}"
        );
        assert_eq!(
            done["outcome"]["counts"]["boats"]["blue_one"]["agents_lost"], 0,
            "{pace}"
        );
        assert!(
            agents.iter_mut().all(|agent| agent.wait().success()),
            "{pace}: they leave without an error"
        );
    }
}

#[test]
fn a_hung_agent_is_dropped_after_the_patience_and_may_return() {
    for pace in ["lockstep", "20x"] {
        let (sim, agents) = game(pace);
        sim.play_on(2.0);
        agents[2].signal("STOP");
        let hung = Instant::now();
        sim.wait_for_event("agent_lost", "red_one");
        assert!(
            hung.elapsed().as_secs_f64() > 1.5,
            "{pace}: patience was {:?}",
            hung.elapsed()
        );
        sim.play_on(2.0);
        agents[2].signal("CONT");
        sim.wait_for_event("agent_back", "red_one");
        sim.play_on(2.0);
        sim.stop();
    }
}

#[test]
fn agents_report_a_killed_sim_and_fail() {
    let (mut sim, mut agents) = game("lockstep");
    sim.play_on(2.0);
    sim.process.kill();
    let killed = Instant::now();
    expect_sim_gone(&mut agents);
    // The documented limit is five seconds; the rest allows for a busy machine.
    assert!(
        killed.elapsed().as_secs_f64() < 17.0,
        "{:?}",
        killed.elapsed()
    );
}

#[test]
fn an_agent_does_not_stay_with_a_sim_that_never_let_it_in() {
    let (mut sim, mut agents) = game("lockstep");
    sim.play_on(2.0);
    let endpoint = sim.endpoint.clone();
    let name = sim.game.clone();
    sim.process.kill();
    let next = Sim::start_with(
        squall(&[]),
        "impatient",
        &["--listen", &endpoint, "--game", &name],
    );
    // Pictures resume: an agent that checks nothing else would stay.
    let _others = FOUR.map(|vehicle| next.agent(&[vehicle]));
    next.wait_for_kind("started");
    expect_sim_gone(&mut agents);
    next.stop();
}

#[test]
fn a_taken_seat_stays_taken() {
    let (sim, _agents) = game("lockstep");
    let said = sim.refusal_of(&["agent", "--wait-s", "1", "--vehicle", "blue_one"]);
    assert!(said.contains("another agent controls blue_one"), "{said}");
    // A vehicle that does not exist has none.
    let said = sim.refusal_of(&["agent", "--vehicle", "green_one"]);
    assert!(
        said.contains("green_one") && said.contains("blue_one, blue_two, red_one, red_two"),
        "{said}"
    );
    sim.stop();
}
