//! Long random walks: invariants that hold at every check, whatever the boats do.

use crate::mirror::Mirror;
use crate::preset;
use crate::scene::{TICK, field, flag, teams_of};
use primitives::near::{Near, Pair};
use primitives::reseed::Seeds;
use primitives::stream::Stream;
use primitives::{FlagId, Leg, Ned, SimTime, TeamId, VehicleId};
use proptest::prelude::*;
use rules::event::{Event, TagCause};
use rules::{Look, Notes, Referee, Resolution, Rules, SideJudged, Standing};

/// Positions are multiples of this, so that the mirror image of a game is exact.
const GRAIN_M: f64 = 1.0 / 64.0;
const LOOKS: usize = 400;

/// The parameters of a walk: rules, boats per team, and seed.
#[derive(Clone, Debug)]
struct Walk {
    rules: Rules,
    boats: usize,
    extra_flags: bool,
    seed: u64,
}

fn walks(boats: impl Strategy<Value = usize>) -> impl Strategy<Value = Walk> {
    let variants = (
        0..4_usize,
        any::<bool>(),
        0..3_u32,
        prop_oneof![Just(None), (1..30_u32).prop_map(Some)],
    );
    (variants, boats, any::<bool>(), any::<u64>()).prop_map(
        |((book, capture_needs_own_flag, tag_points, win_score), boats, extra_flags, seed)| {
            let mut rules = hurried(preset::all()[book].clone());
            rules.points.tag = tag_points;
            rules.tag_cooldown = SimTime(rules.tag_cooldown.0 / 20);
            Walk {
                rules: Rules {
                    capture_needs_own_flag,
                    win_score,
                    ..rules
                },
                boats,
                extra_flags,
                seed,
            }
        },
    )
}

/// The rules of a short game.
fn hurried(rules: Rules) -> Rules {
    let power_play = SimTime(rules.power_play.0.min(8_000_000_000));
    Rules {
        time_limit: SimTime::from_s(35.0),
        power_play,
        collision_distance_m: 4.0,
        ..rules
    }
}

impl Walk {
    fn referee(&self) -> Referee {
        let extra = if self.extra_flags {
            vec![flag(0, 62.0, 70.0), flag(1, 98.0, 10.0)]
        } else {
            vec![]
        };
        Referee {
            rules: self.rules.clone(),
            field: field(extra),
            team_of: teams_of(self.boats, 2),
            joins: vec![SimTime::ZERO; 2 * self.boats],
            tag_noise: Seeds::from(self.seed).noise("tags"),
        }
    }

    /// The motion of every boat, check by check, from one interesting place to the next.
    fn fleets(&self) -> Vec<Vec<Leg>> {
        let mut stream = Stream::new(self.seed, "walk");
        let start_position = |_| Ned::from_xy(80.0, 40.0);
        let mut fleet: Vec<Ned> = (0..2 * self.boats).map(start_position).collect();
        let mut targets: Vec<Ned> = fleet.iter().map(|_| place(&mut stream)).collect();
        let mut look = |_| {
            let before = fleet.clone();
            for (at, target) in fleet.iter_mut().zip(&mut targets) {
                let way = *target - *at;
                at.north += stepwise(way.north, &mut stream);
                at.east += stepwise(way.east, &mut stream);
                if way.length() < 4.0 {
                    *target = place(&mut stream);
                }
            }
            before
                .into_iter()
                .zip(&fleet)
                .map(|(from, to)| Leg { from, to: *to })
                .collect()
        };
        (0..LOOKS).map(&mut look).collect()
    }
}

/// A random flag, home, corner, point on the scrimmage line or the boundary, or any other point.
fn place(stream: &mut Stream) -> Ned {
    let grain = |metres: f64| (metres / GRAIN_M).round() * GRAIN_M;
    let (x, y) = match stream.below(8) {
        0 | 1 => (20.0, 40.0),
        2 | 3 => (140.0, 40.0),
        4 => (
            4.0 + 152.0 * stream.below(2) as f64,
            6.0 + 68.0 * stream.below(2) as f64,
        ),
        5 => (80.0, grain(stream.between(0.0, 80.0))),
        6 => (
            grain(stream.between(0.0, 160.0)),
            -3.0 + 86.0 * stream.below(2) as f64,
        ),
        _ => (
            grain(stream.between(-2.0, 162.0)),
            grain(stream.between(-2.0, 82.0)),
        ),
    };
    Ned::from_xy(x, y)
}

/// A step of up to 3 m that mostly reduces `way` towards 0.
fn stepwise(way: f64, stream: &mut Stream) -> f64 {
    let step = GRAIN_M * stream.below(193) as f64;
    if stream.below(8) == 0 {
        step * way.signum() * -0.5
    } else {
        step.min(way.abs()).copysign(way)
    }
    .div_euclid(GRAIN_M)
        * GRAIN_M
}

