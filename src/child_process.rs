//! The processes that `run` starts: none of them outlives it.

use anyhow::{Context, Result};
use std::io::Write;
use std::process::{Child, ChildStdin, Command, Stdio};
use std::time::{Duration, Instant};

/// One child. It stops when its standard input ends, which the death of this process sees to.
pub(crate) struct ChildProcess {
    name: String,
    child: Child,
    life_line: Option<ChildStdin>,
}

impl ChildProcess {
    /// Starts this program with other arguments; its output goes where `stdout` says.
    pub(crate) fn start(name: &str, args: &[String], stdout: Stdio) -> Result<ChildProcess> {
        let program = std::env::current_exe().context("cannot find this program's own file")?;
        let mut command = Command::new(program);
        if std::env::var_os("ZENOH_RUNTIME").is_none() {
            command.env("ZENOH_RUNTIME", bus::RUNTIME);
        }
        command.args(args).stdin(Stdio::piped()).stdout(stdout);
        let mut child = command.spawn().with_context(|| format!("cannot start {name}"))?;
        let life_line = child.stdin.take();
        Ok(ChildProcess { name: name.to_owned(), child, life_line })
    }

    /// The child's output, once.
    pub(crate) fn output(&mut self) -> Option<std::process::ChildStdout> {
        self.child.stdout.take()
    }

    /// Whether it has ended, and how badly: `Some(None)` is well.
    pub(crate) fn ended(&mut self) -> Option<Option<String>> {
        let status = self.child.try_wait().ok().flatten()?;
        Some((!status.success()).then(|| format!("{} ended with {status}", self.name)))
    }

    /// Tells it a line.
    ///
    /// # Errors
    /// If it does not listen any more.
    pub(crate) fn tell(&mut self, line: &str) -> Result<()> {
        let name = &self.name;
        let mut said = self.life_line.as_ref().with_context(|| format!("{name} was asked to stop"))?;
        writeln!(said, "{line}").with_context(|| format!("{name} does not listen"))
    }

    /// Asks it to stop.
    pub(crate) fn ask_to_stop(&mut self) {
        self.life_line = None;
    }
}

impl Drop for ChildProcess {
    fn drop(&mut self) {
        // Whoever has ended already cannot be killed; the wait then only collects it.
        drop(self.child.kill());
        drop(self.child.wait());
    }
}

/// Waits until all have ended, but no longer than `limit`; says who ended badly.
#[expect(clippy::disallowed_methods, reason = "children are waited for with a limit")]
pub(crate) fn wait_for_all(child_process: &mut [ChildProcess], limit: Duration) -> Vec<String> {
    let start = Instant::now();
    let mut badly = Vec::new();
    for child in child_process {
        loop {
            match child.ended() {
                Some(outcome) => {
                    badly.extend(outcome);
                    break;
                }
                None if start.elapsed() >= limit => {
                    badly.push(format!("{} did not end and was killed", child.name));
                    break;
                }
                None => std::thread::sleep(Duration::from_millis(5)),
            }
        }
    }
    badly
}
