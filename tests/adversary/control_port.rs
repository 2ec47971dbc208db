//! An E-stop through the gateway's control port reaches the boat's wire in time, whatever happens
//! to the game; also tests orders that are ahead of the game's time.
//!
//! `SQUALL_TRIES=1000` measures the delay and prints its distribution.

use crate::boat::Boat;
use crate::crowd::Repeated;
use crate::intruder::Intruder;
use crate::support::{LIMIT, Process, Sim, stderr, temporary, token, wait_until};
use bus::ask_gateway;
use gateway::nmea::Mode;
use messages::external::{
    ExternalOrder, FleetCommand, GatewayCommand, OperatorCommand, OperatorReply,
};
use messages::{Message, Order, Stamp, VehicleOrder};
use primitives::{SimTime, VehicleId, codec};
use std::net::SocketAddr;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::{Duration, Instant};

/// Time limit from the request to the standby sentence on the wire.
const PROMISED: Duration = Duration::from_millis(200);

/// A game, the gateway of its real boat, and the boat.
pub(crate) struct Rig {
    pub(crate) sim: Sim,
    _agents: Process,
    _gateway: Process,
    boat: Boat,
    control: SocketAddr,
}

impl Rig {
    pub(crate) fn start(sim_args: &[&str]) -> Rig {
        let sim = Sim::start(
            "real_attacker",
            &[&["--pace", "realtime"], sim_args].concat(),
        );
        let boat = Boat::start(sim.info(&sim.bus()).scenario.field.plan.datum);
        let control =
            SocketAddr::from(([127, 0, 0, 1], bus::free_port(false).expect("a free port")));
        let address = control.to_string();
        let args = [
            "gateway",
            "surveyor",
            "--vehicle",
            "blue_one",
            "--no-record",
            "--control-listen",
            &address,
        ];
        let gateway = sim.quiet(&[&args[..], &["--link", &boat.link]].concat());
        let agents = sim.agent(&["blue_one", "red_one"]);
        let rig = Rig {
            sim,
            _agents: agents,
            _gateway: gateway,
            boat,
            control,
        };
        let is_up = |rig: &Rig| {
            let status = GatewayCommand::boat("blue_one", OperatorCommand::Status);
            ask_gateway(rig.control, None, &status, LIMIT)
                .is_ok_and(|reply| reply.status.link == "up")
        };
        wait_until("the boat is there", || is_up(&rig));
        rig
    }

    fn ask(&self, command: GatewayCommand) -> OperatorReply {
        ask_gateway(self.control, Some(&token()), &command, LIMIT).expect("the gateway answers")
    }

    pub(crate) fn tell(&self, command: OperatorCommand) -> OperatorReply {
        self.ask(GatewayCommand::boat("blue_one", command))
    }

    /// Arms the boat as soon as it is ready.
    pub(crate) fn arm(&self) {
        self.tell(OperatorCommand::Release);
        wait_until("the boat is armed", || {
            self.tell(OperatorCommand::Arm).refused.is_none()
        });
    }

    /// Delegates station keeping to the boat. The gateway then sends nothing, so the next command
    /// is a response.
    fn delegate(&self) {
        self.ask(GatewayCommand::Fleet(FleetCommand::Release));
        wait_until("it is fit", || {
            self.tell(OperatorCommand::Release);
            self.tell(OperatorCommand::StationKeep).refused.is_none()
        });
        self.boat.next(&Mode::StationKeep, LIMIT);
    }

    /// The time from an E-stop to standby.
    fn stops_after(&self, stop: impl FnOnce()) -> Duration {
        self.delegate();
        let asked = Instant::now();
        stop();
        self.boat
            .next(&Mode::Standby, LIMIT)
            .saturating_duration_since(asked)
    }

