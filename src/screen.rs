//! The terminal: events as lines, and the state of the game as a line that is overwritten.

use crate::result_table;
use crate::style::Names;
use command_line::number::significant;
pub(crate) use command_line::terminal::*;
use sim::{Progress, ProgressMessage};
use std::io::IsTerminal;

/// Shows the progress of a game to the user.
pub(crate) struct Screen {
    /// Whether a line can be overwritten.
    live: bool,
    status: String,
    names: Names,
    /// Simulated time of the last status line on a scrolling screen, s.
    last_s: f64,
}

/// Interval of status lines if they cannot be overwritten, simulated seconds.
const PRINT_EVERY_S: f64 = 60.0;

impl Screen {
    /// The screen of this process for a game with these names.
    pub(crate) fn new(names: Names) -> Screen {
        Screen {
            live: std::io::stdout().is_terminal(),
            status: String::new(),
            names,
            last_s: 0.0,
        }
    }

    pub(crate) fn show(&mut self, message: &ProgressMessage) {
        match message {
            ProgressMessage::Open { game, endpoint } => {
                self.line(&format!("game {game} at {endpoint}"));
                self.line(&format!(
                    "watch it with: squall watch --game {game}, or on a page: squall view --game {game}"
                ));
            }
            ProgressMessage::Waiting { agents, gateways } => match waiting(agents, gateways) {
                Some(text) => self.status(&text),
                None => self.line("every boat has an agent"),
            },
            ProgressMessage::Started => {}
            ProgressMessage::Event(event) => {
                self.line(&format!("{:>7.1} s  {}", event.at_s, event.sentence()))
            }
            ProgressMessage::Progress(progress) => self.progress(progress),
            ProgressMessage::Done(report) => {
                self.clear();
                self.status.clear();
                show(&self.names.paint(&result_table::text(report)));
            }
        }
    }

    fn progress(&mut self, progress: &Progress) {
        let score: Vec<String> = progress
            .score
            .iter()
            .map(|(team, points)| format!("{team} {points}"))
            .collect();
        let share = (progress.now_s / progress.end_s).clamp(0.0, 1.0);
        let full = (share * 24.0).round() as usize;
        let refused = if progress.refused > 0 {
            format!("  {} refused", progress.refused)
        } else {
            String::new()
        };
        let text = format!(
            "{:>7.1} s  [{}{}] {:.0} s  {}  {}x{refused}",
            progress.now_s,
            "=".repeat(full),
            " ".repeat(24 - full),
            progress.end_s,
            score.join("  "),
            significant(progress.rate),
        );
        if self.live || progress.now_s - self.last_s >= PRINT_EVERY_S {
            self.last_s = progress.now_s;
            self.status(&text);
        }
    }

    /// Prints a permanent line.
    pub(crate) fn line(&mut self, text: &str) {
        self.clear();
        let status = if self.live { self.status.as_str() } else { "" };
        show(&self.names.paint(&format!("{text}\n{status}")));
    }

    /// Prints a line that the next one overwrites.
    fn status(&mut self, text: &str) {
        if !self.live {
            show(&self.names.paint(&format!("{text}\n")));
            return;
        }
        self.clear();
        // A wrapped line could not be overwritten.
        self.status = cut(text);
        show(&self.names.paint(&self.status));
    }

    fn clear(&mut self) {
        if self.live && !self.status.is_empty() {
            overwrite("");
        }
    }
}

impl Drop for Screen {
    /// Removes the status line, so that an error does not continue on it.
    fn drop(&mut self) {
        self.clear();
    }
}

/// A line truncated to the width of the terminal; the whole line if there is no terminal.
pub(crate) fn cut(line: &str) -> String {
    let width = if std::io::stdout().is_terminal() {
        columns().saturating_sub(1)
    } else {
        usize::MAX
    };
    match line.char_indices().nth(width) {
        Some(_) => line
            .chars()
            .take(width.saturating_sub(1))
            .chain(['…'])
            .collect(),
        None => line.to_owned(),
    }
}

/// Words in lines that fit the terminal, all indented except the first; one line if there is no
/// terminal.
pub(crate) fn wrapped(words: &str) -> String {
    let width = if std::io::stdout().is_terminal() {
        columns()
    } else {
        usize::MAX
    };
    let mut lines = vec![String::new()];
    for word in words.split(' ') {
        let last = lines.last_mut().expect("there is a line");
        if !last.is_empty() && last.len() + 1 + word.len() >= width {
            lines.push(format!("    {word}"));
        } else {
            *last += if last.is_empty() { "" } else { " " };
            *last += word;
        }
    }
    lines.join("\n") + "\n"
}

/// The agents and gateways that a game waits for, if any.
fn waiting(agents: &[String], gateways: &[String]) -> Option<String> {
    const SHOWN: usize = 6;
    let parts = [("agents", agents), ("gateways", gateways)]
        .into_iter()
        .filter(|(_, names)| !names.is_empty());
    let parts = parts.map(|(of, names)| {
        let more = names.len().saturating_sub(SHOWN);
        let more = if more > 0 {
            format!(" and {more} more")
        } else {
            String::new()
        };
        format!(
            "the {of} of {}{more}",
            names[..names.len().min(SHOWN)].join(", ")
        )
    });
    let parts: Vec<String> = parts.collect();
    (!parts.is_empty()).then(|| format!("waiting for {}", parts.join(" and ")))
}

/// The width of the terminal, columns; a typical width if there is no terminal.
pub(crate) fn columns() -> usize {
    terminal_size::terminal_size().map_or(
        experiment::tournament::WIDTH,
        |(terminal_size::Width(columns), _)| usize::from(columns),
    )
}
