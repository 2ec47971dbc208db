//! Network faults: cut links, stopped nodes, floods. Unaffected nodes notice nothing.

use crate::external::{FACTOR, Gateway, ME};
use crate::proxy::{Proxy, STALL};
use crate::support::{
    FOUR, LIMIT, Process, Sim, agent, free_endpoint, newest, own, result_of, squall, token,
    wait_until,
};
use bus::{Bus, Net, Priority};
use messages::external::ExternalOrder;
use messages::topic::{self, GameName};
use messages::{Control, Frame, Order};
use primitives::{SimTime, codec};
use std::process::{Command, Stdio};
use std::sync::mpsc::{Receiver, channel};
use std::time::{Duration, Instant};

/// zenoh closes a silent link after ten seconds, and closing may take ten more.
const AFTERMATH: Duration = Duration::from_secs(25);
/// Time without progress reports after which a game counts as stopped. Reports come ten times a
/// second; the rest allows for a busy machine.
const STANDSTILL: Duration = Duration::from_millis(1500);
/// Both paces: as fast as possible, and by the clock, without waiting for nodes.
const PACES: [&str; 2] = ["lockstep", "200x"];

/// A game with an agent for each boat, in a sim with as few threads as under `squall run`.
fn game(pace: &str) -> (Sim, Vec<Process>) {
    let sim = sim_with_few_threads("impatient", pace);
    let agents = FOUR.iter().map(|name| sim.agent(&[name])).collect();
    sim.wait_for_kind("started");
    (sim, agents)
}

fn sim_with_few_threads(name: &str, pace: &str) -> Sim {
    let mut program = squall(&[]);
    program.env(
        bus::RUNTIME_VARIABLE,
        if pace == "lockstep" {
            bus::RUNTIME
        } else {
            bus::HUB_RUNTIME
        },
    );
    Sim::start_with(
        program,
        name,
        &["--listen", &free_endpoint(), "--pace", pace],
    )
}

/// An observer of the game at this endpoint.
fn observer(endpoint: &str, game: &str) -> Process {
    Process::quiet(squall(&[
        "watch",
        "--connect",
        endpoint,
        "--game",
        game,
        "--rate",
        "30",
    ]))
}

/// Checks that the game continues without a pause and loses no more agents.
fn expect_undisturbed(sim: &Sim, what: &str) {
    let start = Instant::now();
    let mut since = start;
    while start.elapsed() < AFTERMATH {
        let message = sim.wait_for(|_| true);
        let still = since.elapsed();
        assert!(
            still < STANDSTILL,
            "{what}: the game stands still for {still:?}"
        );
        if message["kind"] == "progress" {
            since = Instant::now();
        }
        assert!(
            message["event"] != "agent_lost",
            "{what}: {message} after {:?}",
            start.elapsed()
        );
    }
}

/// Runs the check at both paces at once.
fn at_both_paces(check: fn(&str)) {
    std::thread::scope(|scope| {
        for pace in PACES {
            scope.spawn(move || check(pace));
        }
    });
}

#[test]
fn an_observer_with_a_cut_link_delays_no_node() {
    at_both_paces(|pace| {
        let (sim, _agents) = game(pace);
        let proxy = Proxy::start(sim.endpoint.replace("tcp/", ""));
        let _watch = observer(&format!("tcp/127.0.0.1:{}", proxy.port), &sim.game);
        sim.play_on(20.0);
        proxy.set(STALL);
        expect_undisturbed(&sim, pace);
        sim.stop();
    });
}

#[test]
fn an_observer_that_is_stopped_holds_up_nobody() {
    at_both_paces(|pace| {
        let (sim, _agents) = game(pace);
        let watch = observer(&sim.endpoint, &sim.game);
        sim.play_on(20.0);
        watch.signal("STOP");
        expect_undisturbed(&sim, pace);
        sim.stop();
    });
}

#[test]
fn an_agent_that_hangs_costs_its_own_patience_once_and_nothing_after_it() {
    at_both_paces(|pace| {
        let (sim, agents) = game(pace);
        sim.play_on(20.0);
        agents[1].signal("STOP");
        sim.wait_for_event("agent_lost", FOUR[1]);
        expect_undisturbed(&sim, pace);
        sim.stop();
    });
}

