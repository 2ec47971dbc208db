//! Events of a game, named in the past tense.

use primitives::id::{FlagId, TeamId, VehicleId};
use primitives::time::SimTime;
use serde::{Deserialize, Serialize};
use strum::IntoStaticStr;

/// An event with its tick and time.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Logged {
    /// Physics tick, from 0.
    pub tick: u64,
    /// Simulated time.
    pub at: SimTime,
    /// The event.
    pub event: Event,
}

/// A reader's position in a growing event log.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct EventCursor(usize);

impl EventCursor {
    /// The events since the last read.
    pub fn read<'a, E>(&mut self, log: &'a [E]) -> &'a [E] {
        let new = log.get(self.0..).unwrap_or_default();
        self.0 = log.len();
        new
    }
}

/// The cause of a tag.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum TagCause {
    /// An opponent within reach on its own side.
    Opponent(VehicleId),
    /// The boat left the field.
    Boundary,
    /// The boat hit an obstacle or a wall.
    Obstacle,
}

/// An event of a game.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, IntoStaticStr)]
#[strum(serialize_all = "snake_case")]
pub enum Event {
    /// A boat grabbed an opponent's flag.
    Grabbed {
        /// The boat that grabbed it.
        vehicle: VehicleId,
        /// The grabbed flag.
        flag: FlagId,
    },
    /// A boat captured a flag.
    Captured {
        /// The boat that captured it.
        vehicle: VehicleId,
        /// The captured flag.
        flag: FlagId,
    },
    /// A boat was tagged.
    Tagged {
        /// The tagged boat.
        vehicle: VehicleId,
        /// The cause of the tag.
        cause: TagCause,
    },
    /// A tagged boat was untagged.
    Untagged(VehicleId),
    /// A carrier lost its flag, which returned home.
    FlagReturned {
        /// The boat that lost it.
        vehicle: VehicleId,
        /// The returned flag.
        flag: FlagId,
    },
    /// A boat left the field.
    LeftField(VehicleId),
    /// A boat returned to the field.
    ReturnedToField(VehicleId),
    /// Two boats came closer than the collision distance.
    Collided {
        /// The boat with the lower index.
        first: VehicleId,
        /// The boat with the higher index.
        second: VehicleId,
    },
    /// A boat entered the keep-out circle of its own flag.
    EnteredKeepout(VehicleId),
    /// A boat is out of action: power play, or it has not joined yet.
    Disabled(VehicleId),
    /// A boat is back in action.
    Enabled(VehicleId),
    /// A boat's agent is lost: the boat holds.
    AgentLost(VehicleId),
    /// A boat's agent is back.
    AgentBack(VehicleId),
    /// A boat's state became non-finite: it stays at its last position, out of play.
    Quarantined(VehicleId),
    /// The position of a real boat is no longer known: the boat must hold.
    NavLost(VehicleId),
    /// The position of a real boat is known again.
    NavBack(VehicleId),
    /// An operator stopped all boats.
    EStopped,
    /// An operator ended the E-stop.
    Released,
    /// An operator made all boats hold.
    Halted,
    /// An operator ended the hold.
    WentOn,
    /// The game is over.
    Ended {
        /// The winning team; `None` means a draw.
        winner: Option<TeamId>,
    },
}

impl Event {
    /// The boat that the event concerns; the first one in a collision. `None` for events that
    /// concern all boats.
    pub fn vehicle(self) -> Option<VehicleId> {
        match self {
            Event::Grabbed { vehicle, .. }
            | Event::Captured { vehicle, .. }
            | Event::Tagged { vehicle, .. }
            | Event::Untagged(vehicle)
            | Event::FlagReturned { vehicle, .. }
            | Event::LeftField(vehicle)
            | Event::ReturnedToField(vehicle)
            | Event::EnteredKeepout(vehicle)
            | Event::Disabled(vehicle)
            | Event::Enabled(vehicle)
            | Event::AgentLost(vehicle)
            | Event::AgentBack(vehicle)
            | Event::Quarantined(vehicle)
            | Event::NavLost(vehicle)
            | Event::NavBack(vehicle) => Some(vehicle),
            Event::Collided { first, .. } => Some(first),
            Event::EStopped
            | Event::Released
            | Event::Halted
            | Event::WentOn
            | Event::Ended { .. } => None,
        }
    }

    /// The second boat: the tagger, or the other boat in a collision.
    pub fn other(self) -> Option<VehicleId> {
        match self {
            Event::Tagged {
                cause: TagCause::Opponent(by),
                ..
            } => Some(by),
            Event::Collided { second, .. } => Some(second),
            _ => None,
        }
    }

    /// The flag involved.
    pub fn flag(self) -> Option<FlagId> {
        match self {
            Event::Grabbed { flag, .. }
            | Event::Captured { flag, .. }
            | Event::FlagReturned { flag, .. } => Some(flag),
            _ => None,
        }
    }
}

