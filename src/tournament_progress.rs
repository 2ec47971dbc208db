//! How far a tournament is: a bar on a terminal, a line now and then elsewhere.

use crate::screen;
use indicatif::{ProgressBar, ProgressStyle};
use std::time::{Duration, Instant};

/// Shows how far a tournament is, on standard error.
pub(crate) struct Progress {
    /// Hidden where there is no terminal.
    bar: ProgressBar,
    start: Instant,
    told: Instant,
    played: u64,
    games: u64,
}

/// How often a line is written where there is no terminal.
const LINE_EVERY: Duration = Duration::from_secs(30);

impl Progress {
    /// Of so many games none is played yet.
    #[expect(clippy::disallowed_methods, reason = "progress is shown by the clock; the games do not see it")]
    pub(crate) fn new(games: u64) -> Progress {
        let style = ProgressStyle::with_template("{wide_bar} {pos}/{len} games  {per_sec}  {eta} left");
        let bar = ProgressBar::new(games).with_style(style.expect("the template is sound").progress_chars("=> "));
        if bar.is_hidden() {
            screen::remark(&format!("{games} games to play"));
        }
        let now = Instant::now();
        Progress { bar, start: now, told: now, played: 0, games }
    }

    /// One more is played.
    #[expect(clippy::disallowed_methods, reason = "progress is shown by the clock; the games do not see it")]
    pub(crate) fn played(&mut self) {
        self.played += 1;
        self.bar.set_position(self.played);
        if self.bar.is_hidden() && self.told.elapsed() >= LINE_EVERY {
            self.told = Instant::now();
            screen::remark(&format!("{} of {} games, {:.1} games/s", self.played, self.games, self.rate()));
        }
    }

    /// Games a second so far.
    pub(crate) fn rate(&self) -> f64 {
        self.played as f64 / self.start.elapsed().as_secs_f64().max(1e-9)
    }

    /// Takes the bar away and says how fast it went on so many threads; returns the games a second.
    pub(crate) fn done(&self, jobs: usize) -> f64 {
        let (rate, wall_s) = (self.rate(), self.start.elapsed().as_secs_f64());
        self.bar.finish_and_clear();
        let threads = if jobs == 1 { "1 thread".to_owned() } else { format!("{jobs} threads") };
        screen::remark(&format!("{} games in {wall_s:.1} s on {threads}: {rate:.1} games/s", self.played));
        rate
    }
}
