//! Measures the primitive policies, each of which has a single task. Plays episodes of each
//! policy's training run with the policy and, for comparison, with stationary boats and with a
//! random action every half second.
//!
//! `cargo run --release -p squall-learn --example primitives -- [EPISODES] [FOLDER] [NAME…]`. By
//! default it plays 128 episodes of each shipped policy,
//! `scenarios/policies/primitive_NAME.onnx`. The same arguments give the same games.

use agent::{Action, ActionSpace};
use learn::environment::{Setup, VectorEnvironment};
use learn::rewards::{BoatProgress, progress};
use onnx::Network;
use primitives::VehicleId;
use primitives::stream::Stream;
use rules::count::Counts;
use std::path::{Path, PathBuf};

/// First seed of the games, beyond any training seed.
const SEED: u64 = 1 << 61;
const NAMES: [&str; 6] = ["pick_up", "guard", "tag", "avoid", "retreat", "shield"];
/// Maximum distance of a boat "at home", in field widths: 20 m of 160 m.
const HOME: f64 = 0.125;

enum Actor {
    Policy(Box<Network>),
    Stops,
    Random(Box<Stream>),
}

impl Actor {
    fn act(&mut self, observation: &[f32]) -> Action {
        let count = ActionSpace::Pyquaticus.count().unwrap_or(1);
        match self {
            Actor::Policy(network) => {
                network.evaluate(observation);
                Action::likeliest(network.output(0))
            }
            Actor::Stops => Action::Discrete(count - 1),
            Actor::Random(stream) => Action::Discrete((stream.unit() * count as f64) as usize),
        }
    }
}

#[derive(Default)]
struct Played {
    /// Mean total reward per boat and episode.
    reward: f64,
    time_s: f64,
    /// By team.
    counts: [Counts; 2],
    /// Number of observations of the policy's boats.
    looks: f64,
    /// Number of observations of untagged boats at home.
    at_home: f64,
    /// Sums of three values: on guard, at the place that shields a teammate, and clear of enemies.
    among: [f64; 3],
}

impl Played {
    fn look(&mut self, boat: &BoatProgress) {
        self.looks += 1.0;
        if boat.tagged {
            return;
        }
        self.at_home += f64::from(u8::from(boat.from_home < HOME));
        let among = [boat.among.on_guard, boat.among.at_shield, boat.among.clear];
        self.among
            .iter_mut()
            .zip(among)
            .for_each(|(sum, number)| *sum += number);
    }

    fn a_minute(&self, count: impl Fn(&Counts) -> u32, team: usize) -> f64 {
        f64::from(count(&self.counts[team])) / self.time_s * 60.0
    }
}

fn played(mut setup: Setup, actor: &mut Actor, episodes: usize) -> Played {
    setup
        .opponents
        .iter_mut()
        .for_each(|(weight, _)| *weight = 1.0);
    let step_s = setup.scenario.decision().as_s() * f64::from(setup.decisions_per_step);
    let size = setup.observation_size();
    let mut environment = VectorEnvironment::new(setup, episodes, 1, SEED, None)
        .unwrap_or_else(|error| panic!("{error}"));
    let (rows, per_game) = environment.rows();
    let sides: Vec<_> = (0..episodes)
        .map(|game| environment.standing(game).side)
        .collect();
    let boats_of = |game: usize| {
        let scenario = environment.contest(game).scenario();
        environment
            .setup()
            .pilots_of(scenario, sides[game].learner, SEED + game as u64)
    };
    let boats: Vec<Vec<VehicleId>> = (0..episodes).map(|game| boats_of(game).collect()).collect();
    let mut ended = vec![false; episodes];
    let mut played = Played::default();
    while ended.iter().any(|ended| !ended) {
        for game in (0..episodes).filter(|game| !ended[*game]) {
            let all = progress(environment.contest(game), true);
            boats[game]
                .iter()
                .for_each(|boat| played.look(&all[boat.index()]));
        }
        let actions: Vec<Action> = environment
            .observations()
            .chunks_exact(size)
            .map(|row| actor.act(row))
            .collect();
        environment
            .step(&actions)
            .unwrap_or_else(|error| panic!("{error}"));
        let going = (0..rows).filter(|row| !ended[row / per_game]);
        played.reward += going
            .map(|row| f64::from(environment.rewards()[row]))
            .sum::<f64>()
            / rows as f64;
        for one in environment.finished() {
            if std::mem::replace(&mut ended[one.game], true) {
                continue;
            }
            played.time_s += f64::from(one.standing.steps) * step_s;
            for (sum, counts) in played.counts.iter_mut().zip(one.standing.counts) {
                sum.grabs += counts.grabs;
                sum.tags += counts.tags;
                sum.tagged += counts.tagged;
                sum.out_of_bounds += counts.out_of_bounds;
            }
        }
    }
    played
}

#[expect(clippy::print_stdout, reason = "this is a program")]
fn main() {
    let args: Vec<String> = std::env::args().skip(1).collect();
    let scenarios = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenarios");
    let episodes = args.first().and_then(|arg| arg.parse().ok()).unwrap_or(128);
    let folder = args
        .get(1)
        .map_or_else(|| scenarios.join("policies"), PathBuf::from);
    let names: Vec<&str> = if args.len() > 2 {
        args[2..].iter().map(String::as_str).collect()
    } else {
        NAMES.to_vec()
    };
    println!("                            means over time          per minute and team");
    println!(
        "policy    boats     reward  home guard shield clear  grabs  tags tagged grabbed  left"
    );
    for name in names {
        let file = scenarios.join(format!("training/primitive_{name}.toml"));
        let training = scenario::load_file::<learn::training::Training>(&file)
            .unwrap_or_else(|problems| panic!("{problems}"));
        let setup = Setup::of_stage(&training, &training.stage[0])
            .unwrap_or_else(|error| panic!("{error}"));
        let path = folder.join(format!("primitive_{name}.onnx"));
        let bytes =
            std::fs::read(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
        let network =
            Network::read(&bytes).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
        for (who, mut actor) in [
            ("policy", Actor::Policy(Box::new(network))),
            ("stopped", Actor::Stops),
            ("random", Actor::Random(Box::new(Stream::new(1, "random")))),
        ] {
            let all = played(setup.clone(), &mut actor, episodes);
            let [guard, shield, clear] = all.among.map(|sum| sum / all.looks);
            println!(
                "{name:9} {who:8} {:7.2}  {:4.2}  {guard:4.2}   {shield:4.2}  {clear:4.2}  {:5.2} {:5.2}  {:5.2}   {:5.2} {:5.2}",
                all.reward,
                all.at_home / all.looks,
                all.a_minute(|counts| counts.grabs, 0),
                all.a_minute(|counts| counts.tags, 0),
                all.a_minute(|counts| counts.tagged, 0),
                all.a_minute(|counts| counts.grabs, 1),
                all.a_minute(|counts| counts.out_of_bounds, 0),
            );
        }
    }
}
