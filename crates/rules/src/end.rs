//! The end of a game: a winning score or the time limit.

use super::{Referee, Standing};
use crate::event::Event;
use primitives::id::TeamId;

impl Referee {
    /// Ends the game if it is won or the time is up. The highest score wins, even if both teams
    /// reach the winning score in one tick; equal scores are a draw.
    pub(super) fn end(&self, standing: &mut Standing, events: &mut Vec<Event>) {
        let best = standing.score.iter().copied().max().unwrap_or(0);
        let won = self
            .rules
            .win_score
            .is_some_and(|win_score| best >= win_score);
        if !won && standing.now < self.rules.time_limit {
            return;
        }
        standing.over = true;
        let mut leaders = standing
            .score
            .iter()
            .enumerate()
            .filter(|(_, score)| **score == best);
        let winner = match (leaders.next(), leaders.next()) {
            (Some((team, _)), None) => Some(TeamId(team as u8)),
            _ => None,
        };
        events.push(Event::Ended { winner });
    }
}