/// All pairs within 1.5 times the required distance.
fn generous(fleet: &[Leg], reach_m: f64) -> Vec<Pair> {
    let reach_m = 1.5 * reach_m;
    let pairs = (0..fleet.len()).flat_map(|a| (a + 1..fleet.len()).map(move |b| (a, b)));
    let pairs = pairs.map(|(a, b)| {
        (
            a as u16,
            b as u16,
            fleet[a].to.distance_squared(fleet[b].to),
        )
    });
    let near = pairs.filter(|(_, _, distance_squared)| *distance_squared < reach_m * reach_m);
    near.map(|(a, b, distance_squared)| Pair {
        a,
        b,
        distance_squared,
    })
    .collect()
}

/// The referee's view of boats that need no requests.
fn look<'a>(legs: &'a [Leg], near: &'a [Pair], now: SimTime) -> Look<'a> {
    Look {
        legs,
        asks: &[],
        near,
        now,
    }
}

/// Plays a walk; calls `each` with (before, after, fleet, events) at every check.
fn play(walk: &Walk, mut each: impl FnMut(&Referee, &Standing, &Standing, &[Leg], &[Event])) {
    let referee = walk.referee();
    let mut standing = referee.start(&mut Stream::new(walk.seed, "rules"));
    let mut notes = Notes::default();
    let mut near = Near::default();
    let mut now = SimTime::ZERO;
    for fleet in walk.fleets() {
        let before = standing.clone();
        let mut events = vec![];
        let pairs = near.pairs(|i| fleet[i].to, fleet.len(), referee.rules.reach_m());
        referee.advance(
            &mut standing,
            &mut notes,
            &look(&fleet, pairs, now),
            &mut events,
        );
        each(&referee, &before, &standing, &fleet, &events);
        now = now + TICK;
    }
}

fn assert_consistent(referee: &Referee, before: &Standing, after: &Standing) {
    for (i, boat) in after.vehicles.iter().enumerate() {
        if let Some(flag) = boat.carrying {
            assert_eq!(after.flags[flag.index()].carrier, Some(VehicleId::at(i)));
            assert_ne!(referee.field.flags[flag.index()].team, referee.team_of[i]);
            assert!(
                !boat.tagged && !boat.outside,
                "vehicle {i} carries a flag: {boat:?}"
            );
        }
        assert!(
            !boat.outside || boat.tagged,
            "vehicle {i} is outside and not tagged"
        );
    }
    for (i, flag) in after.flags.iter().enumerate() {
        if let Some(carrier) = flag.carrier {
            assert_eq!(
                after.vehicles[carrier.index()].carrying,
                Some(FlagId(i as u8))
            );
        }
    }
    for team in 0..2 {
        assert!(
            after.score[team] >= before.score[team],
            "team {team} lost points"
        );
        assert!(!after.touching.iter().any(|(a, b)| a >= b));
    }
    assert!(after.touching.is_sorted());
    assert!(
        after.vehicles.iter().filter(|boat| boat.disabled).count() <= 1,
        "two power plays at once"
    );
}

fn assert_lawful(
    referee: &Referee,
    before: &Standing,
    after: &Standing,
    fleet: &[Leg],
    event: Event,
) {
    let rules = &referee.rules;
    let field = &referee.field;
    let team = |vehicle: VehicleId| referee.team_of[vehicle.index()];
    let at = |vehicle: VehicleId| fleet[vehicle.index()].to;
    let on_own_side = |vehicle: VehicleId| {
        let Leg { from, to } = fleet[vehicle.index()];
        field.zones[team(vehicle).index()].contains(if rules.side_judged == SideJudged::AfterMove {
            to
        } else {
            from
        })
    };
    let in_turn = rules.resolution == Resolution::InTurn;
    let carrier = |flag: FlagId| before.flags[flag.index()].carrier;
    match event {
        Event::Tagged {
            vehicle,
            cause: TagCause::Opponent(by),
        } => {
            assert_ne!(team(vehicle), team(by));
            assert!(on_own_side(by) && !on_own_side(vehicle));
            assert!(field.contains(at(by)) && field.contains(at(vehicle)));
            assert!(at(by).distance(at(vehicle)) < rules.tag_radius_m);
            assert!(
                before.vehicles[by.index()].tag_ready <= after.now
                    && !before.vehicles[by.index()].tagged
            );
            assert!(
                !after.vehicles[by.index()].disabled
                    && after.vehicles[by.index()].tag_ready > after.now
            );
            assert!(
                !before.vehicles[vehicle.index()].tagged && after.vehicles[vehicle.index()].tagged
            );
        }
        Event::Tagged {
            vehicle,
            cause: TagCause::Boundary,
        } => assert!(!field.contains(at(vehicle))),
        Event::Tagged {
            cause: TagCause::Obstacle,
            ..
        } => unreachable!("the field has no obstacles"),
        Event::Grabbed { vehicle, flag } => {
            let boat = &after.vehicles[vehicle.index()];
            // Under sequential rules, a boat may be tagged after its grab, and a flag may be
            // grabbed just after a boat that left the field has lost it.
            assert!(
                !before.vehicles[vehicle.index()].tagged
                    && !boat.disabled
                    && (!boat.tagged || in_turn)
            );
            assert!(field.contains(at(vehicle)));
            assert!(at(vehicle).distance(field.flags[flag.index()].start) < rules.grab_radius_m);
            assert!(carrier(flag).is_none() || in_turn);
        }
        Event::Captured { vehicle, flag } => {
            assert_eq!(carrier(flag), Some(vehicle));
            assert!(
                field.contains(at(vehicle))
                    && on_own_side(vehicle)
                    && !after.vehicles[vehicle.index()].disabled
            );
        }
        Event::FlagReturned { vehicle, flag } => {
            assert!(carrier(flag) == Some(vehicle) || in_turn);
            assert!(after.vehicles[vehicle.index()].tagged);
        }
        Event::Untagged(vehicle) => {
            assert!(before.vehicles[vehicle.index()].tagged && field.contains(at(vehicle)))
        }
        _ => {}
    }
}

