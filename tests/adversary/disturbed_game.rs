//! Games that are attacked: they must be played, stopped and ended as if nobody were there.

use crate::support::{Process, Sim, own, result_of};
use bus::Bus;
use messages::Control;
use serde_json::Value;

/// In lockstep, so that any disturbance shows in the digest.
const SCENARIO: &str = "pav01_600s";
/// Simulated seconds a second while it is attacked.
pub(crate) const SPEED: &str = "2";

/// A game in lockstep, slowed down so that it lasts for as long as it is attacked.
pub(crate) struct DisturbedGame {
    pub(crate) sim: Sim,
    agents: Vec<Process>,
    /// Who may let it go on faster, where somebody can.
    operator: Option<Bus>,
}

impl DisturbedGame {
    pub(crate) fn start() -> DisturbedGame {
        let (sim, agents) = Sim::start_with_agents(SCENARIO, &["--speed", SPEED]);
        let operator = Some(sim.bus());
        DisturbedGame { sim, agents, operator }
    }

    pub(crate) fn of(sim: Sim, agents: Vec<Process>, operator: Option<Bus>) -> DisturbedGame {
        DisturbedGame { sim, agents, operator }
    }

    /// Nobody has left, and the game goes on.
    pub(crate) fn check(&mut self) {
        self.sim.newest_progress();
        self.sim.play_on(1.0);
        for agent in &mut self.agents {
            assert!(agent.0.try_wait().expect("it can be asked").is_none(), "an agent has left the game");
        }
    }

    /// Plays the rest, which must be that of the undisturbed game. Gives the report.
    pub(crate) fn ends_as_if_undisturbed(mut self) -> Value {
        let undisturbed = result_of(&[&own(SCENARIO), "--in-process"])["digest"].clone();
        if let Some(operator) = &self.operator {
            bus::control(operator, &self.sim.name(), Control::Speed(None)).expect("it may");
        }
        let done = self.sim.wait_for_kind("done");
        assert_eq!(done["outcome"]["digest"], undisturbed, "{}", done["run"]);
        self.agents.iter_mut().for_each(|agent| assert!(agent.wait().success(), "everybody leaves in peace"));
        done
    }
}
