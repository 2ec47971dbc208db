//! The field: one rectangle on the water, and the geometry derived from it once.
//!
//! ```text
//!        corner 1 ──────────────── corner 2        `along` runs from the first team's end to the
//!           │  first  :  second  │                 second's; `across` is a quarter turn to port of it.
//!   across ▲│    ⚑    :    ⚑     │                 Default flags are midway across, `flag_inset_m`
//!          ││  team   :   team   │                 from the ends; the scrimmage line halves the field.
//!        corner 0 ──────────────── corner 3
//!              along ▶
//! ```

mod flag;
mod own;
mod route;

pub use flag::{Flag, FlagRadii, FlagSettings};
pub use route::Route;

use primitives::frame::{LatLon, Ned};
use primitives::id::TeamId;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// The content of a field file; [`Field::new`] derives the rest. `E` is `Option<f64>` in a file,
/// where an estimated number may be omitted.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Plan<E = f64> {
    /// The field file's stem.
    #[schemars(skip)]
    pub name: String,
    /// Geographic position of the local origin. Real boats need it to navigate.
    pub datum: LatLon,
    /// The starboard corner of the first team's end, as seen facing the opponent, [x, y] in m.
    #[schemars(with = "[f64; 2]", inner(range(min = -1000000, max = 1000000)))]
    #[schemars(extend("x-field" = "corner", "default" = [0, 0]))]
    pub corner: Ned,
    /// Compass bearing from the first team's end to the second's, degrees.
    #[schemars(range(min = -360, max = 360), extend("default" = 90))]
    pub along_deg: f64,
    /// Extent from end to end, m.
    #[schemars(range(min = 10, max = 20000))]
    pub width_m: f64,
    /// Extent across the field, m.
    #[schemars(range(min = 10, max = 20000))]
    pub depth_m: f64,
    /// Distance of the flags from the ends, m, above 0 and below half the width. Default: width /
    /// 8.
    pub flag_inset_m: E,
    /// Settings of the default flags, by team.
    #[serde(default, skip_serializing_if = "are_empty")]
    #[schemars(skip)]
    pub default_flags: [FlagSettings; 2],
    /// Flags in addition to each team's default flag.
    #[serde(default)]
    #[schemars(skip)]
    pub extra_flags: Vec<Flag>,
    /// Solid obstacles.
    #[serde(default)]
    #[schemars(skip)]
    pub obstacles: Vec<Obstacle>,
    /// Whether the edges are walls.
    #[schemars(extend("default" = "none"))]
    pub walls: Walls,
}

fn are_empty(flags: &[FlagSettings; 2]) -> bool {
    flags.iter().all(FlagSettings::is_empty)
}

/// Whether the edges of the field are walls.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Walls {
    /// Open water all around.
    #[default]
    #[serde(alias = "None")]
    None,
    /// A solid wall on every edge.
    #[serde(alias = "AllRound")]
    AllRound,
}

/// A solid obstacle in the water.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum Obstacle {
    /// A circle.
    Circle {
        /// Centre.
        centre: Ned,
        /// Radius, m.
        radius_m: f64,
    },
    /// A polygon whose sides do not cross.
    Polygon {
        /// At least three corners, in order, in either direction.
        corners: Vec<Ned>,
    },
}

impl Obstacle {
    /// Whether the obstacle contains a position.
    pub fn contains(&self, at: Ned) -> bool {
        match self {
            Obstacle::Circle { centre, radius_m } => centre.distance(at) < *radius_m,
            Obstacle::Polygon { corners } => is_within(corners, at),
        }
    }

    /// The distance to the obstacle, m; 0 inside.
    pub fn distance(&self, at: Ned) -> f64 {
        match self {
            Obstacle::Circle { centre, radius_m } => (centre.distance(at) - radius_m).max(0.0),
            Obstacle::Polygon { corners } if is_within(corners, at) => 0.0,
            Obstacle::Polygon { corners } => distance_to_outline(corners, at),
        }
    }
}

/// The sides of a polygon, from corner to corner and back to the first.
pub fn sides(corners: &[Ned]) -> impl Iterator<Item = (Ned, Ned)> {
    corners
        .iter()
        .copied()
        .zip(corners.iter().copied().cycle().skip(1))
}

/// Whether a polygon contains a position: a ray from the position crosses the outline an odd number
/// of times.
pub fn is_within(corners: &[Ned], at: Ned) -> bool {
    let crossed = |(a, b): &(Ned, Ned)| {
        (a.east > at.east) != (b.east > at.east)
            && at.north < (b.north - a.north) * (at.east - a.east) / (b.east - a.east) + a.north
    };
    sides(corners).filter(crossed).count() % 2 == 1
}

