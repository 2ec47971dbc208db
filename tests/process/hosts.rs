//! Games on two machines whose cable is cut for a while.

use crate::support::FOUR;
use crate::two_hosts::Hosts;
use std::time::Duration;

#[test]
fn two_machines_play_a_game_and_survive_a_cable_that_is_cut() {
    let Some(hosts) = Hosts::connect() else {
        return;
    };
    let sim = hosts.sim("impatient", &[]);
    let mut blue = hosts.agent(0, &FOUR[..2]);
    let mut red = hosts.agent(1, &FOUR[2..]);
    sim.wait_for_kind("started");
    // Cut it briefly, then until both ends have closed the link, which zenoh does after ten
    // seconds.
    for cut_s in [2, 15] {
        sim.play_on(5.0);
        hosts.cable("down");
        // Longer than the sim's patience: the boats on the other machine lose their agents, and the
        // game continues.
        sim.wait_for_event("agent_lost", "red_one");
        sim.play_on(1.0);
        std::thread::sleep(Duration::from_secs(cut_s));
        hosts.cable("up");
        sim.wait_for_event("agent_back", "red_one");
    }
    sim.play_on(5.0);
    let done = sim.stop();
    assert_eq!(
        done["outcome"]["counts"]["boats"]["blue_one"]["agents_lost"], 0,
        "only the far side was cut off"
    );
    assert!(
        blue.wait().success() && red.wait().success(),
        "every node leaves without an error"
    );
}
