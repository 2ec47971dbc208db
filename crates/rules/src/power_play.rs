//! Power play: each team is one boat short for some time, never two teams at once.

use super::{Referee, Standing};
use crate::event::Event;
use primitives::id::VehicleId;
use primitives::stream::Stream;
use primitives::time::SimTime;

impl Referee {
    /// Draws one boat of each team and its time out of action. All orders of the teams and all
    /// positions of the windows that fit into the game without overlap are equally likely. In a
    /// game too short for all windows, they share its duration.
    pub(super) fn draw_power_plays(&self, standing: &mut Standing, stream: &mut Stream) {
        if self.rules.power_play <= SimTime::ZERO {
            return;
        }
        let mut chosen = Vec::new();
        for team in 0..self.teams() {
            let boats: Vec<usize> = (0..self.team_of.len())
                .filter(|i| self.team_of[*i].index() == team)
                .collect();
            if !boats.is_empty() {
                chosen.push(boats[stream.below(boats.len() as u64) as usize]);
            }
        }
        if chosen.is_empty() {
            return;
        }
        stream.shuffle(&mut chosen);
        let game = self.rules.time_limit.0.max(0);
        let windows = chosen.len() as i64;
        let length = self.rules.power_play.0.min(game / windows);
        // Sorting random gaps between the windows is equivalent to drawing the windows themselves.
        let spare = (game - length * windows) as u64;
        let mut gaps: Vec<u64> = chosen.iter().map(|_| stream.below(spare + 1)).collect();
        gaps.sort_unstable();
        for (i, (vehicle, gap)) in chosen.into_iter().zip(gaps).enumerate() {
            let from = SimTime(gap as i64 + length * i as i64);
            standing.disabled[vehicle] = (from, from + SimTime(length));
        }
    }

    /// Disables and enables boats according to the windows drawn at the start; also disables boats
    /// that join later until they join.
    pub(super) fn switch_disabled(&self, standing: &mut Standing, events: &mut Vec<Event>) {
        for (i, (boat, (from, until))) in standing
            .vehicles
            .iter_mut()
            .zip(&standing.disabled)
            .enumerate()
        {
            let vehicle = VehicleId::at(i);
            let waits = standing.now < self.joins[i];
            let disabled = waits || (*from..*until).contains(&standing.now);
            match (boat.disabled, disabled) {
                (false, true) => events.push(Event::Disabled(vehicle)),
                (true, false) => events.push(Event::Enabled(vehicle)),
                _ => {}
            }
            boat.disabled = disabled;
        }
    }
}
