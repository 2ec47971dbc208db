//! Plays one plan: the sim, its agents and an observer run unmodified on a simulated network.

use crate::plan::{GAMES, Plan};
use crate::real_boat::{self, Wire};
use crate::wire_monitor::WireMonitor;
use crate::{gateway_node, operator, page, stranger};
use agent::node::News;
use bus::game_search::GameSearch;
use bus::{Net, Patience, SimState, SimWatch, Watched};
use messages::Frame;
use messages::external::ExternalOrder;
use messages::refusal::Refusals;
use messages::topic::{self, GameName};
use parking_lot::Mutex;
use primitives::{SimTime, codec};
use scenario::Scenario;
use sim::node::{Report, Settings};
use simulated_network::{Run, SimulatedNetwork};
use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, LazyLock};
use std::time::Duration;

/// Limit on the virtual time of a game.
pub(crate) const LIMIT: Duration = Duration::from_secs(300);
/// Time for which the sim waits for agents to join.
const JOIN: Duration = Duration::from_secs(30);
/// Time for which agents search for the game.
pub(crate) const WAIT: Duration = Duration::from_secs(60);
/// Time without a picture after which agents exit.
const SILENCE: Duration = Duration::from_secs(40);

/// The results of a game.
pub(crate) struct Played {
    pub(crate) scenario: Scenario,
    pub(crate) run: Run,
    /// The sim's result; `None` if it was killed.
    pub(crate) sim: Option<Result<Report, String>>,
    /// The node number and result of each agent that was not killed.
    pub(crate) agents: Vec<(usize, Result<(), String>)>,
    /// The messages that the agents refused.
    pub(crate) refused: Refusals,
    pub(crate) monitor: WireMonitor,
}

#[derive(Default)]
struct Results {
    sim: Option<Result<Report, String>>,
    agents: Vec<(usize, Result<(), String>)>,
    refused: Refusals,
}

/// The scenarios, loaded once.
static SCENARIOS: LazyLock<Vec<Scenario>> = LazyLock::new(|| {
    let games = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/fault_injection/games");
    let read = |game: &&str| {
        scenario::load(&games.join(format!("{game}.toml"))).unwrap_or_else(|e| panic!("{e}"))
    };
    GAMES.iter().map(read).collect()
});

impl Plan {
    /// The scenario of the plan.
    pub(crate) fn scenario(&self) -> Scenario {
        let drawn = SCENARIOS[self.game].of_seed(self.game_seed);
        let mut scenario = drawn.unwrap_or_else(|e| panic!("{e}"));
        scenario.rules.time_limit = SimTime::from_s(f64::from(self.duration_s));
        scenario.patience_s = self.patience_s;
        scenario.order_ttl_s = self.order_ttl_s.unwrap_or(scenario.order_ttl_s);
        scenario
    }
}

pub(crate) fn name() -> GameName {
    GameName::new("test").expect("a good name")
}

pub(crate) fn net(listens: bool) -> Net {
    let endpoint = vec!["tcp/127.0.0.1:7447".to_owned()];
    let (listen, connect) = if listens {
        (endpoint, vec![])
    } else {
        (vec![], endpoint)
    };
    let token = Some("5c".repeat(32).parse().expect("a token"));
    Net {
        listen,
        connect,
        token,
        ..Net::default()
    }
}

/// Plays a game; `keeps_lines` also keeps the event log.
pub(crate) fn play(plan: &Plan, keeps_lines: bool) -> Played {
    let scenario = plan.scenario();
    let network = SimulatedNetwork::new(plan.seed, plan.conditions.clone());
    let results = Arc::new(Mutex::new(Results::default()));
    let monitor = Arc::new(Mutex::new(WireMonitor::new(&scenario, plan)));
    if keeps_lines {
        network.keep_lines();
    }
    let seen = Arc::clone(&monitor);
    network.on_publish(move |published| seen.lock().see(published));
    let over = Arc::new(Watched::new(false));
    add_sim(&network, plan, &scenario, &results, &over);
    network.node(Duration::from_millis(100), "observer", observe);
    for (i, boats) in plan.agents.iter().enumerate() {
        let names = boats
            .iter()
            .map(|boat| scenario.vehicles[*boat].name.clone())
            .collect();
        add_agent(&network, i, names, &results);
    }
    if plan.has_real_boat() {
        add_real_boat(&network, plan, &scenario, &over);
    }
    plan.faults
        .iter()
        .for_each(|(at, fault)| network.fault(*at, *fault));
    let run = network.run(LIMIT);
    let Results {
        sim,
        agents,
        refused,
    } = std::mem::take(&mut *results.lock());
    let monitor = monitor.lock().clone();
    Played {
        scenario,
        run,
        sim,
        agents,
        refused,
        monitor,
    }
}

/// Calls a function when its node exits for any reason.
pub(crate) struct AtExit<F: FnMut()>(pub(crate) F);

impl<F: FnMut()> Drop for AtExit<F> {
    fn drop(&mut self) {
        (self.0)();
    }
}

