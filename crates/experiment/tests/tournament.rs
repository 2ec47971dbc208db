//! Tournaments: reproducible on any number of threads, fair to both sides, and with valid
//! confidence intervals.
#![expect(clippy::unwrap_used, reason = "a test that cannot continue has failed")]

use experiment::Game;
use experiment::tournament::{Cell, Match, Plan, Record, Report, Row, play};
use experiment::tournament::{Entrant, EntryKind, Tournament};
use rules::count::Counts;
use scenario::{Overrides, load_file, load_with};
use std::num::NonZeroUsize;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};

/// The quantile of Student's t for five observations, from a table.
const T_975_OF_4: f64 = 2.776_445_105;

fn shipped(path: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("../../scenarios")
        .join(path)
}

fn tournament(game: &str, games: u32, strategies: &[&str]) -> Tournament {
    let entrant = |(i, strategy): (usize, &&str)| Entrant {
        name: format!("{strategy}_{i}"),
        strategy: shipped(&format!("strategies/{strategy}.toml")),
        kind: None,
    };
    Tournament {
        name: "small".to_owned(),
        game: shipped(&format!("games/{game}.toml")),
        sea: None,
        seas: vec![],
        entries: strategies.iter().enumerate().map(entrant).collect(),
        games,
        seed: 7,
        self_play: false,
        challenger: None,
    }
}

fn records(plan: &Plan, jobs: usize) -> Vec<Record> {
    played(plan, jobs, &AtomicBool::new(false), |_| {})
}

fn played(
    plan: &Plan,
    jobs: usize,
    stop: &AtomicBool,
    mut watch: impl FnMut(&Record),
) -> Vec<Record> {
    let (games, mut records): (Vec<usize>, _) = ((0..plan.games()).collect(), vec![]);
    play(
        plan,
        &games,
        NonZeroUsize::new(jobs).unwrap(),
        stop,
        |record| {
            watch(&record);
            records.push(record);
        },
    );
    records
}

#[test]
fn the_report_is_the_same_bytes_on_one_thread_and_on_many() {
    let tournament = Tournament {
        sea: Some(shipped("seas/moderate_breeze.toml")),
        self_play: true,
        ..tournament(
            "pav01_vs_pav01",
            6,
            &["pav01", "easy_attackers", "pav01_seeded"],
        )
    };
    let plan = Plan::new(&tournament).unwrap();
    assert_eq!(
        (plan.seeds(), plan.games_per_seed(), plan.games()),
        (3, 3 * 2 + 3, 27)
    );
    let report = |jobs| serde_json::to_string(&Report::new(&plan, &records(&plan, jobs))).unwrap();
    let one = report(1);
    let four = report(4);
    let many = report(64);
    assert!(one == four && one == many, "{one}\n{four}\n{many}");
    assert!(
        one.contains("\"games_unplayed\":0,\"games_left_out\":0"),
        "{one}"
    );
}

#[test]
fn every_seed_is_played_from_both_sides_and_is_the_game_of_these_strategies() {
    let tournament = tournament("attack_1v1", 5, &["pav01", "easy_attackers", "idle"]);
    let plan = Plan::new(&tournament).unwrap();
    let matches: Vec<Match> = (0..plan.games()).map(|i| plan.match_at(i).0).collect();
    assert_eq!(
        (plan.seeds(), matches.len()),
        (3, 18),
        "an odd number of games is rounded up"
    );
    for seed in 7..10 {
        for sides in [[0, 1], [1, 0], [0, 2], [2, 0], [1, 2], [2, 1]] {
            let count = matches
                .iter()
                .filter(|game| {
                    **game
                        == Match {
                            seed,
                            sides,
                            sea: 0,
                        }
                })
                .count();
            assert_eq!(count, 1, "seed {seed}, {sides:?}");
        }
    }
    let records = records(&plan, 2);
    assert_eq!(
        records.iter().map(|record| record.of).collect::<Vec<_>>(),
        matches
    );
    for Record { of, result } in &records {
        let strategy = |side: usize| tournament.entries[of.sides[side]].strategy.clone();
        let strategies = [
            ("blue".to_owned(), strategy(0)),
            ("red".to_owned(), strategy(1)),
        ]
        .into();
        let scenario = load_with(
            &tournament.game,
            &Overrides {
                strategies,
                ..Overrides::default()
            },
        )
        .unwrap();
        let scenario = scenario.of_seed(of.seed).unwrap();
        let outcome = arena::play(&scenario, agent::minds_of(&scenario), of.seed).unwrap();
        let game = result.as_ref().unwrap();
        assert_eq!(game.digest, outcome.digest, "{of:?}");
        assert_eq!(
            game.score,
            [outcome.score.teams["blue"], outcome.score.teams["red"]],
            "{of:?}"
        );
    }
    // The attacker never loses to the idle entry, which blocks it when it is the second team.
    let report = Report::new(&plan, &records);
    let names: Vec<&str> = report.entries.iter().map(|row| row.name.as_str()).collect();
    assert_eq!(
        (names[0], report.entries[0].losses),
        ("easy_attackers_1", 0),
        "{names:?}"
    );
    let there = cell(&report, "easy_attackers_1", "idle_2");
    let back = cell(&report, "idle_2", "easy_attackers_1");
    assert_eq!(
        (there.games, there.wins, there.draws, there.losses),
        (6, 3, 3, 0)
    );
    assert_eq!((back.wins, back.draws, back.losses), (0, 3, 3));
    assert_eq!(back.score_difference, -there.score_difference);
    assert!(there.score_difference > 0.0);
}

