//! Two machines: network namespaces joined by a cable.

use crate::support::{Process, Sim, stderr, token};
use bus::token::TOKEN_VARIABLE;
use std::ffi::OsStr;
use std::process::{Command, Stdio};
use std::sync::atomic::{AtomicUsize, Ordering};

/// The game's endpoint on the first host.
pub(crate) const ENDPOINT: &str = "tcp/10.77.0.1:7447";
pub(crate) const GAME: &str = "two-hosts";

/// Two hosts and the cable between them; removed when dropped.
pub(crate) struct Hosts {
    names: [String; 2],
    id: String,
}

fn ip(args: &str) -> Result<(), String> {
    let output = Command::new("ip")
        .args(args.split_whitespace())
        .output()
        .map_err(|e| format!("ip: {e}"))?;
    if output.status.success() {
        Ok(())
    } else {
        Err(format!("ip {args}: {}", stderr(&output).trim()))
    }
}

impl Hosts {
    /// Creates the hosts; prints the reason and returns `None` if this fails.
    pub(crate) fn connect() -> Option<Hosts> {
        let reason = match Hosts::try_connect() {
            Ok(hosts) => return Some(hosts),
            Err(reason) => reason,
        };
        eprintln!("skipped: cannot create network namespaces here: {reason}");
        None
    }

    fn try_connect() -> Result<Hosts, String> {
        static COUNT: AtomicUsize = AtomicUsize::new(0);
        let id = format!(
            "{}-{}",
            std::process::id(),
            COUNT.fetch_add(1, Ordering::Relaxed)
        );
        let hosts = Hosts {
            names: [format!("squall-a-{id}"), format!("squall-b-{id}")],
            id: id.clone(),
        };
        let [a, b] = &hosts.names;
        let va = format!("sqa{id}");
        let vb = format!("sqb{id}");
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

    pub(crate) fn cable(&self, state: &str) {
        ip(&format!(
            "-n {} link set sqb{} {state}",
            self.names[1], self.id
        ))
        .expect("the cable is there");
    }

    /// A command that runs on one of the hosts.
    pub(crate) fn command(&self, host: usize, program: impl AsRef<OsStr>) -> Command {
        let mut command = Command::new("ip");
        command
            .args(["netns", "exec", &self.names[host]])
            .arg(program);
        command
            .current_dir(env!("CARGO_MANIFEST_DIR"))
            .env(TOKEN_VARIABLE, token().hex());
        command
    }

    fn squall(&self, host: usize) -> Command {
        self.command(host, env!("CARGO_BIN_EXE_squall"))
    }

    /// Serves a game on the first host, reachable from the second.
    pub(crate) fn sim(&self, scenario: &str, args: &[&str]) -> Sim {
        let args = [&["--game", GAME, "--listen", ENDPOINT, "--insecure"], args].concat();
        Sim::start_with(self.squall(0), scenario, &args)
    }

    pub(crate) fn agent(&self, host: usize, vehicles: &[&str]) -> Process {
        let mut command = self.squall(host);
        command
            .args(["agent", "--connect", ENDPOINT, "--game", GAME, "--vehicle"])
            .args(vehicles);
        command.stdout(Stdio::null());
        Process::start(command)
    }
}

impl Drop for Hosts {
    fn drop(&mut self) {
        for name in &self.names {
            // Ignore the error: the namespace may not exist.
            let _ = ip(&format!("netns del {name}"));
        }
    }
}
