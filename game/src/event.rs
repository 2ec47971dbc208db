//! What happened in a game, in the past tense.

use crate::id::{FlagId, TeamId, VehicleId};
use crate::scenario::Scenario;
use crate::time::SimTime;
use serde::{Deserialize, Serialize};

/// An event, with the tick and the time at which it happened.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Logged {
    /// Physics tick, counted from 0 at the start of the game.
    pub tick: u64,
    /// Simulated time.
    pub at: SimTime,
    /// What happened.
    pub event: Event,
}

/// How far somebody has read a log of events that grows.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct EventCursor(usize);

impl EventCursor {
    /// The events that were added to the log since it was read last.
    pub fn read<'a, E>(&mut self, log: &'a [E]) -> &'a [E] {
        let new = log.get(self.0..).unwrap_or_default();
        self.0 = log.len();
        new
    }
}

/// Why a boat was tagged.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum TagCause {
    /// An opponent came near enough on its own side.
    Opponent(VehicleId),
    /// The boat left the field.
    Boundary,
}

/// What happened.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Event {
    /// A boat took an opponent's flag.
    Grabbed {
        /// Who took it.
        vehicle: VehicleId,
        /// Which flag.
        flag: FlagId,
    },
    /// A boat brought a flag in.
    Captured {
        /// Who brought it.
        vehicle: VehicleId,
        /// Which flag.
        flag: FlagId,
    },
    /// A boat was tagged.
    Tagged {
        /// Who is tagged now.
        vehicle: VehicleId,
        /// Why.
        cause: TagCause,
    },
    /// A tagged boat came home and plays again.
    Untagged {
        /// Who plays again.
        vehicle: VehicleId,
    },
    /// A carrier lost its flag, which is at its home again.
    FlagReturned {
        /// Who lost it.
        vehicle: VehicleId,
        /// Which flag.
        flag: FlagId,
    },
    /// A boat left the field.
    LeftField {
        /// Who left.
        vehicle: VehicleId,
    },
    /// A boat came back onto the field.
    ReturnedToField {
        /// Who came back.
        vehicle: VehicleId,
    },
    /// Two boats came closer than the collision distance.
    Collided {
        /// The one with the lower index.
        first: VehicleId,
        /// The one with the higher index.
        second: VehicleId,
    },
    /// A boat came into the keep-out circle of its own flag.
    EnteredKeepout {
        /// Who came in.
        vehicle: VehicleId,
    },
    /// A boat is out of action for a while (power play).
    Disabled {
        /// Who.
        vehicle: VehicleId,
    },
    /// A boat is back in action.
    Enabled {
        /// Who.
        vehicle: VehicleId,
    },
    /// A boat's agent is lost: the boat holds from now on.
    AgentLost {
        /// Whose agent.
        vehicle: VehicleId,
    },
    /// A boat's agent is back.
    AgentBack {
        /// Whose agent.
        vehicle: VehicleId,
    },
    /// A boat's numbers went bad: it lies still where it last was and plays no more.
    Quarantined {
        /// Which boat.
        vehicle: VehicleId,
    },
    /// It is not known any more where a real boat is: it is to hold.
    NavLost {
        /// Which boat.
        vehicle: VehicleId,
    },
    /// It is known again where a real boat is.
    NavBack {
        /// Which boat.
        vehicle: VehicleId,
    },
    /// Somebody ashore stopped all boats.
    EStopped,
    /// That stop is over.
    Released,
    /// Somebody ashore makes all boats hold for now.
    Halted,
    /// They may go on.
    WentOn,
    /// The game is over.
    Ended {
        /// Who won; `None` is a draw.
        winner: Option<TeamId>,
    },
}

impl Event {
    /// The boat it happened to: the first of two in a collision, nobody at the end of a game.
    #[must_use]
    pub fn vehicle(self) -> Option<VehicleId> {
        match self {
            Event::Grabbed { vehicle, .. }
            | Event::Captured { vehicle, .. }
            | Event::Tagged { vehicle, .. }
            | Event::Untagged { vehicle }
            | Event::FlagReturned { vehicle, .. }
            | Event::LeftField { vehicle }
            | Event::ReturnedToField { vehicle }
            | Event::EnteredKeepout { vehicle }
            | Event::Disabled { vehicle }
            | Event::Enabled { vehicle }
            | Event::AgentLost { vehicle }
            | Event::AgentBack { vehicle }
            | Event::Quarantined { vehicle }
            | Event::NavLost { vehicle }
            | Event::NavBack { vehicle } => Some(vehicle),
            Event::Collided { first, .. } => Some(first),
            Event::EStopped | Event::Released | Event::Halted | Event::WentOn | Event::Ended { .. } => None,
        }
    }

    /// Whether everything that it names is in the game: whoever sends it is not therefore right.
    #[must_use]
    pub fn is_of(self, scenario: &Scenario) -> bool {
        let other = match self {
            Event::Tagged { cause: TagCause::Opponent(by), .. } => Some(by),
            Event::Collided { second, .. } => Some(second),
            _ => None,
        };
        let flag = match self {
            Event::Grabbed { flag, .. } | Event::Captured { flag, .. } | Event::FlagReturned { flag, .. } => Some(flag),
            _ => None,
        };
        let team = if let Event::Ended { winner } = self { winner } else { None };
        [self.vehicle(), other].into_iter().flatten().all(|vehicle| vehicle.index() < scenario.vehicles.len())
            && flag.is_none_or(|flag| flag.index() < scenario.field.flags.len())
            && team.is_none_or(|team| team.index() < scenario.teams.len())
    }
}
