//! A boat's progress and its position among the other boats: the input to potentials and places.

use primitives::frame::Ned;
use primitives::id::TeamId;
use primitives::time::SimTime;
use rules::field::Field;
use sim::Contest;

/// Distance within which a guard position has value, as a fraction of the field's width.
const REACH: f64 = 0.25;
/// A guard's distance from the flag or teammate towards the enemy, as a fraction of the field's
/// width.
const STAND_OFF: f64 = 0.125;

/// A boat on the field, in one of two teams.
#[derive(Clone, Copy)]
struct Placed {
    at: Ned,
    team: TeamId,
    tagged: bool,
    carrying: bool,
}

/// A boat's progress and its position among the other boats.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct BoatProgress {
    /// Whether the boat is tagged.
    pub tagged: bool,
    /// Whether the boat carries a flag.
    pub carrying: bool,
    /// Distance from the nearest enemy flag, in field widths.
    pub from_flag: f64,
    /// Distance from its team's nearest flag, in field widths. Under most rules, this is where
    /// flags are brought and tagged boats are untagged.
    pub from_home: f64,
    /// The boat's position among the other boats, if requested.
    pub among: Among,
}

/// A boat's position among the other boats, each value from 0 to 1.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Among {
    /// Proximity to the nearest intruder, an untagged enemy on the boat's side: 1 at its position,
    /// 0 at a distance of a field width or more, or without intruders.
    pub at_intruder: f64,
    /// Proximity to the place that guards the team's flag; see
    /// [`Place::guard`](super::Place::guard).
    pub on_guard: f64,
    /// Proximity to the place that shields a teammate; see [`Place::shield`](super::Place::shield).
    pub at_shield: f64,
    /// Distance from the nearest untagged enemy: 0 at its position, 1 at a quarter of the field's
    /// width and beyond.
    pub clear: f64,
}

/// Each boat's progress according to its own sensors and, with `among_others`, its position among
/// the other boats.
pub fn progress(contest: &Contest, among_others: bool) -> Vec<BoatProgress> {
    let scenario = contest.scenario();
    let placed = |team: TeamId| Placed {
        at: Ned::default(),
        team,
        tagged: false,
        carrying: false,
    };
    let mut boats: Vec<Placed> = scenario
        .vehicles
        .iter()
        .map(|vehicle| placed(vehicle.team))
        .collect();
    for boat in contest
        .last_pictures()
        .iter()
        .flat_map(|picture| &picture.own)
    {
        let at = boat.nav.at();
        let tagged = boat.tagged;
        let carrying = boat.carried_flag().is_some();
        boats[boat.vehicle.index()] = Placed {
            at,
            tagged,
            carrying,
            team: scenario.team_of(boat.vehicle),
        };
    }
    of_boats((&scenario.field, contest.now()), &boats, among_others)
}

fn of_boats(
    (field, now): (&Field, SimTime),
    boats: &[Placed],
    among_others: bool,
) -> Vec<BoatProgress> {
    let posts = among_others.then(|| Posts::of((field, now), boats));
    let progress = |(i, boat): (usize, &Placed)| {
        let away = |team: TeamId| {
            let flag = field.nearest_own_flag(team, boat.at, now);
            let (_, home) = flag.expect("each team has a flag");
            boat.at.distance(home) / field.plan.width_m
        };
        let Placed {
            tagged,
            carrying,
            team,
            ..
        } = *boat;
        let among = posts
            .as_ref()
            .map_or_else(Among::default, |posts| posts.among(field, boats, i));
        BoatProgress {
            tagged,
            carrying,
            from_flag: away(TeamId(1 - team.0)),
            from_home: away(team),
            among,
        }
    };
    boats.iter().enumerate().map(progress).collect()
}

/// The places from which flags and teammates are protected.
struct Posts {
    /// By team, the place that guards its flag: if it has several, the one nearest to an untagged
    /// enemy. `None` without untagged enemies.
    flag: [Option<Ned>; 2],
    /// Untagged boats on the enemies' side: index, distance to the nearest untagged enemy in
    /// metres, and the place that shields the boat from that enemy.
    mates: Vec<(usize, f64, Ned)>,
}

