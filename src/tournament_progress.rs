//! How far a tournament is: a bar on a terminal, a line now and then elsewhere.

use crate::screen;
use bus::clock;
use indicatif::{ProgressBar, ProgressStyle};
use std::time::{Duration, Instant};

/// Shows how far a tournament is, on standard error.
pub(crate) struct Progress {
    /// Hidden where there is no terminal.
    bar: ProgressBar,
    told: Instant,
}

/// How often a line is written where there is no terminal.
const LINE_EVERY: Duration = Duration::from_secs(30);

impl Progress {
    /// Of so many games none is played yet.
    pub(crate) fn new(games: u64) -> Progress {
        let style = ProgressStyle::with_template("{wide_bar} {pos}/{len} games  {per_sec}  {eta} left");
        let bar = ProgressBar::new(games).with_style(style.expect("the template is sound").progress_chars("=> "));
        if bar.is_hidden() {
            screen::remark(&format!("{games} games to play"));
        }
        Progress { bar, told: clock::now() }
    }

    /// One more is played.
    pub(crate) fn played(&mut self) {
        self.bar.inc(1);
        if self.bar.is_hidden() && clock::since(self.told) >= LINE_EVERY {
            self.told = clock::now();
            let (played, games) = (self.bar.position(), self.bar.length().unwrap_or(0));
            screen::remark(&format!("{played} of {games} games, {:.1} games/s", self.rate()));
        }
    }

    /// Games a second so far.
    fn rate(&self) -> f64 {
        self.bar.position() as f64 / self.bar.elapsed().as_secs_f64().max(1e-9)
    }

    /// Takes the bar away and says how fast it went on so many threads; returns the games a second.
    pub(crate) fn done(&self, jobs: usize) -> f64 {
        let (played, rate, wall_s) = (self.bar.position(), self.rate(), self.bar.elapsed().as_secs_f64());
        self.bar.finish_and_clear();
        let threads = if jobs == 1 { "1 thread".to_owned() } else { format!("{jobs} threads") };
        screen::remark(&format!("{played} games in {wall_s:.1} s on {threads}: {rate:.1} games/s"));
        rate
    }
}
