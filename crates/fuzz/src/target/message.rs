//! High-rate messages (CDR): their decoding, and their effect on sim, minds and observers.

use super::{Target, check_shown, mutations};
use crate::played::{self, Played, mixed, played};
use agent::MindRunner;
use agent::node::team_inbox::TeamInbox;
use messages::external::{ExternalOrder, LinkBytes, NavReport};
use messages::input::{InputRecord, Inputs};
use messages::picture::Nav;
use messages::refusal::Refusals;
use messages::{Frame, JoinRequest, Message, Orders, Picture, PolicyProposal, Role, Say, Stamp};
use primitives::{SimTime, VehicleId, codec};
use rules::event::EventCursor;
use scenario::Scenario;
use scenario::outcome::EventOutcome;
use serde::Serialize;
use serde::de::DeserializeOwned;
use sim::Contest;
use sim::node::membership::Membership;
use sim::node::{Pace, agents, gateways};
use std::cell::RefCell;

pub(super) const TARGET: Target = Target {
    name: "message",
    seeds,
    change: mutations,
    check,
    allocated_max: (32 << 20, 500),
};

/// The ticket of all nodes.
const TICKET: u64 = 7;

fn seeds() -> Vec<Vec<u8>> {
    let Played {
        decisions,
        orders,
        says,
        ..
    } = played(played::scenario("pav01_vs_pav01"), 30);
    let mut seeds = Vec::new();
    for (i, decision) in decisions.iter().enumerate().step_by(10) {
        seeds.push(codec::encode(&*decision.frame));
        seeds.extend(decision.pictures.iter().map(codec::encode));
        seeds.extend([codec::encode(&orders[i]), codec::encode(&says[i])]);
        let inputs = decision
            .inputs
            .iter()
            .map(|input| InputRecord::from(*input))
            .collect();
        let stamp = Stamp {
            version: Inputs::VERSION,
            ..decision.frame.stamp
        };
        seeds.push(codec::encode(&Inputs { stamp, inputs }));
    }
    let stamp = |version| Stamp {
        version,
        ..Stamp::default()
    };
    let nav = Nav {
        north_m: 10.0,
        ..Nav::default()
    };
    let vehicle = VehicleId(1);
    let valid = true;
    let report = NavReport {
        stamp: stamp(NavReport::VERSION),
        ticket: TICKET,
        vehicle,
        valid,
        age_ns: 30,
        nav,
    };
    let data = b"$GPHDT,12.5,T*30\r\n".to_vec();
    let link = LinkBytes {
        stamp: stamp(LinkBytes::VERSION),
        vehicle,
        outward: false,
        data,
    };
    let all = played::orders().map(|order| ExternalOrder {
        stamp: stamp(ExternalOrder::VERSION),
        given_ns: SimTime(7),
        order,
        others_m: vec![12.5, -3.0],
    });
    let orders = Orders {
        stamp: stamp(Orders::VERSION),
        ticket: TICKET,
        orders: played::orders().to_vec(),
    };
    seeds.extend(all.iter().map(codec::encode));
    seeds.extend([
        codec::encode(&report),
        codec::encode(&link),
        codec::encode(&played::proposal()),
        codec::encode(&orders),
    ]);
    seeds
}

/// Recipients of messages in the middle of a game.
struct Readers {
    scenario: Scenario,
    contest: Contest,
    /// The state before each message.
    snapshot: Vec<u8>,
    agents: Membership,
    gateways: Membership,
    team_inbox: TeamInbox,
}

impl Readers {
    fn new() -> Readers {
        let scenario = mixed();
        let mut contest = Contest::new(&scenario, 1).expect("the game starts");
        contest.advance();
        let names = scenario.vehicles.iter().map(|vehicle| vehicle.name.clone());
        let member = |role, vehicles: Vec<String>| {
            let mut membership = Membership::new(&scenario, role);
            let request = JoinRequest {
                version: primitives::VERSION.to_owned(),
                role,
                node: "fuzz".to_owned(),
                vehicles,
            };
            membership.join(&request, TICKET, SimTime::ZERO);
            membership
        };
        let agents = member(Role::Agent, names.collect());
        let real = scenario
            .externals()
            .map(|vehicle| scenario.vehicles[vehicle.index()].name.clone());
        let gateways = member(Role::Gateway, real.collect());
        let teams = scenario.vehicles.iter().map(|vehicle| (vehicle.team, true));
        let team_inbox = TeamInbox::new(teams, &[VehicleId(0)]);
        Readers {
            snapshot: contest.snapshot(),
            agents,
            gateways,
            team_inbox,
            contest,
            scenario,
        }
    }
}

thread_local! {
    static READERS: RefCell<Readers> = RefCell::new(Readers::new());
}