fn points(referee: &Referee, events: &[Event], team: TeamId) -> u32 {
    let points = referee.rules.points;
    let worth = |event: &Event| match event {
        Event::Grabbed { vehicle, .. } => Some((*vehicle, points.grab)),
        Event::Captured { vehicle, .. } => Some((*vehicle, points.capture)),
        Event::Tagged {
            cause: TagCause::Opponent(by),
            ..
        } => Some((*by, points.tag)),
        _ => None,
    };
    let scored = events.iter().filter_map(worth);
    scored
        .filter(|(vehicle, _)| referee.team_of[vehicle.index()] == team)
        .map(|(_, points)| points)
        .sum()
}

/// Events of one check, independent of the order of teams.
fn sorted(events: impl Iterator<Item = Event>) -> Vec<String> {
    let mut events: Vec<String> = events.map(|event| format!("{event:?}")).collect();
    events.sort_unstable();
    events
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 48, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn every_look_leaves_a_lawful_standing(walk in walks(prop_oneof![4 => 1..5_usize, 1 => 17..22_usize])) {
        play(&walk, |referee, before, after, fleet, events| {
            assert_consistent(referee, before, after);
            for event in events {
                assert_lawful(referee, before, after, fleet, *event);
            }
            for team in [TeamId(0), TeamId(1)] {
                let want = before.score[team.index()] + points(referee, events, team);
                assert_eq!(after.score[team.index()], want, "team {}", team.0);
            }
            assert!(!before.over || (before == after && events.is_empty()), "it continued after the end");
        });
    }

    #[test]
    fn mirrored_teams_get_mirrored_results(walk in walks(prop_oneof![4 => 1..5_usize, 1 => 17..22_usize])) {
        let mirror = Mirror { boats: walk.boats };
        let mut notes = Notes::default();
        let mut near = Near::default();
        let mut reflected: Option<Standing> = None;
        play(&walk, |referee, before, after, fleet, events| {
            let other = reflected.get_or_insert_with(|| mirror.standing(before));
            let fleet = mirror.fleet(fleet);
            let pairs = near.pairs(|i| fleet[i].to, fleet.len(), referee.rules.reach_m());
            let mut got = vec![];
            referee.advance(other, &mut notes, &look(&fleet, pairs, after.now), &mut got);
            let want = sorted(events.iter().map(|event| mirror.event(*event)));
            assert_eq!(sorted(got.into_iter()), want, "at {}", after.now);
            assert_eq!(other, &mirror.standing(after), "at {}", after.now);
        });
    }

    #[test]
    fn too_many_pairs_and_a_blank_notepad_change_nothing(walk in walks(prop_oneof![1..5_usize, 17..30_usize])) {
        let mut other: Option<Standing> = None;
        play(&walk, |referee, before, after, fleet, events| {
            let other = other.get_or_insert_with(|| before.clone());
            let pairs = generous(fleet, referee.rules.reach_m());
            let mut got = vec![];
            referee.advance(other, &mut Notes::default(), &look(fleet, &pairs, after.now), &mut got);
            assert_eq!(got, events);
            assert_eq!(other, after);
        });
    }
}

#[test]
fn the_walks_lead_to_everything_that_can_happen() {
    let mut counts = std::collections::BTreeMap::<String, u32>::new();
    for (book, rules) in preset::all().into_iter().enumerate() {
        let rules = hurried(rules);
        for seed in 0..16 {
            let walk = Walk {
                rules: rules.clone(),
                boats: 4,
                extra_flags: seed % 2 == 0,
                seed,
            };
            play(&walk, |_, _, _, _, events| {
                for event in events {
                    let name = format!("{event:?}")
                        .split([' ', '('])
                        .next()
                        .map(str::to_owned);
                    *counts
                        .entry(format!("{book} {}", name.unwrap_or_default()))
                        .or_default() += 1;
                }
            });
        }
        let everywhere = "Grabbed Captured Tagged Untagged FlagReturned LeftField ReturnedToField Collided Ended";
        let here = ["", "EnteredKeepout", "EnteredKeepout", "Disabled Enabled"][book];
        for name in everywhere.split(' ').chain(here.split_whitespace()) {
            let count = counts.get(&format!("{book} {name}")).copied().unwrap_or(0);
            assert!(count >= 3, "{}: {name} happened {count} times", rules.name);
        }
    }
}
