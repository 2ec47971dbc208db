//! Adds up the points of a game played from both sides: once as it is, and once with the teams'
//! strategies exchanged.

use anyhow::{Result, bail};
use command_line::explain::UsageError;
use primitives::id::TeamId;
use scenario::Scenario;
use sim::Report;

/// The teams of a game played from both sides.
pub(crate) struct BothSides {
    /// The teams' names, and the names of their strategies in the first game.
    teams: [(String, String); 2],
}

/// Whether the teams follow the same strategies, so that exchanging them has no effect.
pub(crate) fn are_equal(scenario: &Scenario) -> bool {
    let of_team = |team: u8| {
        let boats = scenario
            .vehicles
            .iter()
            .filter(move |vehicle| vehicle.team == TeamId(team));
        boats.map(|vehicle| &scenario.strategies[vehicle.strategy])
    };
    of_team(0).eq(of_team(1))
}

impl BothSides {
    /// Checks that the game can be played from both sides: it has no real boats, and the teams use
    /// different strategies.
    pub(crate) fn new(scenario: &Scenario) -> Result<BothSides> {
        scenario.has_no_real_boats()?;
        let name = |team: usize| {
            let first = scenario
                .vehicles
                .iter()
                .find(|vehicle| vehicle.team == TeamId(team as u8));
            first.map_or(String::new(), |vehicle| {
                scenario.strategies[vehicle.strategy].name.clone()
            })
        };
        let teams = [0, 1].map(|team| (scenario.teams[team].name.clone(), name(team)));
        if are_equal(scenario) {
            bail!(UsageError(format!(
                "both teams use the strategy {}, so exchanging strategies has no effect; omit --both-sides",
                teams[0].1
            )));
        }
        Ok(BothSides { teams })
    }

    /// Each strategy's total over both games. The strategy that the first team uses in the first
    /// game comes first.
    fn points(&self, reports: &[Report]) -> [u32; 2] {
        let points = |entry: usize| {
            let of_game = |(game, report): (usize, &Report)| {
                report.outcome.score.teams[&self.teams[(entry + game) % 2].0]
            };
            reports.iter().enumerate().map(of_game).sum()
        };
        [points(0), points(1)]
    }

    /// The points of each strategy as a string.
    pub(crate) fn text(&self, reports: &[Report]) -> String {
        let [(first, first_strategy), (second, second_strategy)] = &self.teams;
        let [points, other_points] = self.points(reports);
        format!(
            "\nboth games: {first_strategy} (first as {first}) {points}, {second_strategy} (first as {second}) {other_points}"
        )
    }

    /// The points of each strategy as JSON.
    pub(crate) fn sum(&self, reports: &[Report]) -> serde_json::Value {
        let entry = |((team, strategy), points): (&(String, String), u32)| serde_json::json!({ "first_as": team, "strategy": strategy, "score": points });
        self.teams
            .iter()
            .zip(self.points(reports))
            .map(entry)
            .collect()
    }
}