/// Adds the boat, its gateway and an operator.
fn add_real_boat(
    network: &SimulatedNetwork,
    plan: &Plan,
    scenario: &Scenario,
    over: &Arc<Watched<bool>>,
) {
    let vehicle = scenario.externals().next().expect("there is a real boat");
    let vehicle = scenario.vehicles[vehicle.index()].name.clone();
    let wire = Arc::new(Wire::new(plan.forges()));
    let stop = Arc::<AtomicBool>::default();
    let taken = Arc::clone(&wire);
    network.on_take(move |published| {
        if published.node == "gateway" && published.key.contains("/external/") {
            let order = codec::decode::<ExternalOrder>(published.bytes);
            order
                .into_iter()
                .for_each(|order| taken.note_order(order.given_ns, published.at));
        }
    });
    let to_boat = Arc::clone(&wire);
    let ends = Arc::clone(&stop);
    let name = vehicle.clone();
    network.node(Duration::from_millis(200), "gateway", move || {
        gateway_node::connect(&to_boat, &name, &ends)
    });
    let over_for_page = Arc::clone(over);
    let watched = Arc::clone(&wire);
    let ends = Arc::clone(&stop);
    let plan_of = plan.clone();
    let over = Arc::clone(over);
    let seed = plan.seed;
    let name = vehicle.clone();
    let game_over = Arc::clone(&over_for_page);
    let intrude = move || stranger::intrude(seed, &self::name(), &name, &game_over);
    let operate = move || operator::operate(&plan_of, &watched, &vehicle, &over, &ends);
    network.node(operator::BEGINS, "operator", operate);
    let watched = Arc::clone(&wire);
    let plan_of = plan.clone();
    let over = Arc::clone(&over_for_page);
    network.node(page::BEGINS, "page", move || {
        page::look(&plan_of, &watched, &over)
    });
    let datum = scenario.field.plan.datum;
    let cuts = plan.wire_cuts.clone();
    if plan.has_stranger() {
        network.node(stranger::BEGINS, "stranger", intrude);
    }
    network.node(Duration::ZERO, "boat", move || {
        real_boat::sail(&wire, datum, &cuts, &stop)
    });
}

fn add_sim(
    network: &SimulatedNetwork,
    plan: &Plan,
    scenario: &Scenario,
    results: &Arc<Mutex<Results>>,
    over: &Arc<Watched<bool>>,
) {
    let scenario = scenario.clone();
    let results = Arc::clone(results);
    let over = Arc::clone(over);
    let pace = plan.pace;
    let speed = plan.speed;
    let game_seed = plan.game_seed;
    network.node(Duration::ZERO, "sim", move || {
        let _says_over = AtExit(|| over.visit(|over| *over = true));
        let stop = Arc::new(AtomicBool::new(false));
        let settings = Settings {
            game: name(),
            net: net(true),
            pace,
            join_limit: JOIN,
            speed,
            stop,
        };
        let served = sim::node::serve(&scenario, game_seed, &settings, None, &mut |_| {});
        results.lock().sim = Some(served.map_err(|e| e.to_string()));
    });
}

fn add_agent(
    network: &SimulatedNetwork,
    i: usize,
    vehicles: Vec<String>,
    results: &Arc<Mutex<Results>>,
) {
    let results = Arc::clone(results);
    network.node(
        Duration::from_millis(20 * i as u64),
        &format!("agent {i}"),
        move || {
            let settings = agent::node::Settings {
                game: None,
                place: net(false).into(),
                vehicles: vehicles.clone(),
                wait: WAIT,
                silence: SILENCE,
                minds: None,
                policy_wait: Duration::ZERO,
                stop: Arc::new(AtomicBool::new(false)),
            };
            let mut refused = Refusals::default();
            let served = agent::node::serve(&settings, &mut |news| {
                if let News::Left { refused: all, .. } = news {
                    refused = all;
                }
            });
            let mut results = results.lock();
            let before = results.refused;
            results.refused = before + refused;
            results.agents.push((i, served.map_err(|e| e.to_string())));
        },
    );
}

/// Observes frames until the game is over or the sim is lost.
fn observe() {
    let stop = AtomicBool::new(false);
    let Ok((bus, game, _)) =
        GameSearch::new(WAIT, &stop).game(&mut |_| {}, &net(false).into(), None)
    else {
        return;
    };
    let is_over = Arc::new(Watched::new(false));
    let over = Arc::clone(&is_over);
    let take = move |bytes: &[u8]| {
        let ends = codec::decode::<Frame>(bytes).is_ok_and(|frame| frame.over);
        over.visit(|over| *over |= ends);
    };
    let Ok(_frames) = bus.subscribe(topic::frame(&game), take) else {
        return;
    };
    let Ok(sim) = SimWatch::open(&bus, &game, Patience::of_player(Duration::from_secs(10))) else {
        return;
    };
    while !stop.load(Ordering::Relaxed) && sim.state() == SimState::Alive {
        stop.store(
            is_over.wait(Duration::from_millis(500), |over| *over),
            Ordering::Relaxed,
        );
    }
    bus.close();
}