/// An event as numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct EventRecord {
    /// Physics tick.
    pub tick: u64,
    /// Simulated time, ns.
    pub at_ns: SimTime,
    /// The kind: a constant of `EventRecord.msg`.
    pub kind: u8,
    /// The vehicle that the event concerns, or for `ENDED` the winning team; otherwise -1.
    pub subject: i32,
    /// The flag, the tagger or the other vehicle; otherwise -1.
    pub object: i32,
}

impl From<Logged> for EventRecord {
    fn from(logged: Logged) -> EventRecord {
        let v = |vehicle: VehicleId| i32::from(vehicle.0);
        let f = |flag: FlagId| i32::from(flag.0);
        let (kind, subject, object) = match logged.event {
            Event::Grabbed { vehicle, flag } => (0, v(vehicle), f(flag)),
            Event::Captured { vehicle, flag } => (1, v(vehicle), f(flag)),
            Event::Tagged {
                vehicle,
                cause: TagCause::Opponent(by),
            } => (2, v(vehicle), v(by)),
            Event::Tagged {
                vehicle,
                cause: TagCause::Boundary,
            } => (3, v(vehicle), -1),
            Event::Tagged {
                vehicle,
                cause: TagCause::Obstacle,
            } => (22, v(vehicle), -1),
            Event::Untagged(vehicle) => (4, v(vehicle), -1),
            Event::FlagReturned { vehicle, flag } => (5, v(vehicle), f(flag)),
            Event::LeftField(vehicle) => (6, v(vehicle), -1),
            Event::ReturnedToField(vehicle) => (7, v(vehicle), -1),
            Event::Collided { first, second } => (8, v(first), v(second)),
            Event::EnteredKeepout(vehicle) => (9, v(vehicle), -1),
            Event::Disabled(vehicle) => (10, v(vehicle), -1),
            Event::Enabled(vehicle) => (11, v(vehicle), -1),
            Event::AgentLost(vehicle) => (12, v(vehicle), -1),
            Event::AgentBack(vehicle) => (13, v(vehicle), -1),
            Event::Quarantined(vehicle) => (14, v(vehicle), -1),
            Event::NavLost(vehicle) => (16, v(vehicle), -1),
            Event::NavBack(vehicle) => (17, v(vehicle), -1),
            Event::EStopped => (18, -1, -1),
            Event::Released => (19, -1, -1),
            Event::Halted => (20, -1, -1),
            Event::WentOn => (21, -1, -1),
            Event::Ended { winner } => (15, winner.map_or(-1, |team| i32::from(team.0)), -1),
        };
        EventRecord {
            tick: logged.tick,
            at_ns: logged.at,
            kind,
            subject,
            object,
        }
    }
}

impl EventRecord {
    /// Decodes the event; `None` if the kind or a number is invalid.
    pub fn logged(&self) -> Option<Logged> {
        let vehicle = u16::try_from(self.subject).ok().map(VehicleId);
        let other = u16::try_from(self.object).ok().map(VehicleId);
        let flag = u8::try_from(self.object).ok().map(FlagId);
        let event = match self.kind {
            0 => Event::Grabbed {
                vehicle: vehicle?,
                flag: flag?,
            },
            1 => Event::Captured {
                vehicle: vehicle?,
                flag: flag?,
            },
            2 => Event::Tagged {
                vehicle: vehicle?,
                cause: TagCause::Opponent(other?),
            },
            3 => Event::Tagged {
                vehicle: vehicle?,
                cause: TagCause::Boundary,
            },
            4 => Event::Untagged(vehicle?),
            5 => Event::FlagReturned {
                vehicle: vehicle?,
                flag: flag?,
            },
            6 => Event::LeftField(vehicle?),
            7 => Event::ReturnedToField(vehicle?),
            8 => Event::Collided {
                first: vehicle?,
                second: other?,
            },
            9 => Event::EnteredKeepout(vehicle?),
            10 => Event::Disabled(vehicle?),
            11 => Event::Enabled(vehicle?),
            12 => Event::AgentLost(vehicle?),
            13 => Event::AgentBack(vehicle?),
            14 => Event::Quarantined(vehicle?),
            15 => Event::Ended {
                winner: u8::try_from(self.subject).ok().map(TeamId),
            },
            16 => Event::NavLost(vehicle?),
            17 => Event::NavBack(vehicle?),
            18 => Event::EStopped,
            19 => Event::Released,
            20 => Event::Halted,
            21 => Event::WentOn,
            22 => Event::Tagged {
                vehicle: vehicle?,
                cause: TagCause::Obstacle,
            },
            _ => return None,
        };
        Some(Logged {
            tick: self.tick,
            at: self.at_ns,
            event,
        })
    }
}
