//! The processes that `run` starts: none of them outlives it.

use anyhow::{Context, Result};
use bus::keys::Identity;
use bus::token::TOKEN_VARIABLE;
use bus::{Token, clock};
use std::fmt::Display;
use std::io::{BufRead, BufReader, Write};
use std::path::{Path, PathBuf};
use std::process::{Child, ChildStdin, Command, Stdio};
use std::sync::LazyLock;
use std::sync::mpsc::{Receiver, sync_channel};
use std::time::Duration;

/// This program with other arguments, to be started as a child.
pub(crate) fn squall(args: &[&str]) -> Result<Command> {
    squall_with(bus::RUNTIME, args)
}

/// The file of this program.
pub(crate) fn own_program() -> Result<PathBuf> {
    std::env::current_exe().context("cannot find this program's own file")
}

/// The same, with these threads of zenoh.
pub(crate) fn squall_with(runtime: &str, args: &[&str]) -> Result<Command> {
    let mut command = Command::new(own_program()?);
    if std::env::var_os(bus::RUNTIME_VARIABLE).is_none() {
        command.env(bus::RUNTIME_VARIABLE, runtime);
    }
    command.env(TOKEN_VARIABLE, token().hex());
    command.args(args).arg("--for-parent");
    Ok(command)
}

/// The token of the games that children of this process serve and join: a new one, unless one is given.
pub(crate) fn token() -> &'static Token {
    static TOKEN: LazyLock<Token> = LazyLock::new(|| {
        let given = std::env::var(TOKEN_VARIABLE).ok().and_then(|text| text.parse().ok());
        given.unwrap_or_else(Token::random)
    });
    &TOKEN
}

/// Gives a command the keys of this part out of a folder of them, if there is one. It needs no token then.
pub(crate) fn give_keys(command: &mut Command, folder: Option<&Path>, identity: &Identity) {
    if let Some(folder) = folder {
        command.env_remove(TOKEN_VARIABLE).arg("--keys").arg(folder.join(identity.to_string()));
    }
}

/// Adds an option, if it has a value.
pub(crate) fn option(command: &mut Command, name: &str, value: Option<impl Display>) {
    if let Some(value) = value {
        command.args([name, &value.to_string()]);
    }
}

/// One child. It stops when its standard input ends, which the death of this process sees to.
pub(crate) struct ChildProcess {
    name: String,
    child: Child,
    stdin: Option<ChildStdin>,
}

impl ChildProcess {
    /// Starts a command; its output goes where `stdout` says.
    pub(crate) fn start(name: &str, mut command: Command, stdout: Stdio) -> Result<ChildProcess> {
        let mut child =
            command.stdin(Stdio::piped()).stdout(stdout).spawn().with_context(|| format!("cannot start {name}"))?;
        let stdin = child.stdin.take();
        Ok(ChildProcess { name: name.to_owned(), child, stdin })
    }

    /// What `parse` makes of the lines of the child's piped output, once. It ends with the child.
    pub(crate) fn lines<T: Send + 'static>(&mut self, parse: fn(&str) -> Option<T>) -> Result<Receiver<T>> {
        let output = self.child.stdout.take().with_context(|| format!("{} has no output", self.name))?;
        let (sender, receiver) = sync_channel(1024);
        std::thread::spawn(move || {
            let lines = BufReader::new(output).lines().map_while(std::result::Result::ok);
            // The child must be able to print more, whether or not somebody still listens.
            lines.filter_map(|line| parse(&line)).for_each(|item| sender.send(item).unwrap_or_default());
        });
        Ok(receiver)
    }

    /// Whether it has ended, and how badly: `Some(None)` is well.
    pub(crate) fn ended(&mut self) -> Option<Option<String>> {
        let status = self.child.try_wait().ok().flatten()?;
        Some((!status.success()).then(|| format!("{} ended with {status}", self.name)))
    }

    /// Sends it a line.
    ///
    /// # Errors
    /// If it does not listen any more.
    pub(crate) fn send(&mut self, line: &str) -> Result<()> {
        let name = &self.name;
        let mut stdin = self.stdin.as_ref().with_context(|| format!("{name} was asked to stop"))?;
        writeln!(stdin, "{line}").with_context(|| format!("{name} does not listen"))
    }

    /// Asks it to stop.
    pub(crate) fn ask_to_stop(&mut self) {
        self.stdin = None;
    }

    /// Asks it to stop and waits for that; says so if it ended badly.
    pub(crate) fn stop(&mut self) -> Vec<String> {
        self.ask_to_stop();
        wait_for_all(std::slice::from_mut(self))
    }
}

impl Drop for ChildProcess {
    fn drop(&mut self) {
        // Whoever has ended already cannot be killed; the wait then only collects it.
        drop(self.child.kill());
        drop(self.child.wait());
    }
}

/// Waits until all have ended, but no longer than five seconds; gives who ended badly.
pub(crate) fn wait_for_all(children: &mut [ChildProcess]) -> Vec<String> {
    const LIMIT: Duration = Duration::from_secs(5);
    let start = clock::now();
    let mut badly = Vec::new();
    for child in children {
        while child.ended().is_none() && clock::since(start) < LIMIT {
            clock::rest(Duration::from_millis(5));
        }
        match child.ended() {
            Some(outcome) => badly.extend(outcome),
            None => badly.push(format!("{} did not end and was killed", child.name)),
        }
    }
    badly
}
