//! Games under attack: they must be played, stopped and ended as if undisturbed.

use crate::support::{Process, Sim, own, result_of};
use bus::Bus;
use messages::Control;
use serde_json::Value;

/// A lockstep game, so that any disturbance changes the digest.
const SCENARIO: &str = "pav01_600s";
/// Simulated seconds per second during the attack.
pub(crate) const SPEED: &str = "2";

/// A lockstep game, slowed down so that it lasts as long as the attack.
pub(crate) struct DisturbedGame {
    pub(crate) sim: Sim,
    pub(crate) agents: Vec<Process>,
    /// A session that can speed the game up again, if any.
    pub(crate) operator: Option<Bus>,
}

/// Checks that none of these agents has left its game.
pub(crate) fn all_stay(agents: &mut [Process]) {
    for agent in agents {
        assert!(
            agent.0.try_wait().expect("it can be asked").is_none(),
            "an agent has left the game"
        );
    }
}

impl DisturbedGame {
    pub(crate) fn start() -> DisturbedGame {
        let (sim, agents) = Sim::start_with_agents(SCENARIO, &["--speed", SPEED]);
        let operator = Some(sim.bus());
        DisturbedGame {
            sim,
            agents,
            operator,
        }
    }

    /// Checks that no node has left and that the game continues.
    pub(crate) fn check(&mut self) {
        self.sim.newest_progress();
        self.sim.play_on(1.0);
        all_stay(&mut self.agents);
    }

    /// Plays the rest, which must equal that of the undisturbed game. Returns the report.
    pub(crate) fn ends_as_if_undisturbed(mut self) -> Value {
        let undisturbed = result_of(&[&own(SCENARIO), "--in-process"])["digest"].clone();
        if let Some(operator) = &self.operator {
            bus::control(operator, &self.sim.name(), Control::Speed(None)).expect("it may");
        }
        let done = self.sim.wait_for_kind("done");
        assert_eq!(done["outcome"]["digest"], undisturbed, "{}", done["run"]);
        self.agents.iter_mut().for_each(|agent| {
            assert!(agent.wait().success(), "every node leaves without an error")
        });
        done
    }
}
