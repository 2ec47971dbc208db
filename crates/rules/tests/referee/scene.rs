//! A scene: boats placed by hand on the 160 m by 80 m field, and judged.

use primitives::near::Near;
use primitives::reseed::Seeds;
use primitives::stream::Stream;
use primitives::{FlagId, Leg, Ned, SimTime, TeamId, VehicleId};
use rules::event::{Event, TagCause};
use rules::field::{Field, Flag, FlagSettings, Plan};
use rules::{Asks, Directive, Look, Notes, Referee, Rules, Standing};

pub(crate) struct Scene {
    pub(crate) referee: Referee,
    pub(crate) standing: Standing,
    pub(crate) notes: Notes,
    pub(crate) near: Near,
    pub(crate) fleet: Vec<Leg>,
    /// The boats' requests, for rules that require them.
    pub(crate) asks: Vec<Asks>,
    pub(crate) now: SimTime,
}

/// Time between two checks.
pub(crate) const TICK: SimTime = SimTime(100_000_000);

/// Flags at (20, 40) and (140, 40), the scrimmage line at x = 80.
pub(crate) fn field(extra_flags: Vec<Flag>) -> Field {
    rectangle(0.0, 160.0, extra_flags)
}

fn rectangle(x_m: f64, width_m: f64, extra_flags: Vec<Flag>) -> Field {
    let plan = Plan {
        along_deg: 90.0,
        depth_m: 80.0,
        flag_inset_m: 20.0,
        ..Plan::default()
    };
    Field::new(Plan {
        corner: Ned::from_xy(x_m, 0.0),
        width_m,
        extra_flags,
        ..plan
    })
}

pub(crate) fn flag(team: u8, x: f64, y: f64) -> Flag {
    Flag {
        team: TeamId(team),
        start: Ned::from_xy(x, y),
        settings: FlagSettings::default(),
    }
}

/// The first `boats` vehicles play for the first team, the next `boats` for the second, and so on.
pub(crate) fn teams_of(boats: usize, teams: usize) -> Vec<TeamId> {
    (0..boats * teams)
        .map(|i| TeamId((i / boats) as u8))
        .collect()
}

/// Three sides of 64 m each, side by side, with one flag each.
pub(crate) fn three_sided(rules: Rules) -> Scene {
    let mut field = rectangle(0.0, 192.0, vec![flag(2, 160.0, 40.0)]);
    let thirds = [0.0, 64.0, 128.0].map(|x_m| rectangle(x_m, 128.0, vec![]));
    field.zones = thirds.iter().map(|third| third.zones[0].clone()).collect();
    field.own_corners = thirds.iter().map(|third| third.own_corners[0]).collect();
    field.flags[1] = flag(1, 96.0, 40.0);
    Scene::on(rules, field, teams_of(1, 3))
}

impl Scene {
    /// Two teams of `boats` boats each on the plain field.
    pub(crate) fn new(rules: Rules, boats: usize) -> Scene {
        Scene::on(rules, field(vec![]), teams_of(boats, 2))
    }

    /// Every boat waits on its own side, 12 m from its neighbours, out of reach of everything.
    pub(crate) fn on(rules: Rules, field: Field, team_of: Vec<TeamId>) -> Scene {
        let referee = Referee {
            joins: vec![SimTime::ZERO; team_of.len()],
            rules,
            field,
            team_of,
            tag_noise: Seeds::from(1).noise("tags"),
        };
        let standing = referee.start(&mut Stream::new(1, "rules"));
        let start_position = |(i, team): (usize, &TeamId)| {
            let before = referee.team_of[..i]
                .iter()
                .filter(|other| *other == team)
                .count();
            still(
                if team.0 == 0 { 45.0 } else { 115.0 },
                5.0 + 12.0 * before as f64,
            )
        };
        let fleet = referee
            .team_of
            .iter()
            .enumerate()
            .map(start_position)
            .collect();
        let asks = vec![Asks::default(); referee.team_of.len()];
        Scene {
            standing,
            fleet,
            asks,
            referee,
            notes: Notes::default(),
            near: Near::default(),
            now: SimTime::ZERO,
        }
    }

    pub(crate) fn name(&self) -> &str {
        &self.referee.rules.name
    }

    pub(crate) fn put(&mut self, vehicle: usize, x: f64, y: f64) -> &mut Scene {
        self.fleet[vehicle] = still(x, y);
        self
    }

    /// Moves a boat from its current position.
    pub(crate) fn go(&mut self, vehicle: usize, x: f64, y: f64) -> &mut Scene {
        self.fleet[vehicle].to = Ned::from_xy(x, y);
        self
    }

    /// Lets time pass without a check.
    pub(crate) fn wait(&mut self, seconds: f64) -> &mut Scene {
        self.now = self.now + SimTime::from_s(seconds) - TICK;
        self
    }

    /// Advances one tick and returns its events.
    pub(crate) fn look(&mut self) -> Vec<Event> {
        self.now = self.now + TICK;
        let near = self.near.pairs(
            |i| self.fleet[i].to,
            self.fleet.len(),
            self.referee.rules.reach_m(),
        );
        let mut events = vec![];
        let look = Look {
            legs: &self.fleet,
            asks: &self.asks,
            near,
            now: self.now,
        };
        self.referee
            .advance(&mut self.standing, &mut self.notes, &look, &mut events);
        self.fleet.iter_mut().for_each(|leg| leg.from = leg.to);
        events
    }

    pub(crate) fn directive(&self, vehicle: usize) -> Directive {
        self.referee.directive(
            &self.standing,
            VehicleId::at(vehicle),
            self.fleet[vehicle].to,
        )
    }
}

/// A boat at rest at this position.
fn still(x: f64, y: f64) -> Leg {
    let at = Ned::from_xy(x, y);
    Leg { from: at, to: at }
}

pub(crate) fn tagged(vehicle: u16, by: u16) -> Event {
    Event::Tagged {
        vehicle: VehicleId(vehicle),
        cause: TagCause::Opponent(VehicleId(by)),
    }
}

pub(crate) fn freed(vehicle: u16) -> Event {
    Event::Untagged(VehicleId(vehicle))
}

pub(crate) fn grabbed(vehicle: u16, flag: u8) -> Event {
    Event::Grabbed {
        vehicle: VehicleId(vehicle),
        flag: FlagId(flag),
    }
}

pub(crate) fn lost(vehicle: u16, flag: u8) -> Event {
    Event::FlagReturned {
        vehicle: VehicleId(vehicle),
        flag: FlagId(flag),
    }
}