/// The distance to the outline of a polygon, m; infinite without corners.
pub fn distance_to_outline(corners: &[Ned], at: Ned) -> f64 {
    sides(corners)
        .map(|(a, b)| distance_to_side(a, b, at))
        .fold(f64::INFINITY, f64::min)
}

/// The distance to the line segment from `a` to `b`, m.
pub fn distance_to_side(a: Ned, b: Ned, at: Ned) -> f64 {
    let side = b - a;
    let from_a = at - a;
    let length_squared = side.dot(side);
    let share = if length_squared > 0.0 {
        (from_a.dot(side) / length_squared).clamp(0.0, 1.0)
    } else {
        0.0
    };
    from_a.distance(side.scaled(share))
}

/// The distance between a polygon's outline and the line segment from `a` to `b`, m; 0 if they
/// intersect.
pub fn distance_to_line(corners: &[Ned], (a, b): (Ned, Ned)) -> f64 {
    if is_within(corners, a) || sides(corners).any(|side| do_meet(side, (a, b))) {
        return 0.0;
    }
    let of_ends = distance_to_outline(corners, a).min(distance_to_outline(corners, b));
    corners
        .iter()
        .map(|corner| distance_to_side(a, b, *corner))
        .fold(of_ends, f64::min)
}

/// Whether two line segments have a common point.
pub fn do_meet((a, b): (Ned, Ned), (c, d): (Ned, Ned)) -> bool {
    let c_side = turn(a, b, c);
    let d_side = turn(a, b, d);
    let a_side = turn(c, d, a);
    let b_side = turn(c, d, b);
    let apart = |p: f64, q: f64| (p > 0.0 && q > 0.0) || (p < 0.0 && q < 0.0);
    if apart(c_side, d_side) || apart(a_side, b_side) {
        return false;
    }
    // Unless all points are collinear, the segments intersect if each reaches both sides of the
    // other's line.
    let in_line = c_side == 0.0 && d_side == 0.0;
    let overlaps = |p: f64, q: f64, r: f64, s: f64| p.min(q) <= r.max(s) && r.min(s) <= p.max(q);
    !in_line
        || (overlaps(a.north, b.north, c.north, d.north)
            && overlaps(a.east, b.east, c.east, d.east))
}

/// Twice the area of the triangle, positive clockwise on the chart.
pub fn turn(a: Ned, b: Ned, c: Ned) -> f64 {
    (b.north - a.north) * (c.east - a.east) - (b.east - a.east) * (c.north - a.north)
}

/// A convex region bounded by straight edges. The edges belong to it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Zone {
    /// Outward unit normals, each with the maximum of its scalar product with any point inside.
    edges: Vec<(Ned, f64)>,
    /// The corners, in order.
    pub corners: Vec<Ned>,
}

impl Zone {
    /// The convex polygon with these corners, in clockwise order on the chart.
    fn new(corners: Vec<Ned>) -> Zone {
        let edge = |(a, b): (Ned, Ned)| {
            let side = b - a;
            let length = a.distance(b);
            // A quarter turn to port of the side's direction: outward, because the corners are
            // clockwise.
            let out = Ned {
                north: side.east / length,
                east: -side.north / length,
            };
            (out, out.dot(a))
        };
        Zone {
            edges: sides(&corners).map(edge).collect(),
            corners,
        }
    }

    /// Whether `at` is inside or on an edge, with a tolerance of 1e-9 m for rounding.
    #[inline]
    pub fn contains(&self, at: Ned) -> bool {
        self.edges
            .iter()
            .all(|(out, limit)| out.dot(at) <= limit + 1e-9)
    }
}

/// The field with all geometry derived from its plan.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Field {
    /// The contents of the field file.
    pub plan: Plan,
    /// Unit vector from the first team's end to the second's.
    pub along: Ned,
    /// Unit vector a quarter turn to port of `along`.
    pub across: Ned,
    /// The corners, clockwise from corner 0.
    pub corners: [Ned; 4],
    /// All flags; the first two are the teams' default flags.
    pub flags: Vec<Flag>,
    /// Each team's own side, by team.
    pub zones: Vec<Zone>,
    /// The corners of each team's own end, by team.
    pub own_corners: Vec<[Ned; 2]>,
    /// The scrimmage line.
    pub scrimmage: [Ned; 2],
}