#[test]
fn an_agent_whose_link_is_cut_costs_its_own_patience_once_and_nothing_after_it() {
    at_both_paces(|pace| {
        let sim = sim_with_few_threads("impatient", pace);
        let proxy = Proxy::start(sim.endpoint.replace("tcp/", ""));
        let _agents: Vec<Process> = FOUR[1..].iter().map(|name| sim.agent(&[name])).collect();
        let _cut = agent(
            &format!("tcp/127.0.0.1:{}", proxy.port),
            &sim.game,
            &FOUR[..1],
        );
        sim.wait_for_kind("started");
        sim.play_on(20.0);
        proxy.set(STALL);
        sim.wait_for_event("agent_lost", FOUR[0]);
        expect_undisturbed(&sim, pace);
        sim.stop();
    });
}

#[test]
fn a_resumed_sim_blames_no_node_and_plays_the_same_game() {
    let want = result_of(&[&own("impatient_120s"), "--in-process"])["digest"].clone();
    let sim = Sim::start("impatient_120s", &["--speed", "20x"]);
    let mut agents = FOUR.map(|name| sim.agent(&[name]));
    sim.wait_for_kind("started");
    sim.play_on(2.0);
    suspend(&sim);
    let done = sim.wait_for_kind("done");
    assert_eq!(
        done["outcome"]["digest"], want,
        "{}",
        done["outcome"]["events"]
    );
    assert!(
        agents.iter_mut().all(|agent| agent.wait().success()),
        "they leave without an error"
    );
}

#[test]
fn a_sim_that_was_suspended_in_real_time_blames_nobody() {
    let (sim, _agents) = game("4x");
    sim.play_on(2.0);
    suspend(&sim);
    let start = Instant::now();
    while start.elapsed() < AFTERMATH {
        let message = sim.wait_for(|_| true);
        assert!(
            message["event"] != "agent_lost",
            "{message} after {:?}",
            start.elapsed()
        );
    }
    sim.stop();
}

/// Suspends the sim for longer than zenoh's ten seconds, after which both ends close a link.
fn suspend(sim: &Sim) {
    sim.process.signal("STOP");
    std::thread::sleep(Duration::from_secs(15));
    sim.process.signal("CONT");
}

#[test]
fn a_sim_with_unread_output_continues() {
    let endpoint = free_endpoint();
    let mut command = squall(&[
        "sim",
        &own("long"),
        "--for-parent",
        "--game",
        "unread",
        "--listen",
        &endpoint,
    ]);
    command.stdin(Stdio::piped()).stdout(Stdio::piped());
    let _sim = Process::start(command);
    let _agent = agent(&endpoint, "unread", &FOUR);
    let name = GameName::new("unread").expect("a name");
    let net = Net {
        connect: vec![endpoint],
        token: Some(token()),
        ..Net::default()
    };
    let mut bus = None;
    wait_until("the hub is up", || {
        bus = Bus::leaf(&net).ok();
        bus.is_some()
    });
    let bus = bus.expect("it is there");
    let read = |bytes: &[u8]| {
        codec::decode::<Frame>(bytes)
            .expect("a frame")
            .stamp
            .valid_ns
    };
    let (now, _frames) = newest(&bus, topic::frame(&name), read);
    let play_on = || {
        let from = now.visit(|now| *now);
        assert!(
            now.wait(LIMIT, |now| *now > from + SimTime::from_s(5.0)),
            "it stands still at {} s",
            from.as_s()
        );
    };
    play_on();
    // Every operator request is reported at once: in total more than a pipe of 64 kB holds.
    for i in 0..2000 {
        let speed = Control::Speed(Some(if i % 2 == 0 { 900.0 } else { 1000.0 }));
        bus::control(&bus, &name, speed).expect("it runs at that speed");
    }
    play_on();
    play_on();
}

