//! Child processes of `run`, none of which outlives it.

use anyhow::{Context, Result};
use bus::keys::Identity;
use bus::token::TOKEN_VARIABLE;
use bus::{Token, clock};
use std::fmt::Display;
use std::io::{BufRead, BufReader, Write};
use std::path::Path;
use std::process::{Child, ChildStdin, Command, Stdio};
use std::sync::LazyLock;
use std::sync::mpsc::{Receiver, sync_channel};
use std::time::Duration;

/// A command that starts this program with other arguments.
pub(crate) fn squall(args: &[&str]) -> Result<Command> {
    squall_with(bus::RUNTIME, args)
}

/// A command that starts this program with these zenoh thread settings.
pub(crate) fn squall_with(runtime: &str, args: &[&str]) -> Result<Command> {
    let mut command =
        Command::new(std::env::current_exe().context("cannot find this program's executable")?);
    if std::env::var_os(bus::RUNTIME_VARIABLE).is_none() {
        command.env(bus::RUNTIME_VARIABLE, runtime);
    }
    command.env(TOKEN_VARIABLE, token().hex());
    command.args(args).arg("--for-parent");
    Ok(command)
}

/// Checks the token in the environment, if any.
pub(crate) fn check_token() -> Result<()> {
    std::env::var(TOKEN_VARIABLE).map_or(Ok(()), |text| {
        text.parse::<Token>().map(drop).context(TOKEN_VARIABLE)
    })
}

/// The token of the games that this process's children serve and join: the one in the environment,
/// otherwise a new one.
pub(crate) fn token() -> &'static Token {
    static TOKEN: LazyLock<Token> = LazyLock::new(|| {
        let given = std::env::var(TOKEN_VARIABLE)
            .ok()
            .and_then(|text| text.parse().ok());
        given.unwrap_or_else(Token::random)
    });
    &TOKEN
}

/// Passes a command the keys for this role from a folder, if any, in place of the token.
pub(crate) fn give_keys(command: &mut Command, folder: Option<&Path>, identity: &Identity) {
    if let Some(folder) = folder {
        command
            .env_remove(TOKEN_VARIABLE)
            .arg("--keys")
            .arg(folder.join(identity.to_string()));
    }
}

/// Adds an option if it has a value.
pub(crate) fn option(command: &mut Command, name: &str, value: Option<impl Display>) {
    if let Some(value) = value {
        command.args([name, &value.to_string()]);
    }
}

/// A child process. It exits when its standard input closes, which happens when this process dies.
pub(crate) struct ChildProcess {
    name: String,
    child: Child,
    stdin: Option<ChildStdin>,
}

impl ChildProcess {
    /// Starts a command with this standard output.
    pub(crate) fn start(name: &str, mut command: Command, stdout: Stdio) -> Result<ChildProcess> {
        let mut child = command
            .stdin(Stdio::piped())
            .stdout(stdout)
            .spawn()
            .with_context(|| format!("cannot start {name}"))?;
        let stdin = child.stdin.take();
        Ok(ChildProcess {
            name: name.to_owned(),
            child,
            stdin,
        })
    }

    /// The lines of the child's piped output that `parse` accepts. Can be called only once. The
    /// lines end when the child does.
    pub(crate) fn lines<T: Send + 'static>(
        &mut self,
        parse: fn(&str) -> Option<T>,
    ) -> Result<Receiver<T>> {
        let output = self
            .child
            .stdout
            .take()
            .with_context(|| format!("{} has no output", self.name))?;
        let (sender, receiver) = sync_channel(1024);
        std::thread::spawn(move || {
            let lines = BufReader::new(output)
                .lines()
                .map_while(std::result::Result::ok);
            // Keep reading even without a receiver, so that the child is not blocked.
            lines
                .filter_map(|line| parse(&line))
                .for_each(|item| sender.send(item).unwrap_or_default());
        });
        Ok(receiver)
    }

    /// `None` while it is running; afterwards its error, or `Some(None)` for success.
    pub(crate) fn ended(&mut self) -> Option<Option<String>> {
        let status = self.child.try_wait().ok().flatten()?;
        Some((!status.success()).then(|| format!("{} failed: {status}", self.name)))
    }

    /// Sends a line to the child's standard input.
    ///
    /// # Errors
    /// If the child no longer reads input.
    pub(crate) fn send(&mut self, line: &str) -> Result<()> {
        let name = &self.name;
        let mut stdin = self
            .stdin
            .as_ref()
            .with_context(|| format!("{name} is stopping"))?;
        writeln!(stdin, "{line}").with_context(|| format!("{name} does not accept input"))
    }

    /// Asks the child to stop.
    pub(crate) fn ask_to_stop(&mut self) {
        self.stdin = None;
    }

    /// Asks the child to stop and waits; returns the error if it failed.
    pub(crate) fn stop(&mut self) -> Vec<String> {
        self.ask_to_stop();
        wait_for_all(std::slice::from_mut(self))
    }
}

impl Drop for ChildProcess {
    fn drop(&mut self) {
        // A process that has already ended cannot be killed; the wait only reaps it.
        drop(self.child.kill());
        drop(self.child.wait());
    }
}

/// Waits at most five seconds for all children to end. Returns the failures, including children
/// that are still running: dropping these kills them.
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
            None => badly.push(format!("{} did not exit and was killed", child.name)),
        }
    }
    badly
}
