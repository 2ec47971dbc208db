//! Boats under direct control move as in Pyquaticus itself (see `pyquaticus/README.md`).

use super::fixture::game;
use agent::{Action, ActionSpace, Mind, ObservationSpace, Pilot, Spaces};
use messages::{Order, Picture};
use primitives::math::length;
use primitives::{SimTime, VehicleId};
use scenario::Scenario;

const SPACES: Spaces = Spaces {
    observation: ObservationSpace::Squall {
        mates: 1,
        enemies: 2,
        frames: 1,
    },
    action: ActionSpace::Pyquaticus,
};

/// A recorded game: for each decision, every boat's action, and its position after it.
struct Recorded {
    actions: Vec<Vec<usize>>,
    at_m: Vec<Vec<[f64; 2]>>,
}

impl Recorded {
    fn read(name: &str) -> Recorded {
        let path = format!(
            "{}/tests/learn/pyquaticus/{name}.csv",
            env!("CARGO_MANIFEST_DIR")
        );
        let text = std::fs::read_to_string(&path).unwrap_or_else(|e| panic!("{path}: {e}"));
        let rows = text.lines().skip(1).map(|row| {
            let numbers: Vec<f64> = row.split(',').map(|n| n.parse().unwrap()).collect();
            let boats = numbers.len() / 3;
            let actions = numbers[..boats].iter().map(|n| *n as usize).collect();
            let (at_m, rest) = numbers[boats..].as_chunks();
            assert!(rest.is_empty());
            (actions, at_m.to_vec())
        });
        let (actions, at_m) = rows.unzip();
        Recorded { actions, at_m }
    }
}

/// A pilot that repeats recorded actions, one per decision.
struct Replayed {
    pilot: Pilot,
    actions: std::vec::IntoIter<usize>,
}

impl Mind for Replayed {
    fn decide(&mut self, picture: &Picture) -> Order {
        self.pilot.observe(picture);
        let action = self.actions.next().unwrap();
        self.pilot.act(Action::Discrete(action));
        self.pilot.decide(picture)
    }
}

/// The greatest distance between a boat in this game and in the recording, m.
fn greatest_gap_m(scenario: &Scenario, recorded: &Recorded) -> f64 {
    let mind = |i: usize| -> Box<dyn Mind> {
        let actions: Vec<usize> = recorded.actions.iter().map(|row| row[i]).collect();
        Box::new(Replayed {
            pilot: Pilot::direct(scenario, VehicleId::at(i), SPACES),
            actions: actions.into_iter(),
        })
    };
    let minds = (0..scenario.vehicles.len()).map(mind).collect();
    let mut seen: Vec<Vec<[f64; 2]>> = vec![];
    arena::play_watched(scenario, minds, 1, |contest| {
        let boats = &contest.world().state().boats;
        seen.push(
            boats
                .iter()
                .map(|b| [b.pose.at.east, b.pose.at.north])
                .collect(),
        );
        seen.len() <= recorded.actions.len()
    })
    .unwrap();
    let pairs = seen[1..]
        .iter()
        .flatten()
        .zip(recorded.at_m.iter().flatten());
    let gaps_m = pairs.map(|([x, y], [want_x, want_y])| length(x - want_x, y - want_y));
    gaps_m.fold(0.0, f64::max)
}

#[test]
fn boats_move_as_in_pyquaticus() {
    let main = Scenario {
        ticks_per_decision: 1,
        ..game("pyquaticus_2v2")
    };
    let mut competition = game("mctf_2026");
    // Power play is off in the recording as well.
    competition.rules.power_play = SimTime::ZERO;
    // In the recording, both teams start from the north.
    let red_1 = competition.vehicles[3].start_position.clone();
    competition.vehicles[3].start_position = competition.vehicles[5].start_position.clone();
    competition.vehicles[5].start_position = red_1;
    for (scenario, name) in [
        (&main, "main_random"),
        (&main, "main_heuristics"),
        (&competition, "mctf_2026_random"),
        (&competition, "mctf_2026_heuristics"),
        (&competition, "mctf_2026_network"),
    ] {
        let recorded = Recorded::read(name);
        assert_eq!(recorded.actions.len(), 40);
        let gap_m = greatest_gap_m(scenario, &recorded);
        assert!(gap_m < 1e-6, "{name}: {gap_m} m apart");
    }
}