/// The columns of the named points, from port to starboard, as seen facing the opponent's end.
const COLUMNS: [(&str, f64); 5] = [
    ("PP", 0.0),
    ("P", 0.25),
    ("C", 0.5),
    ("S", 0.75),
    ("SS", 1.0),
];
/// The rows of the named points, from the team's own end: back, flag, half, mid, centre, and their
/// mirror images.
const ROWS: [&str; 9] = ["B", "F", "H", "M", "C", "MX", "HX", "FX", "BX"];

impl Field {
    /// Derives all geometry from the plan. Of the two teams, the first has the end at corner 0.
    pub fn new(plan: Plan) -> Field {
        let along = Ned::toward_deg(plan.along_deg);
        let across = Ned {
            north: along.east,
            east: -along.north,
        };
        let at = |x: f64, y: f64| plan.corner + along.scaled(x) + across.scaled(y);
        let w = plan.width_m;
        let d = plan.depth_m;
        let half = plan.width_m / 2.0;
        let corners = [at(0.0, 0.0), at(0.0, d), at(w, d), at(w, 0.0)];
        let mut flags = vec![
            Flag {
                team: TeamId(0),
                start: at(plan.flag_inset_m, d / 2.0),
                settings: plan.default_flags[0].clone(),
            },
            Flag {
                team: TeamId(1),
                start: at(w - plan.flag_inset_m, d / 2.0),
                settings: plan.default_flags[1].clone(),
            },
        ];
        flags.extend_from_slice(&plan.extra_flags);
        let zones = vec![
            Zone::new(vec![at(0.0, 0.0), at(0.0, d), at(half, d), at(half, 0.0)]),
            Zone::new(vec![at(half, 0.0), at(half, d), at(w, d), at(w, 0.0)]),
        ];
        let own_corners = vec![[corners[0], corners[1]], [corners[2], corners[3]]];
        let scrimmage = [at(half, 0.0), at(half, d)];
        Field {
            along,
            across,
            corners,
            flags,
            zones,
            own_corners,
            scrimmage,
            plan,
        }
    }

    /// The position `along_m` from the first team's end and `across_m` from the edge at corner 0.
    pub fn at(&self, along_m: f64, across_m: f64) -> Ned {
        self.plan.corner + self.along.scaled(along_m) + self.across.scaled(across_m)
    }

    /// Field coordinates of `at`: (metres along, metres across).
    #[inline]
    pub fn along_across(&self, at: Ned) -> (f64, f64) {
        let from_corner = at - self.plan.corner;
        (from_corner.dot(self.along), from_corner.dot(self.across))
    }

    /// The centre of the field.
    pub fn middle(&self) -> Ned {
        (self.corners[0] + self.corners[2]).scaled(0.5)
    }

    /// Whether `at` is on the field, excluding the boundary.
    #[inline]
    pub fn contains(&self, at: Ned) -> bool {
        let (x, y) = self.along_across(at);
        x > 0.0 && x < self.plan.width_m && y > 0.0 && y < self.plan.depth_m
    }

    /// Distance of `at` from the nearest side of the field, m; negative outside.
    pub fn inside_by_m(&self, at: Ned) -> f64 {
        let (x, y) = self.along_across(at);
        x.min(self.plan.width_m - x)
            .min(y)
            .min(self.plan.depth_m - y)
    }

    /// Compass bearing from the end of `team` to its opponent's end, degrees.
    pub fn facing_deg(&self, team: TeamId) -> f64 {
        if team.index() == 0 {
            self.plan.along_deg
        } else {
            self.plan.along_deg + 180.0
        }
    }

    /// Target for a boat of `team` at `at` on its way to a corner of its own end: the nearer of the
    /// two points `inset_m` inside both edges. The corners themselves are on the boundary, so a
    /// boat coming from outside would follow the edge on the wrong side.
    pub fn inside_own_corner(&self, team: TeamId, at: Ned, inset_m: f64) -> Option<Ned> {
        // Clockwise: the field is to starboard of the direction from the first corner to the
        // second.
        let [first, second] = *self.own_corners.get(team.index())?;
        let ahead = (second - first).scaled(inset_m / first.distance(second));
        let inward = Ned {
            north: -ahead.east,
            east: ahead.north,
        };
        let first = first + ahead + inward;
        let second = second - ahead + inward;
        Some(
            if at.distance_squared(first) <= at.distance_squared(second) {
                first
            } else {
                second
            },
        )
    }