/// The results of one entry against a particular opponent.
fn cell<'a>(report: &'a Report, row: &str, column: &str) -> &'a Cell {
    let cell = report
        .matrix
        .iter()
        .find(|cell| cell.row == row && cell.column == column);
    cell.unwrap_or_else(|| panic!("{report:?}"))
}

/// A record of a game with these scores; the first team also grabbed once.
fn record(seed: u64, sides: [usize; 2], score: [u32; 2]) -> Record {
    let winner = if score[0] == score[1] {
        None
    } else {
        Some(usize::from(score[1] > score[0]))
    };
    let counts = [
        Counts {
            grabs: 1,
            ..Counts::default()
        },
        Counts::default(),
    ];
    Record {
        of: Match {
            seed,
            sides,
            sea: 0,
        },
        result: Ok(Game {
            score,
            counts,
            winner,
            duration_s: 60.0,
            digest: format!("{seed}"),
        }),
    }
}

#[test]
fn the_two_games_of_a_seed_are_one_observation() {
    const ROUNDING: f64 = 1e-6;
    let plan = Plan::new(&tournament("attack_1v1", 10, &["pav01", "idle"])).unwrap();
    // The first entry scores 2 and 4, then 5 and 5, then 6 and 8, and so on: 3, 5, 7, 5 and 5 per
    // seed, with mean 5 and variance 2.
    let records = [
        record(7, [0, 1], [2, 3]),
        record(7, [1, 0], [1, 4]),
        record(8, [0, 1], [5, 5]),
        record(8, [1, 0], [1, 5]),
        record(9, [0, 1], [6, 0]),
        record(9, [1, 0], [2, 8]),
        record(10, [0, 1], [5, 5]),
        record(10, [1, 0], [1, 5]),
        record(11, [0, 1], [5, 5]),
        record(11, [1, 0], [1, 5]),
    ];
    let report = Report::new(&plan, &records);
    let [first, second] = &report.entries[..] else {
        panic!("{report:?}")
    };
    assert_eq!(
        (first.name.as_str(), first.games, first.score.mean),
        ("pav01_0", 10, 5.0)
    );
    let half = T_975_OF_4 * (2.0 / 5_f64).sqrt();
    let low = first.score.low.unwrap();
    let high = first.score.high.unwrap();
    assert!(
        (low - (5.0 - half)).abs() < ROUNDING && (high - (5.0 + half)).abs() < ROUNDING,
        "{low} to {high}"
    );
    assert_eq!([first.wins, first.draws, first.losses], [6, 3, 1]);
    assert_eq!([second.wins, second.draws, second.losses], [1, 3, 6]);
    // The first team always grabbed once: half a grab per game, with no uncertainty.
    assert_eq!(
        (first.grabs.mean, first.grabs.low, first.grabs.high),
        (0.5, Some(0.5), Some(0.5))
    );
    let [there, back] = &report.matrix[..] else {
        panic!("{report:?}")
    };
    assert_eq!(
        (there.row.as_str(), there.column.as_str(), there.wins),
        ("pav01_0", "idle_1", 6)
    );
    assert!(
        (there.score_difference - 2.6).abs() < ROUNDING
            && back.score_difference == -there.score_difference
    );
    assert_eq!((there.seeds.first, there.seeds.last), (7, 11));
}

