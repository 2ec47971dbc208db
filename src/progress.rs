//! Progress of a long task on standard error: a bar on a terminal, otherwise an occasional line.

use crate::{clock, screen};
use command_line::number::significant;
use indicatif::{ProgressBar, ProgressStyle};
use std::time::{Duration, Instant};

/// The progress of a task.
pub(crate) struct Progress {
    /// Hidden if there is no terminal.
    bar: ProgressBar,
    /// The name of the counted items.
    noun: &'static str,
    told: Instant,
}

/// Interval of progress lines without a terminal.
const LINE_EVERY: Duration = Duration::from_secs(30);
/// Interval at which a bar without a known end moves.
const TURN_EVERY: Duration = Duration::from_millis(200);

/// Tells the user that an odd number of games per point or pairing is rounded up.
pub(crate) fn tell_rounded(games: u32, each: &str) {
    if !games.is_multiple_of(2) {
        screen::remark(&format!(
            "rounding {games} games per {each} up to {}, so that half can be played from each side",
            games + 1
        ));
    }
}

impl Progress {
    /// Progress of this many games, none of which has been played yet.
    pub(crate) fn of_games(games: u64) -> Progress {
        let progress = Progress::of(games, "games");
        if progress.bar.is_hidden() {
            screen::remark(&format!("{games} games to play"));
        }
        progress
    }

    /// Progress of this many items, none of which is done yet.
    pub(crate) fn of(count: u64, noun: &'static str) -> Progress {
        let style =
            format!("{{wide_bar}} {{human_pos}}/{{human_len}} {noun}  {{per_sec}}  {{eta}} left");
        let style = ProgressStyle::with_template(&style)
            .expect("the template is sound")
            .progress_chars("=> ");
        Progress {
            bar: ProgressBar::new(count).with_style(style),
            noun,
            told: clock::now(),
        }
    }

    /// Progress of an unknown number of items.
    pub(crate) fn without_end(noun: &'static str) -> Progress {
        let style = format!("{{spinner}} {{pos}} {noun} in {{elapsed}}  {{wide_msg}}");
        let style = ProgressStyle::with_template(&style).expect("the template is sound");
        let bar = ProgressBar::new_spinner().with_style(style);
        bar.enable_steady_tick(TURN_EVERY);
        Progress {
            bar,
            noun,
            told: clock::now(),
        }
    }

    /// Sets the number of items done in an earlier run.
    pub(crate) fn begin_at(&self, done: u64) {
        self.bar.set_position(done);
        self.bar.reset_eta();
    }

    /// Adds to the number of items.
    pub(crate) fn expect(&self, more: u64) {
        self.bar.inc_length(more);
    }

    /// Sets the number of items done.
    pub(crate) fn set(&self, done: u64) {
        self.bar.set_position(done);
    }

    /// Prints a result line above the bar.
    pub(crate) fn print(&self, line: &str) {
        self.bar.suspend(|| screen::print(&format!("{line}\n")));
    }

    /// Counts one more item.
    pub(crate) fn add(&mut self) {
        self.add_with(String::new);
    }

    /// Counts one more item, with a remark about it.
    pub(crate) fn add_with(&mut self, words: impl FnOnce() -> String) {
        self.bar.inc(1);
        if !self.bar.is_hidden() {
            self.bar.set_message(words());
        } else if self.told.elapsed() >= LINE_EVERY {
            self.told = clock::now();
            let done = self.bar.position();
            let noun = self.noun;
            let of = self
                .bar
                .length()
                .map_or(String::new(), |count| format!(" of {count}"));
            let line = format!(
                "{done}{of} {noun}, {} {noun}/s  {}",
                significant(self.rate()),
                words()
            );
            screen::remark(line.trim_end());
        }
    }

    /// Items per second so far.
    fn rate(&self) -> f64 {
        self.bar.position() as f64 / self.bar.elapsed().as_secs_f64().max(1e-9)
    }

    /// Removes the bar.
    pub(crate) fn end(&self) {
        self.bar.finish_and_clear();
    }

    /// Removes the bar and prints the rate with this many threads; returns the games per second.
    pub(crate) fn end_of_games(&self, jobs: usize) -> f64 {
        let played = self.bar.position();
        let rate = self.rate();
        let wall_s = self.bar.elapsed().as_secs_f64();
        self.end();
        let threads = if jobs == 1 {
            "1 thread".to_owned()
        } else {
            format!("{jobs} threads")
        };
        let wall_s = significant(wall_s);
        screen::remark(&format!(
            "{played} games in {wall_s} s on {threads}: {} games/s",
            significant(rate)
        ));
        rate
    }
}
