//! Two machines: network namespaces joined by a cable, which is cut for a while.

use crate::support::{FOUR, Process, Sim, stderr, token};
use bus::token::TOKEN_VARIABLE;
use std::process::{Command, Stdio};
use std::time::Duration;

/// Two hosts and the cable between them; gone with the test.
struct Hosts {
    names: [String; 2],
}

fn ip(args: &str) -> Result<(), String> {
    let output = Command::new("ip").args(args.split_whitespace()).output().map_err(|e| format!("ip: {e}"))?;
    if output.status.success() { Ok(()) } else { Err(format!("ip {args}: {}", stderr(&output).trim())) }
}

impl Hosts {
    fn connect() -> Result<Hosts, String> {
        let id = std::process::id();
        let hosts = Hosts { names: [format!("squall-a-{id}"), format!("squall-b-{id}")] };
        let [a, b] = &hosts.names;
        let (va, vb) = (format!("sqa{id}"), format!("sqb{id}"));
        for command in [
            format!("netns add {a}"),
            format!("netns add {b}"),
            format!("link add {va} netns {a} type veth peer name {vb} netns {b}"),
            format!("-n {a} addr add 10.77.0.1/24 dev {va}"),
            format!("-n {b} addr add 10.77.0.2/24 dev {vb}"),
            format!("-n {a} link set {va} up"),
            format!("-n {b} link set {vb} up"),
            format!("-n {a} link set lo up"),
            format!("-n {b} link set lo up"),
        ] {
            ip(&command)?;
        }
        Ok(hosts)
    }

    fn cable(&self, state: &str) {
        let id = std::process::id();
        ip(&format!("-n {} link set sqb{id} {state}", self.names[1])).expect("the cable is there");
    }

    /// The program on one of the hosts.
    fn squall(&self, host: usize) -> Command {
        let mut command = Command::new("ip");
        command.args(["netns", "exec", &self.names[host], env!("CARGO_BIN_EXE_squall")]);
        command.current_dir(env!("CARGO_MANIFEST_DIR")).env(TOKEN_VARIABLE, token().hex());
        command
    }

    fn agent(&self, host: usize, game: &str, vehicles: &[&str]) -> Process {
        let mut command = self.squall(host);
        command.args(["agent", "--connect", "tcp/10.77.0.1:7447", "--game", game, "--vehicle"]).args(vehicles);
        command.stdout(Stdio::null());
        Process::start(command)
    }
}

impl Drop for Hosts {
    fn drop(&mut self) {
        for name in &self.names {
            // What was never made cannot be removed.
            let _ = ip(&format!("netns del {name}"));
        }
    }
}

#[test]
fn two_machines_play_a_game_and_survive_a_cable_that_is_cut() {
    let hosts = match Hosts::connect() {
        Ok(hosts) => hosts,
        Err(reason) => {
            eprintln!("skipped: network namespaces cannot be made here: {reason}");
            return;
        }
    };
    let args = ["--game", "two-hosts", "--listen", "tcp/10.77.0.1:7447", "--insecure"];
    let sim = Sim::start_with(hosts.squall(0), "impatient", &args);
    let mut blue = hosts.agent(0, "two-hosts", &FOUR[..2]);
    let mut red = hosts.agent(1, "two-hosts", &FOUR[2..]);
    sim.wait_for_kind("started");
    // For a moment, and until both ends have given the link up: zenoh does after ten seconds.
    for cut_s in [2, 15] {
        sim.play_on(5.0);
        hosts.cable("down");
        // Longer than the sim's patience: the boats over there are without an agent, the game goes on.
        sim.wait_for_event("agent_lost", "red_one");
        sim.play_on(1.0);
        std::thread::sleep(Duration::from_secs(cut_s));
        hosts.cable("up");
        sim.wait_for_event("agent_back", "red_one");
    }
    sim.play_on(5.0);
    let done = sim.stop();
    assert_eq!(done["outcome"]["counts"]["boats"]["blue_one"]["agents_lost"], 0, "only the far side was cut off");
    assert!(blue.wait().success() && red.wait().success(), "everybody leaves in peace");
}
