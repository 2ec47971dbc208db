//! The cause for which a boat holds.

use super::Contest;
use messages::Order;
use primitives::VehicleId;
use rules::Directive;

/// Why a boat holds. Of several causes the first in this list counts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum HoldCause {
    /// People ashore have stopped all boats, until they release them.
    EStopped,
    /// People ashore have halted all boats for now.
    Halted,
    /// It is a real boat, and had no fix for too long.
    NavLost,
    /// It is a real boat, and its agent is lost.
    AgentLost,
    /// It is a real boat, and the game is over.
    GameOver,
    /// It is a real boat, and its newest order answers a picture that is too old.
    OrderExpired,
    /// The rules want it to: it is out of action, or out of play for good.
    Rules,
    /// Its order in force is to hold: its agent said so, or the order before was refused, has expired, was recalled, or came so long
    /// ago that the boat's own watchdog has stopped it.
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

    /// Why a vehicle holds whatever the rules and its agent want.
    pub(super) fn stop_cause(&self, i: usize) -> Option<HoldCause> {
        if self.state.e_stopped {
            return Some(HoldCause::EStopped);
        }
        if self.state.halted {
            return Some(HoldCause::Halted);
        }
        // A real boat moves only while somebody looks after it.
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