    /// The named point of `team`, as seen from its own end: a column (`PP P C S SS`, port to
    /// starboard) and a row (`B` back, `F` flag line, `H` half of its side, `M` between `H` and the
    /// centre, `C` centre line, then `MX HX FX BX` on the other side).
    pub fn point(&self, team: TeamId, name: &str) -> Option<Ned> {
        let row_names = ROWS.iter().enumerate().rev();
        let (column, row) = row_names
            .filter_map(|(row, row_name)| Some((name.strip_suffix(row_name)?, row)))
            .find_map(|(rest, row)| {
                Some((COLUMNS.iter().find(|(name, _)| *name == rest)?.1, row))
            })?;
        let along_m = match row {
            1 => self.plan.flag_inset_m,
            7 => self.plan.width_m - self.plan.flag_inset_m,
            _ => self.plan.width_m * row as f64 / 8.0,
        };
        Some(self.seen_from(team, along_m, self.plan.depth_m * column))
    }

    /// The position `ahead_m` from the team's own end and `from_port_m` from the edge on its port
    /// side.
    pub fn seen_from(&self, team: TeamId, ahead_m: f64, from_port_m: f64) -> Ned {
        // The first team faces in the direction `along`, so its port side is where `across` is
        // largest.
        if team.index() == 0 {
            self.at(ahead_m, self.plan.depth_m - from_port_m)
        } else {
            self.at(self.plan.width_m - ahead_m, from_port_m)
        }
    }