#[test]
fn all_opponents_of_a_seed_are_one_observation() {
    const ROUNDING: f64 = 1e-6;
    let plan = Plan::new(&tournament(
        "attack_1v1",
        10,
        &["pav01", "idle", "easy_attackers"],
    ))
    .unwrap();
    // The first entry always scores 10 points more against one opponent than against the other.
    // That adds no uncertainty to its mean, which is 6 to 10 in the five seeds.
    let seed = |seed: u64, score: u32| {
        let game = |sides: [usize; 2], score: [u32; 2]| record(seed, sides, score);
        [
            game([0, 1], [score, 0]),
            game([1, 0], [0, score]),
            game([0, 2], [score + 10, 0]),
            game([2, 0], [0, score + 10]),
            game([1, 2], [0, 0]),
            game([2, 1], [0, 0]),
        ]
    };
    let records: Vec<Record> = (1..=5)
        .flat_map(|score| seed(6 + score, score as u32))
        .collect();
    let report = Report::new(&plan, &records);
    let first = &report.entries[0];
    let half = first.score.half_width().unwrap();
    assert_eq!(
        (first.name.as_str(), first.games, first.score.mean),
        ("pav01_0", 20, 8.0)
    );
    // The history ends at the ratings of the report, and begins without the third entry.
    let ends = report
        .history
        .last()
        .map(|last| (last.games, last.elo.clone()));
    assert_eq!(
        ends,
        Some((
            30,
            report
                .entries
                .iter()
                .map(|row| Some(row.rating.elo))
                .collect()
        ))
    );
    assert_eq!(
        (
            report.history[0].games,
            report.history[0].elo.iter().flatten().count()
        ),
        (1, 2)
    );
    assert!(
        (half - T_975_OF_4 * 0.5_f64.sqrt()).abs() < ROUNDING,
        "{half}"
    );
}

#[test]
fn a_challenger_plays_everybody_and_nobody_else_plays() {
    let all = tournament("attack_1v1", 10, &["idle", "easy_attackers", "pav01"]);
    let plan = Plan::new(&Tournament {
        challenger: Some("easy_attackers_1".to_owned()),
        ..all
    })
    .unwrap();
    assert_eq!((plan.games_per_seed(), plan.games()), (4, 20));
    // Two wins and eight draws against the idle team; two wins and eight losses against pav01.
    let score = |seed: u64, sides: [usize; 2]| match (seed, sides) {
        (7, [1, _]) => [2, 1],
        (7, [_, 1]) => [0, 3],
        (_, [2, _]) => [4, 1],
        (_, [_, 2]) => [1, 4],
        _ => [1, 1],
    };
    let matches = (0..plan.games()).map(|i| plan.match_at(i).0);
    let records: Vec<Record> = matches
        .map(|of| record(of.seed, of.sides, score(of.seed, of.sides)))
        .collect();
    let report = Report::new(&plan, &records);
    assert_eq!(report.challenger.as_deref(), Some("easy_attackers_1"));
    let idle = cell(&report, "easy_attackers_1", "idle_0");
    assert_eq!(
        (idle.games, idle.wins, idle.draws, idle.losses),
        (10, 2, 8, 0)
    );
    assert_eq!(idle.won_of_decided.map(|share| share.mean), Some(1.0));
    let pav01 = cell(&report, "easy_attackers_1", "pav01_2");
    assert_eq!((pav01.wins, pav01.draws, pav01.losses), (2, 0, 8));
    let share = pav01.won_of_decided.expect("decided games");
    assert!(
        (share.mean - 0.2).abs() < 1e-12 && share.low.is_some_and(|low| low < 0.0),
        "{share:?}"
    );
    assert!((pav01.score_difference - (pav01.score[0] - pav01.score[1])).abs() < 1e-12);
    assert!(
        report
            .matrix
            .iter()
            .all(|cell| [&cell.row, &cell.column].contains(&&"easy_attackers_1".to_owned()))
    );
}

