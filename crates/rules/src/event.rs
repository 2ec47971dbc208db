//! What happened in a game, in the past tense.

use primitives::id::{FlagId, TeamId, VehicleId};
use primitives::time::SimTime;
use serde::{Deserialize, Serialize};
use strum::IntoStaticStr;

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
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, IntoStaticStr)]
#[strum(serialize_all = "snake_case")]
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
    Untagged(VehicleId),
    /// A carrier lost its flag, which is at its home again.
    FlagReturned {
        /// Who lost it.
        vehicle: VehicleId,
        /// Which flag.
        flag: FlagId,
    },
    /// A boat left the field.
    LeftField(VehicleId),
    /// A boat came back onto the field.
    ReturnedToField(VehicleId),
    /// Two boats came closer than the collision distance.
    Collided {
        /// The one with the lower index.
        first: VehicleId,
        /// The one with the higher index.
        second: VehicleId,
    },
    /// A boat came into the keep-out circle of its own flag.
    EnteredKeepout(VehicleId),
    /// A boat is out of action for a while (power play).
    Disabled(VehicleId),
    /// A boat is back in action.
    Enabled(VehicleId),
    /// A boat's agent is lost: the boat holds from now on.
    AgentLost(VehicleId),
    /// A boat's agent is back.
    AgentBack(VehicleId),
    /// A boat's numbers went bad: it lies still where it last was and plays no more.
    Quarantined(VehicleId),
    /// It is not known any more where a real boat is: it is to hold.
    NavLost(VehicleId),
    /// It is known again where a real boat is.
    NavBack(VehicleId),
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
            Event::EStopped | Event::Released | Event::Halted | Event::WentOn | Event::Ended { .. } => None,
        }
    }

    /// The second boat that it took: the tagger, or the other of two in a collision.
    #[must_use]
    pub fn other(self) -> Option<VehicleId> {
        match self {
            Event::Tagged { cause: TagCause::Opponent(by), .. } => Some(by),
            Event::Collided { second, .. } => Some(second),
            _ => None,
        }
    }

    /// The flag that it is about.
    #[must_use]
    pub fn flag(self) -> Option<FlagId> {
        match self {
            Event::Grabbed { flag, .. } | Event::Captured { flag, .. } | Event::FlagReturned { flag, .. } => Some(flag),
            _ => None,
        }
    }
}

/// An event as two numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct EventRecord {
    /// Physics tick.
    pub tick: u64,
    /// Simulated time, ns.
    pub at_ns: SimTime,
    /// What happened: the constants of `EventRecord.msg`.
    pub kind: u8,
    /// The vehicle it happened to (the winning team, for `ENDED`), or -1.
    pub subject: i32,
    /// The flag, the tagger or the other vehicle, or -1.
    pub object: i32,
}

impl From<Logged> for EventRecord {
    fn from(logged: Logged) -> EventRecord {
        let v = |vehicle: VehicleId| i32::from(vehicle.0);
        let f = |flag: FlagId| i32::from(flag.0);
        let (kind, subject, object) = match logged.event {
            Event::Grabbed { vehicle, flag } => (0, v(vehicle), f(flag)),
            Event::Captured { vehicle, flag } => (1, v(vehicle), f(flag)),
            Event::Tagged { vehicle, cause: TagCause::Opponent(by) } => (2, v(vehicle), v(by)),
            Event::Tagged { vehicle, cause: TagCause::Boundary } => (3, v(vehicle), -1),
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
        EventRecord { tick: logged.tick, at_ns: logged.at, kind, subject, object }
    }
}

impl EventRecord {
    /// The event, if kind and numbers are ones we know.
    #[must_use]
    pub fn logged(&self) -> Option<Logged> {
        let vehicle = u16::try_from(self.subject).ok().map(VehicleId);
        let other = u16::try_from(self.object).ok().map(VehicleId);
        let flag = u8::try_from(self.object).ok().map(FlagId);
        let event = match self.kind {
            0 => Event::Grabbed { vehicle: vehicle?, flag: flag? },
            1 => Event::Captured { vehicle: vehicle?, flag: flag? },
            2 => Event::Tagged { vehicle: vehicle?, cause: TagCause::Opponent(other?) },
            3 => Event::Tagged { vehicle: vehicle?, cause: TagCause::Boundary },
            4 => Event::Untagged(vehicle?),
            5 => Event::FlagReturned { vehicle: vehicle?, flag: flag? },
            6 => Event::LeftField(vehicle?),
            7 => Event::ReturnedToField(vehicle?),
            8 => Event::Collided { first: vehicle?, second: other? },
            9 => Event::EnteredKeepout(vehicle?),
            10 => Event::Disabled(vehicle?),
            11 => Event::Enabled(vehicle?),
            12 => Event::AgentLost(vehicle?),
            13 => Event::AgentBack(vehicle?),
            14 => Event::Quarantined(vehicle?),
            15 => Event::Ended { winner: u8::try_from(self.subject).ok().map(TeamId) },
            16 => Event::NavLost(vehicle?),
            17 => Event::NavBack(vehicle?),
            18 => Event::EStopped,
            19 => Event::Released,
            20 => Event::Halted,
            21 => Event::WentOn,
            _ => return None,
        };
        Some(Logged { tick: self.tick, at: self.at_ns, event })
    }
}