impl Posts {
    fn of((field, now): (&Field, SimTime), boats: &[Placed]) -> Posts {
        let stand_off_m = STAND_OFF * field.plan.width_m;
        let flag = [0, 1].map(|team: u8| {
            let team = TeamId(team);
            let threats = field
                .own_flags(team)
                .map(|(_, flag)| flag.home(now))
                .filter_map(|home| Some((home, nearest_enemy(boats, team, home)?)));
            let worst = threats.min_by(|a, b| a.0.distance(a.1).total_cmp(&b.0.distance(b.1)));
            worst.map(|(home, enemy)| between(home, enemy, stand_off_m))
        });
        let abroad =
            |boat: &Placed| !boat.tagged && field.is_own_side(TeamId(1 - boat.team.0), boat.at);
        let post = |(i, boat): (usize, &Placed)| {
            let enemy = nearest_enemy(boats, boat.team, boat.at)?;
            Some((
                i,
                boat.at.distance(enemy),
                between(boat.at, enemy, stand_off_m),
            ))
        };
        let mates = boats
            .iter()
            .enumerate()
            .filter(|(_, boat)| abroad(boat))
            .filter_map(post)
            .collect();
        Posts { flag, mates }
    }

    fn among(&self, field: &Field, boats: &[Placed], i: usize) -> Among {
        let width_m = field.plan.width_m;
        let me = &boats[i];
        let near =
            |place: Ned, reach: f64| (1.0 - me.at.distance(place) / (reach * width_m)).max(0.0);
        let intruders = boats.iter().filter(|boat| {
            boat.team != me.team && !boat.tagged && field.is_own_side(me.team, boat.at)
        });
        let of_team = self
            .mates
            .iter()
            .filter(|(mate, ..)| *mate != i && boats[*mate].team == me.team);
        Among {
            at_intruder: intruders.map(|boat| near(boat.at, 1.0)).fold(0.0, f64::max),
            on_guard: self.flag[me.team.index()].map_or(0.0, |post| near(post, REACH)),
            at_shield: of_team
                .min_by(|a, b| a.1.total_cmp(&b.1))
                .map_or(0.0, |(.., post)| near(*post, REACH)),
            clear: nearest_enemy(boats, me.team, me.at)
                .map_or(1.0, |enemy| 1.0 - near(enemy, REACH)),
        }
    }
}

/// The position of the team's nearest untagged enemy.
fn nearest_enemy(boats: &[Placed], team: TeamId, to: Ned) -> Option<Ned> {
    let enemies = boats
        .iter()
        .filter(|boat| boat.team != team && !boat.tagged);
    enemies
        .map(|boat| boat.at)
        .min_by(|a, b| a.distance(to).total_cmp(&b.distance(to)))
}

/// The point at distance `off_m` from `from` towards `to`, or `to` if it is nearer.
fn between(from: Ned, to: Ned, off_m: f64) -> Ned {
    let away_m = from.distance(to);
    if away_m <= off_m {
        to
    } else {
        from + (to - from).scaled(off_m / away_m)
    }
}

#[cfg(test)]
mod tests {
    use super::{Among, BoatProgress, Placed, of_boats};
    use primitives::frame::LatLon;
    use primitives::id::TeamId;
    use primitives::time::SimTime;
    use rules::field::{Field, Flag, FlagSettings, Plan};

    /// 160 m by 80 m, with flags at (20, 40) and (140, 40). The first team's side ends at 80 m.
    fn field() -> Field {
        Field::new(Plan {
            name: "test".to_owned(),
            datum: LatLon {
                lat_deg: 41.0,
                lon_deg: -74.0,
            },
            corner: primitives::frame::Ned::default(),
            along_deg: 90.0,
            width_m: 160.0,
            depth_m: 80.0,
            flag_inset_m: 20.0,
            ..Plan::default()
        })
    }

    /// Boats at (m along, m across), with whether each is tagged; the first two belong to the first
    /// team.
    fn seen(boats: [(f64, f64, bool); 4]) -> Vec<BoatProgress> {
        let field = field();
        let boats: Vec<Placed> = boats
            .iter()
            .enumerate()
            .map(|(i, (along_m, across_m, tagged))| {
                let team = TeamId(u8::from(i >= 2));
                Placed {
                    at: field.at(*along_m, *across_m),
                    team,
                    tagged: *tagged,
                    carrying: false,
                }
            })
            .collect();
        of_boats((&field, SimTime::ZERO), &boats, true)
    }

    fn close(got: f64, want: f64) {
        assert!((got - want).abs() < 1e-12, "got {got}, want {want}");
    }

    #[test]
    fn distances_are_told_in_widths_of_the_field() {
        let boats = seen([
            (60.0, 40.0, false),
            (20.0, 40.0, true),
            (140.0, 0.0, false),
            (100.0, 40.0, false),
        ]);
        close(boats[0].from_home, 0.25);
        close(boats[0].from_flag, 0.5);
        close(boats[2].from_home, 0.25);
        close(boats[3].from_flag, 0.5);
        assert!(boats[1].tagged && !boats[0].tagged);
    }