/// Time limit from an E-stop to the order for the boat.
const PROMISED: Duration = Duration::from_millis(200);

/// Waits for an order to hold (or not to) while the boat continues; returns its time.
fn ordered(orders: &Receiver<(Instant, bool)>, gateway: &mut Gateway, hold: bool) -> Instant {
    let start = Instant::now();
    loop {
        assert!(start.elapsed() < LIMIT, "never ordered: hold {hold}");
        gateway.sail();
        let mut recent = orders
            .recv_timeout(Duration::from_millis(10))
            .into_iter()
            .chain(orders.try_iter());
        if let Some((at, _)) = recent.find(|(_, is_hold)| *is_hold == hold) {
            return at;
        }
    }
}

/// Waits until the boat is driven steadily again, so that the next hold is due to an E-stop.
fn driven(orders: &Receiver<(Instant, bool)>, gateway: &mut Gateway) {
    let mut driven = 0;
    while driven < 5 {
        ordered(orders, gateway, false);
        driven = if orders.try_iter().all(|(_, is_hold)| !is_hold) {
            driven + 1
        } else {
            0
        };
    }
}

#[test]
fn an_e_stop_is_obeyed_at_once_under_a_flood_of_garbage() {
    let sim = sim_with_few_threads("real_attacker", &format!("{FACTOR}x"));
    let _agents = [sim.agent(&["blue_one"]), sim.agent(&["red_one"])];
    let mut gateway = Gateway::joined(&sim);
    let (bus, name, scenario) = sim.session();
    let operator = sim.bus();
    let (sender, orders) = channel();
    let take = move |bytes: &[u8]| {
        let order: ExternalOrder = codec::decode(bytes).expect("an order");
        let _ = sender.send((Instant::now(), order.order.order() == Some(Order::Hold)));
    };
    let key = topic::external_order(&name, &scenario, ME);
    let _orders = bus.subscribe(key, take).expect("the hub is up");
    let stop = operator
        .publisher(topic::control(&name), Priority::Urgent)
        .expect("the hub is up");
    ordered(&orders, &mut gateway, false);
    // Each flood occupies a receiving thread.
    let _floods = [flood(&sim), flood(&sim)];
    let refused = |sim: &Sim| sim.newest_progress()["refused"].as_u64().expect("a number");
    let before = refused(&sim);
    wait_until("the flood has arrived", || refused(&sim) > before + 10_000);
    for _ in 0..100 {
        driven(&orders, &mut gateway);
        let sent = Instant::now();
        stop.send_json(b"\"e_stop\"".to_vec()).expect("a session");
        let took = ordered(&orders, &mut gateway, true).duration_since(sent);
        assert!(took < PROMISED, "it takes {took:?}");
        bus::control(&operator, &name, Control::Release).expect("it continues");
    }
    sim.stop();
}

/// A process that publishes garbage for a game as fast as it can.
fn flood(sim: &Sim) -> Process {
    let mut command = Command::new(std::env::current_exe().expect("this program"));
    command.args(["--ignored", "--exact", "network::floods_a_game"]);
    command.env(FLOODED, format!("{} {}", sim.endpoint, sim.game));
    Process::quiet(command)
}

/// The variable that names the game to flood.
const FLOODED: &str = "SQUALL_FLOODED_GAME";

#[test]
#[ignore = "the other end of a test, in its own process"]
fn floods_a_game() {
    let flooded = std::env::var(FLOODED).unwrap_or_default();
    let Some((endpoint, game)) = flooded.split_once(' ') else {
        return;
    };
    let name = GameName::new(game).expect("a name");
    let bus = Bus::leaf(&Net {
        connect: vec![endpoint.to_owned()],
        ..Net::default()
    })
    .expect("the hub is up");
    let keys = [
        topic::matching(&name, "order/stranger"),
        topic::control(&name),
    ];
    let publishers = keys.map(|key| bus.publisher(key, Priority::Normal).expect("the hub is up"));
    // Until it is killed or the game ends.
    while publishers
        .iter()
        .all(|publisher| publisher.send_raw(vec![0xaa; 16]).is_ok())
    {}
}