fn check(bytes: &[u8]) {
    READERS.with_borrow_mut(|readers| {
        if let Some(orders) = read::<Orders>(bytes) {
            let mut refusals = Refusals::default();
            let open = (readers.contest.decision(), Pace::Realtime { factor: 1.0 });
            for (vehicle, order) in
                agents::accept(&mut readers.agents.clone(), &orders, open, &mut refusals).orders
            {
                // Non-finite numbers make the boat hold.
                readers
                    .contest
                    .order(vehicle, order, orders.stamp.valid_ns)
                    .unwrap_or_default();
            }
            readers.go_on();
        }
        if let Some(report) = read::<NavReport>(bytes) {
            let now = readers.contest.now();
            let fix_at = gateways::accept(
                &mut readers.gateways.clone(),
                &report,
                now,
                &mut Refusals::default(),
            );
            if let Some(fix_at) = fix_at {
                assert!(fix_at <= now);
                readers
                    .contest
                    .report(report.vehicle, report.nav, fix_at, report.valid)
                    .unwrap_or_default();
            }
            readers.go_on();
        }
        if let Some(inputs) = read::<Inputs>(bytes) {
            inputs
                .of(&readers.scenario)
                .flatten()
                .for_each(|input| readers.contest.give(input));
            readers.go_on();
        }
        if let Some(mut picture) = read::<Picture>(bytes) {
            picture.remove_bad_numbers();
            readers.decide(&picture);
        }
        if let Some(frame) = read::<Frame>(bytes) {
            for logged in frame.logged(&readers.scenario) {
                assert!(
                    !EventOutcome::new(&readers.scenario, &logged)
                        .sentence()
                        .is_empty()
                );
            }
        }
        read::<PolicyProposal>(bytes);
        if let Some(say) = read::<Say>(bytes) {
            readers.hear(bytes, say.stamp.seq);
        }
        read::<LinkBytes>(bytes);
        if let Some(order) = read::<ExternalOrder>(bytes) {
            assert_eq!(order.order.order().is_some(), order.order.kind <= 3);
        }
    });
}

/// Decodes a message. Its encoding must have the same length and survive a second round trip.
fn read<M: Message + Serialize + DeserializeOwned>(bytes: &[u8]) -> Option<M> {
    match codec::decode::<M>(bytes) {
        Ok(message) => {
            let written = codec::encode(&message);
            assert_eq!(written.len(), bytes.len(), "{}", M::SCHEMA);
            let again = codec::decode::<M>(&written)
                .unwrap_or_else(|e| panic!("cannot decode what was encoded: {e}"));
            assert_eq!(codec::encode(&again), written, "{}", M::SCHEMA);
            Some(message)
        }
        Err(error) => {
            check_shown(&error);
            None
        }
    }
}

impl Readers {
    /// Checks that the game continues with finite positions after any message; then restores its
    /// state.
    fn go_on(&mut self) {
        self.contest.advance();
        let frame = self.contest.frame(&mut EventCursor::default());
        for (truth, vehicle) in frame.vehicles.iter().zip(&self.scenario.vehicles) {
            let Nav {
                north_m,
                east_m,
                psi_rad,
                surge_m_s,
                sway_m_s,
                yaw_rate_rad_s,
            } = truth.nav;
            let numbers = [
                north_m,
                east_m,
                psi_rad,
                surge_m_s,
                sway_m_s,
                yaw_rate_rad_s,
            ];
            assert!(
                numbers.iter().all(|number| number.is_finite()),
                "{} is at {:?}",
                vehicle.name,
                truth.nav
            );
        }
        self.contest
            .restore(&self.snapshot)
            .expect("the snapshot is valid");
    }

    /// Checks that the sim accepts the minds' orders after any picture.
    fn decide(&mut self, picture: &Picture) {
        let mind = |i| {
            (
                VehicleId::at(i),
                agent::mind_of(&self.scenario, VehicleId::at(i)),
            )
        };
        let mut runner = MindRunner::new([mind(0), mind(2)]);
        runner.propose(&played::proposal(), picture.stamp);
        for _ in 0..2 {
            runner.decide(picture.stamp, |vehicle| {
                picture.own(vehicle).map(|_| picture)
            });
        }
        for (vehicle, order) in runner.orders() {
            let taken = self.contest.order(vehicle, order, SimTime::ZERO);
            assert!(
                taken.is_ok(),
                "{order:?} for {}",
                self.scenario.vehicles[vehicle.index()].name
            );
        }
        self.contest
            .restore(&self.snapshot)
            .expect("the snapshot is valid");
    }

    /// Checks that teammates receive no more words than boats may send, and only finite numbers.
    fn hear(&self, bytes: &[u8], seq: u64) {
        for team in 0..self.scenario.teams.len() {
            let mut inbox = self.team_inbox.clone();
            inbox.receive(primitives::TeamId(team as u8), bytes);
            let mut words = Vec::new();
            inbox.is_complete(seq.saturating_add(1));
            inbox.deliver(seq.saturating_add(1), &mut words);
            assert!(words.iter().all(|word| word.value.is_finite()));
            assert!(words.len() <= scenario::strategy::SHARED_MAX * self.scenario.vehicles.len());
        }
    }
}