    #[test]
    fn the_nearest_untagged_enemy_on_a_teams_own_side_is_an_intruder() {
        // One of the two enemies on the first team's side is tagged. The other is 32 m and 40 m
        // away from the boats.
        let boats = seen([
            (70.0, 72.0, false),
            (30.0, 40.0, false),
            (70.0, 40.0, false),
            (70.0, 72.0, true),
        ]);
        close(boats[0].among.at_intruder, 0.8);
        close(boats[1].among.at_intruder, 0.75);
        close(boats[2].among.at_intruder, 0.0);
    }

    #[test]
    fn a_flag_is_guarded_from_an_eighth_of_the_field_before_it_towards_the_nearest_enemy() {
        // The enemy nearest to the flag at (20, 40) is straight ahead, so the place is (40, 40), or
        // the enemy's position.
        for (enemy_along_m, boat_along_m, want) in [
            (90.0, 40.0, 1.0),
            (90.0, 50.0, 0.75),
            (90.0, 85.0, 0.0),
            (30.0, 40.0, 0.75),
            (30.0, 30.0, 1.0),
        ] {
            let boats = seen([
                (boat_along_m, 40.0, false),
                (20.0, 70.0, false),
                (enemy_along_m, 40.0, false),
                (21.0, 40.0, true),
            ]);
            close(boats[0].among.on_guard, want);
        }
        let tagged = seen([
            (40.0, 40.0, false),
            (20.0, 70.0, false),
            (90.0, 40.0, true),
            (21.0, 40.0, true),
        ]);
        close(tagged[0].among.on_guard, 0.0);
    }

    #[test]
    fn a_mate_abroad_is_shielded_from_the_enemy_nearest_to_it() {
        let shield = |mate: (f64, f64, bool)| {
            seen([
                (110.0, 40.0, false),
                mate,
                (150.0, 40.0, false),
                (20.0, 40.0, false),
            ])
        };
        // 20 m from (100, 40) towards (150, 40) is (120, 40), 10 m from the boat at (110, 40).
        close(shield((100.0, 40.0, false))[0].among.at_shield, 0.75);
        // A boat does not shield itself. Its teammate can shield only the boat at (110, 40), from
        // (130, 40).
        close(shield((100.0, 40.0, false))[1].among.at_shield, 0.25);
        for at_home_or_tagged in [(70.0, 40.0, false), (100.0, 40.0, true)] {
            close(shield(at_home_or_tagged)[0].among.at_shield, 0.0);
        }
    }

    #[test]
    fn a_boat_is_clear_of_enemies_from_a_quarter_of_the_field_on() {
        for (enemy_along_m, tagged, want) in [
            (80.0, false, 0.5),
            (100.0, false, 1.0),
            (60.0, false, 0.0),
            (60.0, true, 1.0),
        ] {
            let boats = seen([
                (60.0, 40.0, false),
                (20.0, 70.0, false),
                (enemy_along_m, 40.0, tagged),
                (159.0, 1.0, false),
            ]);
            close(boats[0].among.clear, want);
        }
    }

    #[test]
    fn of_several_flags_the_nearest_counts_and_the_one_in_most_danger_is_guarded() {
        let mut plan = field().plan;
        for (team, along_m) in [(0, 20.0), (1, 140.0)] {
            plan.extra_flags.push(Flag {
                team: TeamId(team),
                start: field().at(along_m, 10.0),
                settings: FlagSettings::default(),
            });
        }
        let field = Field::new(plan);
        let boat = |along_m, across_m, team| Placed {
            at: field.at(along_m, across_m),
            team: TeamId(team),
            tagged: false,
            carrying: false,
        };
        // The enemy at (70, 10) is 50 m from the flag at (20, 10), which is guarded from (40, 10),
        // and 58 m from the flag at (20, 40).
        let boats = [
            boat(60.0, 10.0, 0),
            boat(40.0, 10.0, 0),
            boat(70.0, 10.0, 1),
        ];
        let out = of_boats((&field, SimTime::ZERO), &boats, true);
        close(out[0].from_home, 0.25);
        close(out[0].from_flag, 0.5);
        close(out[1].among.on_guard, 1.0);
    }

    #[test]
    fn what_is_not_asked_for_is_0() {
        let field = field();
        let boat = Placed {
            at: field.at(20.0, 40.0),
            team: TeamId(0),
            tagged: false,
            carrying: true,
        };
        let seen = of_boats((&field, SimTime::ZERO), &[boat], false)[0];
        assert!(
            seen.among == Among::default() && seen.carrying && seen.from_home < 1e-12,
            "{seen:?}"
        );
    }
}
