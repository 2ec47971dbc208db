//! Whole games of the shipped strategies.

use crate::files;
use agent::Mind;
use messages::{Order, Picture, Word};
use primitives::{SimTime, VehicleId};
use rules::count::Counts;
use scenario::{Outcome, Scenario};
use std::collections::BTreeMap;
use std::sync::{Arc, Mutex, OnceLock};

fn shipped(name: &str) -> Scenario {
    scenario::load(&files::shipped("games").join(name)).unwrap_or_else(|e| panic!("{e}"))
}

/// Games played once, by name and seed, and shared between tests.
type Played = BTreeMap<(&'static str, u64), Arc<OnceLock<Outcome>>>;

/// The outcome of a shipped game.
fn played(game: &'static str, seed: u64) -> Outcome {
    static PLAYED: Mutex<Played> = Mutex::new(BTreeMap::new());
    let outcome = Arc::clone(
        PLAYED
            .lock()
            .expect("no test panics while holding it")
            .entry((game, seed))
            .or_default(),
    );
    outcome.get_or_init(|| play(&shipped(game), seed)).clone()
}

fn play(scenario: &Scenario, seed: u64) -> Outcome {
    files::played(&Scenario {
        seed,
        ..scenario.clone()
    })
}

fn all(outcome: &Outcome, count: impl Fn(&Counts) -> u32) -> u32 {
    outcome.counts.boats.values().map(count).sum()
}

#[test]
fn the_first_game_of_the_paper_is_played_to_its_end() {
    for seed in 1..=5 {
        let outcome = played("pav01_vs_pav01.toml", seed);
        assert_eq!(
            (outcome.ticks, outcome.duration_s),
            (12_000, 600.0),
            "seed {seed}"
        );
        let ends: Vec<usize> = (0..outcome.events.len())
            .filter(|i| outcome.events[*i].event == "ended")
            .collect();
        assert_eq!(
            ends,
            [outcome.events.len() - 1],
            "seed {seed}: it ends once, and nothing follows"
        );

        let [grabs, captures, tags] = [
            all(&outcome, |counts| counts.grabs),
            all(&outcome, |counts| counts.captures),
            all(&outcome, |counts| counts.tags),
        ];
        // Attackers reach the flag, some bring it home, and defenders catch others.
        assert!(
            grabs > 0 && captures > 0 && tags > 0,
            "seed {seed}: {grabs} grabs, {captures} captures, {tags} tags"
        );
        assert!(captures <= grabs, "seed {seed}");
        let left = outcome
            .events
            .iter()
            .filter(|event| event.event == "left_field")
            .count();
        assert_eq!(left, 0, "seed {seed}: no boat leaves the field");
    }
}

#[test]
fn the_same_seed_is_the_same_game() {
    for game in ["pav01_vs_pav01.toml", "harbour_2v2.toml"] {
        let first = played(game, 5);
        let again = play(&shipped(game), 5);
        assert_eq!(first, again, "{game}");
    }
    // Forty boats that avoid each other take long to simulate, so limit the game to two minutes.
    let mut swarm = shipped("swarm_20v20.toml");
    swarm.rules.time_limit = SimTime::from_s(120.0);
    let [first, again, other] = [5, 5, 6].map(|seed| play(&swarm, seed));
    assert_eq!(first, again);
    assert_ne!(first.digest, other.digest);
    assert!(
        all(&first, |counts| counts.tags) > 5,
        "much happens in it: {:?}",
        first.counts
    );
}

#[test]
fn mirrored_teams_draw() {
    // Both teams play the same strategy from mirrored start positions, so they mirror each other.
    let outcome = played("pav01_vs_pav01.toml", 1);
    assert_eq!(outcome.winner, None);
    assert_eq!(outcome.score.teams["blue"], outcome.score.teams["red"]);
}

#[test]
fn harbour_games_have_winners() {
    // With identical boats and no noise, the teams mirrored each other and every game was a draw.
    let won = (1..=6)
        .filter(|seed| played("harbour_2v2.toml", *seed).winner.is_some())
        .count();
    assert!(won > 3, "{won} of 6 games have a winner");
}

#[test]
fn seeds_deal_the_roles_when_the_strategy_says_so() {
    let mut pav01 = shipped("pav01_vs_pav01.toml");
    for strategy in &mut pav01.strategies {
        strategy.assignment = scenario::strategy::Assignment::Seeded;
    }
    let deal = |seed: u64| {
        let scenario = Scenario {
            seed,
            ..pav01.clone()
        };
        (0..4)
            .map(|i| {
                agent::roles::role_of(&scenario, VehicleId::at(i))
                    .name
                    .clone()
            })
            .collect::<Vec<String>>()
    };
    let first = deal(1);
    assert!(
        (2..20).any(|seed| deal(seed) != first),
        "every seed deals {first:?}"
    );
    for seed in 1..20 {
        let attackers = deal(seed)
            .iter()
            .filter(|role| *role == "easy_attacker")
            .count();
        assert_eq!(attackers, 2, "seed {seed}: one per team");
    }
}

#[test]
fn the_shipped_games_are_what_they_say_and_no_boat_is_quarantined() {
    let sums = |game: &'static str, seeds: u64| {
        let games: Vec<Outcome> = (1..=seeds).map(|seed| played(game, seed)).collect();
        let mut events = games.iter().flat_map(|outcome| &outcome.events);
        assert!(events.all(|event| event.event != "quarantined"), "{game}");
        let sum = |count: fn(&Counts) -> u32| {
            games.iter().map(|outcome| all(outcome, count)).sum::<u32>()
        };
        (
            sum(|counts| counts.grabs),
            sum(|counts| counts.captures),
            sum(|counts| counts.tags),
        )
    };
    assert_eq!(
        sums("attack_1v1.toml", 1),
        (3, 3, 0),
        "nothing stops the attacker"
    );
    // The second game does not use its seed.
    for (game, seeds) in [
        ("pav01_3v3.toml", 5),
        ("pav01_4v4.toml", 1),
        ("harbour_2v2.toml", 1),
    ] {
        let (grabs, captures, tags) = sums(game, seeds);
        assert!(
            grabs > 0 && captures > 0 && tags > 0,
            "{game}: {grabs} grabs, {captures} captures, {tags} tags"
        );
    }
    let (.., tags) = sums("pav01_popolopen.toml", 1);
    assert!(tags > 0);
}