#[test]
fn equal_entries_are_equal_to_the_last_digit() {
    let tournament = Tournament {
        sea: Some(shipped("seas/fresh_breeze.toml")),
        self_play: true,
        ..tournament("pav01_vs_pav01", 8, &["pav01", "pav01"])
    };
    let plan = Plan::new(&tournament).unwrap();
    let records = records(&plan, 2);
    // Wind and waves favour a side, so there is an advantage to cancel out.
    let is_drawn = |record: &Record| {
        record
            .result
            .as_ref()
            .unwrap()
            .score
            .windows(2)
            .all(|pair| pair[0] == pair[1])
    };
    assert!(!records.iter().all(is_drawn));
    let report = Report::new(&plan, &records);
    let [one, other] = &report.entries[..] else {
        panic!("{report:?}")
    };
    assert_eq!(
        (one.score, one.tags, one.wins, one.losses),
        (other.score, other.tags, other.wins, other.losses)
    );
    assert_eq!(
        one.games, 16,
        "four seeds, each twice against the other and against itself from both sides"
    );
    assert_eq!(report.matrix.len(), 4);
    for cell in &report.matrix {
        assert_eq!(
            (cell.wins, cell.score_difference, cell.games),
            (cell.losses, 0.0, 8),
            "{cell:?}"
        );
    }
}

#[test]
fn a_tournament_that_is_stopped_keeps_whole_seeds() {
    let plan = Plan::new(&tournament("attack_1v1", 40, &["idle", "easy_attackers"])).unwrap();
    let stop = AtomicBool::new(false);
    let mut shown = 0;
    let records = played(&plan, 1, &stop, |_| {
        shown += 1;
        stop.store(shown >= 3, Ordering::Relaxed);
    });
    assert_eq!(records.len(), shown);
    assert!((3..40).contains(&shown), "{shown} games");
    // Whichever games were running, three games are one and a half seeds.
    let report = Report::new(&plan, &records[..3]);
    assert_eq!(
        (
            report.seeds_counted,
            report.games_left_out,
            report.games_unplayed
        ),
        (1, 1, 37)
    );
    assert_eq!(
        (report.entries[0].games, report.entries[0].score.low),
        (2, None)
    );
    let nothing = Report::new(&plan, &records[..1]);
    assert!(nothing.entries.is_empty() && nothing.matrix.is_empty() && nothing.matches.len() == 1);
}

#[test]
fn a_game_that_cannot_start_is_reported_and_its_seed_does_not_count() {
    let plan = Plan::new(&tournament("attack_1v1", 4, &["idle", "easy_attackers"])).unwrap();
    let mut records = records(&plan, 2);
    records[2].result = Err("no room".to_owned());
    let report = Report::new(&plan, &records);
    let [failure] = &report.failures[..] else {
        panic!("{:?}", report.failures)
    };
    assert_eq!(
        (failure.seed, failure.blue.as_str(), failure.why.as_str()),
        (8, "idle_0", "no room")
    );
    assert_eq!(
        (
            report.seeds_counted,
            report.games_left_out,
            report.games_unplayed
        ),
        (1, 1, 0)
    );
    assert_eq!(report.matrix[0].seeds.last, 7);
}

#[test]
fn boats_that_do_not_fit_into_their_spawn_area_fail_the_game_and_not_the_tournament() {
    let dir = tempfile::tempdir().unwrap();
    let game = dir.path().join("crowd.toml");
    let base = shipped("games/pav01_vs_pav01.toml").canonicalize().unwrap();
    // Two boats are in the rectangle where a third would have to keep clear of them.
    let boats = "[[vehicle]]\nname = \"a\"\nteam = \"blue\"\nat = [20.5, 50]\n\
                 [[vehicle]]\nname = \"b\"\nteam = \"blue\"\nat = [22.4, 50]\n\
                 [[fleet]]\nteam = \"red\"\ncount = 1\n\
                 spawn = { along_m = [137.1, 140.0], across_m = [48.5, 51.5], gap_m = 2 }\n";
    std::fs::write(&game, format!("base = {base:?}\nduration_s = 5\n{boats}")).unwrap();
    let tournament = Tournament {
        game,
        ..tournament("attack_1v1", 4, &["idle", "easy_attackers"])
    };
    let plan = Plan::new(&tournament).unwrap_or_else(|problems| panic!("{problems}"));
    let report = Report::new(&plan, &records(&plan, 2));
    assert_eq!(
        (
            report.failures.len(),
            report.seeds_counted,
            report.games_unplayed
        ),
        (4, 0, 0)
    );
    assert!(
        report.failures[0]
            .why
            .contains("no free start position for red_1"),
        "{}",
        report.failures[0].why
    );
}

