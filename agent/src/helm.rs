//! What every simple mind needs to steer by: the points that matter to its boat, and how to go home.

use game::rules::{CaptureAt, UntagAt};
use game::scenario::Scenario;
use game::{FlagId, Ned, Order, TeamId, VehicleId};

/// The chart of one boat: what it steers by.
#[derive(Clone, Debug)]
pub(crate) struct Chart {
    pub(crate) me: VehicleId,
    /// The flags to attack.
    pub(crate) targets: Vec<(FlagId, Ned)>,
    own_flag: Ned,
    own_corners: [Ned; 2],
    capture_at: CaptureAt,
    untag_at: UntagAt,
    untag_radius_m: f64,
    /// Tagged inside of its home: it must leave before it can come home.
    leaving: bool,
}

impl Chart {
    pub(crate) fn new(scenario: &Scenario, me: VehicleId) -> Chart {
        let team = scenario.vehicles[me.index()].team;
        let field = &scenario.field;
        let flags = field.flags.iter().enumerate();
        let targets = flags.filter(|(_, flag)| flag.team != team).map(|(i, flag)| (FlagId(i as u8), flag.home));
        Chart {
            me,
            targets: targets.collect(),
            own_flag: own_flag(scenario, team),
            own_corners: field.own_corners[team.index()],
            capture_at: scenario.rules.capture_at,
            untag_at: scenario.rules.untag_at,
            untag_radius_m: scenario.rules.untag_radius_m,
            leaving: false,
        }
    }

    /// Where a flag must be brought, from here.
    pub(crate) fn capture_point(&self, at: Ned) -> Ned {
        match self.capture_at {
            CaptureAt::OwnFlag | CaptureAt::OwnSide => self.own_flag,
            CaptureAt::OwnCorners => self.nearest_corner(at),
        }
    }

    /// The way to be untagged: home, or, where the boat was tagged inside of its home, out of it first.
    pub(crate) fn untag(&mut self, at: Ned, speed_m_s: f64) -> Order {
        let home = match self.untag_at {
            UntagAt::OwnFlag => self.own_flag,
            UntagAt::OwnCorners => self.nearest_corner(at),
        };
        // A boat that comes home is freed at the edge; one that is well inside and still tagged was tagged there.
        let distance_m = at.distance(home);
        if distance_m < 0.5 * self.untag_radius_m {
            self.leaving = true;
        } else if distance_m > 1.2 * self.untag_radius_m {
            self.leaving = false;
        }
        match (self.leaving, self.targets.first()) {
            (true, Some((_, away))) => steer_to(at, *away, speed_m_s),
            _ => steer_to(at, home, speed_m_s),
        }
    }

    fn nearest_corner(&self, at: Ned) -> Ned {
        let [a, b] = self.own_corners;
        if at.distance_squared(a) <= at.distance_squared(b) { a } else { b }
    }
}

fn own_flag(scenario: &Scenario, team: TeamId) -> Ned {
    let flag = scenario.field.flag_of(team).expect("a checked field has a flag for every team");
    scenario.field.flags[flag.index()].home
}

/// Straight there.
pub(crate) fn steer_to(from: Ned, to: Ned, speed_m_s: f64) -> Order {
    Order::Steer { heading_rad: from.bearing_rad(to), speed_m_s }
}
