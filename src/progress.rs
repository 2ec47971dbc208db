//! How far something is that takes a while: a bar on a terminal, a line now and then elsewhere. On standard error.

use crate::{clock, screen};
use indicatif::{ProgressBar, ProgressStyle};
use std::time::{Duration, Instant};

/// How far it is.
pub(crate) struct Progress {
    /// Hidden where there is no terminal.
    bar: ProgressBar,
    /// What is counted.
    noun: &'static str,
    told: Instant,
}

/// How often a line is written where there is no terminal.
const LINE_EVERY: Duration = Duration::from_secs(30);
/// How often a bar without an end moves.
const TURN_EVERY: Duration = Duration::from_millis(200);

impl Progress {
    /// Of so many games none is played yet.
    pub(crate) fn of_games(games: u64) -> Progress {
        let progress = Progress::of(games, "games");
        if progress.bar.is_hidden() {
            screen::remark(&format!("{games} games to play"));
        }
        progress
    }

    /// Of so many of these none is done yet.
    pub(crate) fn of(count: u64, noun: &'static str) -> Progress {
        let style = format!("{{wide_bar}} {{human_pos}}/{{human_len}} {noun}  {{per_sec}}  {{eta}} left");
        let style = ProgressStyle::with_template(&style).expect("the template is sound").progress_chars("=> ");
        Progress { bar: ProgressBar::new(count).with_style(style), noun, told: clock::now() }
    }

    /// Nobody knows how many of these there will be.
    pub(crate) fn without_end(noun: &'static str) -> Progress {
        let style = format!("{{spinner}} {{pos}} {noun} in {{elapsed}}  {{msg}}");
        let style = ProgressStyle::with_template(&style).expect("the template is sound");
        let bar = ProgressBar::new_spinner().with_style(style);
        bar.enable_steady_tick(TURN_EVERY);
        Progress { bar, noun, told: clock::now() }
    }

    /// So many were done before.
    pub(crate) fn begin_at(&self, done: u64) {
        self.bar.set_position(done);
        self.bar.reset_eta();
    }

    /// So many are done.
    pub(crate) fn set(&self, done: u64) {
        self.bar.set_position(done);
    }

    /// Prints a line of the results, above the bar.
    pub(crate) fn print(&self, line: &str) {
        self.bar.suspend(|| screen::print(&format!("{line}\n")));
    }

    /// One more is done.
    pub(crate) fn add(&mut self) {
        self.add_with(String::new);
    }

    /// One more is done, of which there is something to say.
    pub(crate) fn add_with(&mut self, words: impl FnOnce() -> String) {
        self.bar.inc(1);
        if !self.bar.is_hidden() {
            self.bar.set_message(words());
        } else if self.told.elapsed() >= LINE_EVERY {
            self.told = clock::now();
            let (done, noun) = (self.bar.position(), self.noun);
            let of = self.bar.length().map_or(String::new(), |count| format!(" of {count}"));
            let line = format!("{done}{of} {noun}, {:.1} {noun}/s  {}", self.rate(), words());
            screen::remark(line.trim_end());
        }
    }

    /// How many a second so far.
    fn rate(&self) -> f64 {
        self.bar.position() as f64 / self.bar.elapsed().as_secs_f64().max(1e-9)
    }

    /// Takes the bar away.
    pub(crate) fn end(&self) {
        self.bar.finish_and_clear();
    }

    /// Takes the bar of games away and says how fast it went on so many threads; returns the games a second.
    pub(crate) fn end_of_games(&self, jobs: usize) -> f64 {
        let (played, rate, wall_s) = (self.bar.position(), self.rate(), self.bar.elapsed().as_secs_f64());
        self.end();
        let threads = if jobs == 1 { "1 thread".to_owned() } else { format!("{jobs} threads") };
        screen::remark(&format!("{played} games in {wall_s:.1} s on {threads}: {rate:.1} games/s"));
        rate
    }
}