#[test]
fn the_shipped_tournaments_can_be_played() {
    let mut files: Vec<PathBuf> = std::fs::read_dir(shipped("tournaments"))
        .unwrap()
        .map(|entry| entry.unwrap().path())
        .collect();
    files.sort();
    for file in files.into_iter().filter(|file| {
        file.extension()
            .is_some_and(|extension| extension == "toml")
    }) {
        let tournament =
            load_file::<Tournament>(&file).unwrap_or_else(|problems| panic!("{problems}"));
        let all = Tournament {
            games: 2,
            ..tournament
        };
        let plan = Plan::new(&all).unwrap_or_else(|problems| panic!("{problems}"));
        // A league would take minutes: two entries meet each other in every sea.
        let plan = match plan.games() > 100 {
            true => Plan::new(&Tournament {
                entries: all.entries[..2].to_vec(),
                ..all
            }),
            false => Ok(plan),
        };
        let plan = plan.unwrap_or_else(|problems| panic!("{problems}"));
        let report = Report::new(&plan, &records(&plan, 2));
        assert_eq!(
            (report.seeds_counted, report.failures.len()),
            (1, 0),
            "{}",
            file.display()
        );
    }
}

#[test]
fn each_sea_has_results_of_its_own_and_together_they_are_the_report() {
    const CLOSE: f64 = 1e-6;
    let entries = tournament("pav01_vs_pav01", 10, &["idle", "pav01", "learned"]);
    let plan = Plan::new(&Tournament {
        seas: ["calm", "gale"]
            .map(|sea| shipped(&format!("seas/{sea}.toml")))
            .to_vec(),
        ..entries
    })
    .unwrap();
    assert_eq!((plan.games_per_seed(), plan.games()), (12, 60));
    let matches: Vec<Match> = (0..plan.games()).map(|i| plan.match_at(i).0).collect();
    let places: Vec<usize> = matches.iter().map(|of| plan.place_of(*of)).collect();
    assert_eq!(places, (0..60).collect::<Vec<_>>());
    let pairings = plan.pairings();
    assert_ne!(pairings[0], pairings[6], "different seas, different games");
    // In calm water each entry beats the next; in a gale, the earlier entry wins.
    let record = |of: &Match| {
        let [one, other] = of.sides;
        let is_won = match of.sea {
            0 => (one + 1) % 3 == other,
            _ => one < other,
        };
        let score = if is_won { [2, 1] } else { [1, 2] };
        Record {
            of: *of,
            ..record(of.seed, of.sides, score)
        }
    };
    let report = Report::new(&plan, &matches.iter().map(record).collect::<Vec<_>>());
    let [calm, gale] = &report.seas[..] else {
        panic!("{:?}", report.seas)
    };
    assert!(calm.sea.ends_with("calm.toml") && gale.sea.ends_with("gale.toml"));
    assert_eq!((report.games_per_pairing, &report.sea), (20, &None));
    let [mut cycle] = <[_; 1]>::try_from(calm.cycles.clone()).unwrap();
    let first = cycle.iter().position(|name| name == "idle_0").unwrap();
    cycle.rotate_left(first);
    assert_eq!(cycle, ["idle_0", "pav01_1", "learned_2"]);
    assert!(gale.cycles.is_empty() && report.cycles.is_empty());
    let share = |rows: &[Row], name: &str| {
        let row = rows.iter().find(|row| row.name == name).unwrap();
        row.nash.unwrap().share.mean
    };
    for (name, in_gale) in [("idle_0", 1.0), ("pav01_1", 0.0), ("learned_2", 0.0)] {
        let found = [&calm.entries, &gale.entries].map(|rows| share(rows, name));
        let error = (found[0] - 1.0 / 3.0).abs().max((found[1] - in_gale).abs());
        assert!(error < CLOSE, "{name}: {found:?}");
    }
    let names: Vec<&str> = gale.entries.iter().map(|row| row.name.as_str()).collect();
    assert_eq!(names, ["idle_0", "pav01_1", "learned_2"]);
    let all = cell(&report, "idle_0", "learned_2");
    assert_eq!((all.games, all.wins, all.losses), (20, 10, 10));
    assert_eq!(gale.matrix[0].games, 10);
    assert!(report.matches[..6].iter().all(|game| game.sea == 0));
    assert!(report.matches[6..12].iter().all(|game| game.sea == 1));
    let kinds: Vec<EntryKind> = plan.kinds().to_vec();
    let rules = EntryKind::RuleBased;
    assert_eq!(kinds, [rules, rules, EntryKind::Learned]);
}