#[test]
fn a_game_with_real_boats_does_not_start_here() {
    let scenario = shipped("mixed_2v2.toml");
    let refused = arena::play(&scenario, agent::minds_of(&scenario), 1);
    assert!(
        matches!(refused, Err(sim::NoStart::RealBoats(_))),
        "{refused:?}"
    );
}

#[test]
fn an_agent_that_is_killed_begins_anew_when_it_is_back() {
    let counts = "unsafe_i_know = true\nunsafe_because = \"it lies still\"\n[variables]\ndecisions = 0\n[[rule]]\nwhen = \"true\"\n\
                  set = { decisions = \"decisions + 1\" }\n[behaviour.stop]\nkind = \"full_stop\"\n";
    let game = "base = \"SCENARIOS/games/pav01_vs_pav01.toml\"\n\
                team = [{ name = \"blue\", strategy = \"counts.toml\" }, { name = \"red\", strategy = \"counts.toml\" }]\n\
                [fault.killed]\nkind = \"agent_lost\"\nboats = [\"blue_two\"]\nat_s = 10\nfor_s = 5\n";
    let mut scenario = files::loaded(&[("counts.toml", counts), ("game.toml", game)]);
    scenario.rules.time_limit = SimTime::from_s(20.0);
    let mut decisions = vec![];
    arena::play_observed(&scenario, agent::minds_of(&scenario), 1, |_, runner| {
        let count = |(_, mind): (VehicleId, &dyn agent::Mind)| {
            mind.report()
                .map(|report| report.variables[0].value.parse::<f64>().expect("a number"))
        };
        decisions = runner.minds().map(count).collect();
        true
    })
    .unwrap_or_else(|e| panic!("{e}"));
    let [killed, spared] = [1, 0].map(|i| decisions[i].expect("it has a helm"));
    let a_second = 1.0 / scenario.decision().as_s();
    assert!((spared - 20.0 * a_second).abs() < 2.0, "{decisions:?}");
    assert!((killed - 5.0 * a_second).abs() < 2.0, "{decisions:?}");
}

#[test]
fn a_fleet_plays_the_same_game_on_any_number_of_threads_and_when_boats_work_alone() {
    let fleet = shipped("fleet_20v20.toml");
    let digest = |minds, threads: usize| {
        let runner = arena::runner_of(minds).on_threads(threads);
        let watch = |contest: &mut sim::Contest, _: &_| contest.decision() < 300;
        arena::play_on(&fleet, runner, fleet.seed, watch)
            .unwrap()
            .digest
    };
    let alone = |mind| Box::new(Alone(mind)) as Box<dyn Mind>;
    let alone = agent::minds_of(&fleet).into_iter().map(alone);
    let want = digest(alone.collect(), 1);
    for threads in [1, 2, 16] {
        assert_eq!(digest(agent::minds_of(&fleet), threads), want, "{threads}");
    }
}

/// A mind that derives its whole team's knowledge by itself.
struct Alone(Box<dyn Mind>);

impl Mind for Alone {
    fn decide(&mut self, picture: &Picture) -> Order {
        self.0.decide(picture)
    }

    fn send(&self, messages: &mut Vec<Word>) {
        self.0.send(messages);
    }

    fn receive(&mut self, messages: &[Word]) {
        self.0.receive(messages);
    }
}
