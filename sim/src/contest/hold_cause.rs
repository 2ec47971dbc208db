//! Why a boat holds.

use super::Contest;
use messages::Order;
use primitives::VehicleId;
use rules::Directive;

/// Why a boat holds. If several causes apply, the first in this list counts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum HoldCause {
    /// An operator has stopped all boats until release.
    EStopped,
    /// An operator has halted all boats for now.
    Halted,
    /// A real boat has been without a fix for too long.
    NavLost,
    /// A real boat's agent is lost.
    AgentLost,
    /// The game of a real boat is over.
    GameOver,
    /// The newest order of a real boat answers a picture that is too old.
    OrderExpired,
    /// The rules require it: the boat is out of action or permanently out of play.
    Rules,
    /// The order in force is to hold: the agent ordered it, or the last order was refused, has
    /// expired, was recalled, or is so old that the boat's own watchdog stopped it.
    Ordered,
}

impl Contest {
    /// Why a vehicle holds, if it does.
    #[must_use]
    pub fn hold_cause(&self, vehicle: VehicleId) -> Option<HoldCause> {
        let i = vehicle.index();
        let at = self.world.state().boats[i].pose.at;
        let stopped = self.stop_cause(i);
        stopped.or_else(|| match self.referee.directive(&self.state.standing, vehicle, at) {
            Directive::Hold => Some(HoldCause::Rules),
            Directive::DrivenHome { .. } => None,
            Directive::Free { .. } => (self.state.orders[i].order == Order::Hold).then_some(HoldCause::Ordered),
        })
    }

    /// Why a vehicle holds regardless of rules and agent, if it does.
    pub(super) fn stop_cause(&self, i: usize) -> Option<HoldCause> {
        if self.state.e_stopped {
            return Some(HoldCause::EStopped);
        }
        if self.state.halted {
            return Some(HoldCause::Halted);
        }
        // A real boat moves only under supervision.
        let track = self.state.tracks[i].as_ref()?;
        if track.is_lost(self.now()) {
            return Some(HoldCause::NavLost);
        }
        if self.state.agent_lost[i] {
            return Some(HoldCause::AgentLost);
        }
        if self.is_over() {
            return Some(HoldCause::GameOver);
        }
        self.is_expired(i).then_some(HoldCause::OrderExpired)
    }
}