    /// Repeats the measurement, alternating between the boat and the fleet.
    fn measure(&self, what: &str) {
        let tries: usize =
            std::env::var("SQUALL_TRIES").map_or(30, |text| text.parse().expect("a number"));
        let one = |i: usize| {
            let boat = GatewayCommand::boat("blue_one", OperatorCommand::EStop);
            let command = if i.is_multiple_of(2) {
                boat
            } else {
                GatewayCommand::Fleet(FleetCommand::EStop)
            };
            self.stops_after(|| {
                let reply =
                    ask_gateway(self.control, None, &command, LIMIT).expect("the gateway answers");
                assert!(
                    reply.refused.is_none() && reply.status.state.contains("e-stopped"),
                    "{reply:?}"
                );
            })
        };
        let mut took: Vec<Duration> = (0..tries).map(one).collect();
        took.sort();
        let at = |share: f64| took[((tries - 1) as f64 * share).round() as usize];
        let late = took.iter().filter(|took| **took > PROMISED).count();
        eprintln!(
            "E-stop to standby on the wire, {what}: {tries} tries, min {:.2?}, median {:.2?}, p99 {:.2?}, max {:.2?}",
            at(0.0),
            at(0.5),
            at(0.99),
            at(1.0)
        );
        assert_eq!(late, 0, "{what}: later than {PROMISED:?}");
    }
}

#[test]
fn an_e_stop_is_on_the_wire_in_time_whatever_happens_to_the_game() {
    let mut rig = Rig::start(&[]);
    rig.measure("undisturbed");
    let sent = Arc::new(AtomicU64::new(0));
    let start = Instant::now();
    let flood = ["control", "order/x"].map(|topic| {
        let intruder = Intruder::at(&rig.sim);
        let sent = Arc::clone(&sent);
        Repeated::start(move || {
            intruder.publish(topic, "garbage");
            sent.fetch_add(1, Ordering::Relaxed);
        })
    });
    rig.measure("under a flood of garbage");
    let rate = sent.load(Ordering::Relaxed) as f64 / start.elapsed().as_secs_f64();
    eprintln!("garbage: {rate:.0} messages a second");
    drop(flood);
    rig.sim.process.signal("STOP");
    rig.measure("with a suspended sim");
    // Stop boats through this machine's registry, as operators do, because the game itself does not
    // respond.
    rig.delegate();
    for (vehicle, words) in [
        ("blue_one", "an E-stop of this boat"),
        ("all", "of this boat and of the fleet"),
    ] {
        let mut tell =
            crate::support::squall(&["gateway", "tell", vehicle, "estop", "--game", &rig.sim.game]);
        let output = tell.output().expect("the program starts");
        assert!(
            output.status.success() || vehicle == "all",
            "{}",
            stderr(&output)
        );
        assert!(
            String::from_utf8_lossy(&output.stdout).contains(words),
            "{output:?}"
        );
    }
    rig.sim.process.signal("CONT");
    rig.sim.process.kill();
    rig.measure("without a sim");
}

#[test]
fn orders_ahead_of_the_game_are_refused_and_the_sims_orders_still_count() {
    // A hub without access control, unlike ours.
    let dir = temporary();
    let file = dir.path().join("open.json5");
    let rules = r#"{ access_control: { enabled: true, default_permission: "allow", rules: [], subjects: [], policies: [] } }"#;
    std::fs::write(&file, rules).expect("a temporary file");
    let rig = Rig::start(&["--zenoh-config", &file.display().to_string()]);
    let count = |name: &str| {
        let counts = rig.tell(OperatorCommand::Status).status.counts;
        counts
            .iter()
            .find(|(counted, _)| counted == name)
            .map_or(0, |(_, count)| *count)
    };
    wait_until("orders come", || count("orders") > 5);
    let intruder = Intruder::at(&rig.sim);
    let hour = SimTime::from_s(3600.0);
    for (stamp, given) in [
        (hour, hour),
        (SimTime::ZERO, hour),
        (SimTime(i64::MAX), SimTime(i64::MAX)),
    ] {
        let before = count("orders ahead of the game");
        let forged = ExternalOrder {
            stamp: Stamp {
                valid_ns: stamp,
                version: ExternalOrder::VERSION,
                seq: 1,
            },
            given_ns: given,
            order: VehicleOrder::new(
                VehicleId(0),
                Order::Thrust {
                    port: 1.0,
                    starboard: 1.0,
                },
            ),
            others_m: vec![],
        };
        wait_until("it is rejected and counted", || {
            intruder.publish("external/blue_one", codec::encode(&forged));
            count("orders ahead of the game") > before
        });
        let sound = count("orders");
        let old = count("old orders");
        wait_until("the sim's are obeyed", || count("orders") > sound + 10);
        assert_eq!(count("old orders"), old, "{stamp}");
    }
    rig.sim.stop();
}