    /// All names that [`Field::point`] accepts.
    pub fn point_names() -> Vec<String> {
        COLUMNS
            .iter()
            .flat_map(|(column, _)| ROWS.iter().map(move |row| format!("{column}{row}")))
            .collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn polygon<const N: usize>(corners: [(f64, f64); N]) -> Vec<Ned> {
        corners.map(|(x, y)| Ned::from_xy(x, y)).to_vec()
    }

    #[test]
    fn a_polygon_knows_its_inside_and_its_distance() {
        let bay = polygon([(0.0, 0.0), (4.0, 0.0), (4.0, 4.0), (2.0, 1.0), (0.0, 4.0)]);
        for (x, y, want) in [
            (1.0, 0.5, true),
            (2.0, 2.0, false),
            (3.9, 3.5, true),
            (-1.0, 1.0, false),
        ] {
            assert_eq!(is_within(&bay, Ned::from_xy(x, y)), want, "{x} {y}");
        }
        let bay = Obstacle::Polygon { corners: bay };
        for (x, y, want_m) in [(2.0, -3.0, 3.0), (-3.0, -4.0, 5.0), (1.0, 0.5, 0.0)] {
            assert!(
                (bay.distance(Ned::from_xy(x, y)) - want_m).abs() < 1e-12,
                "{x} {y}"
            );
        }
        let round = Obstacle::Circle {
            centre: Ned::from_xy(1.0, 1.0),
            radius_m: 2.0,
        };
        assert!(
            round.contains(Ned::from_xy(2.0, 1.0)) && round.distance(Ned::from_xy(2.0, 1.0)) == 0.0
        );
        assert!((round.distance(Ned::from_xy(6.0, 1.0)) - 3.0).abs() < 1e-12);
    }

    #[test]
    fn a_line_passes_a_polygon_as_near_as_its_nearest_point() {
        let wall = polygon([(0.0, 0.0), (10.0, 0.0), (10.0, 1.0), (0.0, 1.0)]);
        let line = |a: (f64, f64), b: (f64, f64)| (Ned::from_xy(a.0, a.1), Ned::from_xy(b.0, b.1));
        for (a, b, want_m) in [
            ((5.0, -4.0), (5.0, 5.0), 0.0),
            ((5.0, 0.5), (6.0, 0.5), 0.0),
            ((-3.0, -4.0), (13.0, -4.0), 4.0),
            ((13.0, 5.0), (20.0, 9.0), 5.0),
            ((12.0, -8.0), (12.0, 8.0), 2.0),
        ] {
            let got_m = distance_to_line(&wall, line(a, b));
            assert!((got_m - want_m).abs() < 1e-12, "{a:?} {b:?}: {got_m}");
        }
    }

    fn plan(
        corner: (f64, f64),
        along_deg: f64,
        width_m: f64,
        depth_m: f64,
        flag_inset_m: f64,
    ) -> Plan {
        let corner = Ned::from_xy(corner.0, corner.1);
        Plan {
            corner,
            along_deg,
            width_m,
            depth_m,
            flag_inset_m,
            ..Plan::default()
        }
    }

    fn assert_near(got: Ned, x: f64, y: f64) {
        assert!(
            got.distance(Ned::from_xy(x, y)) < 0.02,
            "({}, {}) is not ({x}, {y})",
            got.east,
            got.north
        );
    }

    #[test]
    fn the_axis_aligned_field_has_exact_coordinates() {
        let field = Field::new(plan((0.0, 0.0), 90.0, 160.0, 80.0, 20.0));
        assert_eq!(field.flags[0].start, Ned::from_xy(20.0, 40.0));
        assert_eq!(field.flags[1].start, Ned::from_xy(140.0, 40.0));
        assert_eq!(
            field.scrimmage,
            [Ned::from_xy(80.0, 0.0), Ned::from_xy(80.0, 80.0)]
        );
        assert_eq!(field.corners[2], Ned::from_xy(160.0, 80.0));
    }

    #[test]
    fn published_fields_come_out_where_they_were_sailed() {
        // Corners and flags as in the 2025 West Point and 2023 Jervis Bay missions.
        let popolopen = Field::new(plan((225.4522, 42.2876), 20.0, 160.0, 80.0, 20.0));
        assert_near(popolopen.flags[0].start, 194.71, 74.76);
        assert_near(popolopen.flags[1].start, 235.75, 187.53);
        assert_near(popolopen.corners[1], 150.28, 69.65);
        assert_near(popolopen.corners[2], 205.0, 220.0);
        assert_near(popolopen.corners[3], 280.18, 192.64);
    }

    #[test]
    fn boats_steer_for_points_inside_of_their_own_corners() {
        // The targets in the 2026 competition: 10 m from both edges.
        let field = Field::new(plan((0.0, 0.0), 90.0, 160.0, 80.0, 20.0));
        for (team, from, want) in [
            (0, (40.0, 81.0), (10.0, 70.0)),
            (0, (-3.0, 20.0), (10.0, 10.0)),
            (1, (90.0, 60.0), (150.0, 70.0)),
            (1, (165.0, -5.0), (150.0, 10.0)),
        ] {
            let got = field.inside_own_corner(TeamId(team), Ned::from_xy(from.0, from.1), 10.0);
            assert_eq!(
                got,
                Some(Ned::from_xy(want.0, want.1)),
                "team {team} from {from:?}"
            );
        }
        let aslant = Field::new(plan((225.4522, 42.2876), 20.0, 160.0, 80.0, 20.0));
        let got = aslant
            .inside_own_corner(TeamId(1), aslant.at(150.0, 90.0), 10.0)
            .expect("it has corners");
        assert!(got.distance(aslant.at(150.0, 70.0)) < 1e-9, "{got:?}");
    }

    #[test]
    fn the_scrimmage_line_is_on_both_sides_and_the_boundary_is_out() {
        for (corner, along_deg) in [
            ((0.0, 0.0), 90.0),
            ((225.4522, 42.2876), 20.0),
            ((3.0, -7.0), 251.0),
        ] {
            let field = Field::new(plan(corner, along_deg, 160.0, 80.0, 20.0));
            let side = |x, y| {
                field
                    .zones
                    .iter()
                    .map(|z| z.contains(field.at(x, y)))
                    .collect::<Vec<_>>()
            };
            assert_eq!(side(80.0, 30.0), [true, true], "{along_deg}");
            assert_eq!(side(79.9, 30.0), [true, false], "{along_deg}");
            assert_eq!(side(80.1, 30.0), [false, true], "{along_deg}");
            assert!(field.contains(field.at(0.1, 0.1)) && !field.contains(field.at(-0.1, 0.1)));
            assert!(!field.contains(field.at(80.0, 80.1)));
        }
    }

    #[test]
    fn named_points_are_seen_from_a_teams_own_end() {
        let field = Field::new(plan((0.0, 0.0), 90.0, 160.0, 80.0, 20.0));
        for (team, name, x, y) in [
            (0, "CF", 20.0, 40.0),
            (1, "CF", 140.0, 40.0),
            (0, "PPB", 0.0, 80.0),
            (1, "PPB", 160.0, 0.0),
            (0, "SSBX", 160.0, 0.0),
            (0, "CH", 40.0, 40.0),
            (0, "CM", 60.0, 40.0),
            (1, "PC", 80.0, 20.0),
            (0, "CFX", 140.0, 40.0),
            (0, "PMX", 100.0, 60.0),
        ] {
            assert_eq!(
                field.point(TeamId(team), name),
                Some(Ned::from_xy(x, y)),
                "{name}"
            );
        }
        for unknown in ["", "C", "X", "QF", "CFF", "cf", "BX"] {
            assert_eq!(field.point(TeamId(0), unknown), None, "{unknown}");
        }
        assert_eq!(Field::point_names().len(), 45);
        assert!(
            Field::point_names()
                .iter()
                .all(|name| field.point(TeamId(1), name).is_some())
        );
    }
}
