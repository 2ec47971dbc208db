//! What a game server does with what comes in.

use super::GameServer;
use crate::node::agents::{self, Accepted};
use crate::node::observers::{self, RecordedTopic};
use crate::node::subscriptions::Incoming;
use crate::node::{Pace, gateways};
use bus::token::{self, Checked};
use bus::{Query, clock};
use game::SimTime;
use game::external::NavReport;
use game::message::{Control, ControlReply, JoinReply, JoinRequest, Message, Orders, Role};
use game::refusal::Refusal;
use game::topic::Part;
use std::hash::{BuildHasher, Hasher, RandomState};
use std::sync::atomic::Ordering;
use std::time::Duration;

impl GameServer<'_> {
    /// Takes in what comes, waiting up to `limit` for the first of it.
    pub(in crate::node) fn listen(&mut self, limit: Duration) {
        let mut next = self.inbox.take(limit);
        while let Some(incoming) = next {
            match incoming {
                Incoming::Orders(bytes) => self.take_orders(&bytes),
                Incoming::Nav(bytes) => self.take_nav(&bytes),
                Incoming::Join(query) => self.join(query),
                Incoming::Scenario(query) => query.answer(self.game_info.clone()),
                Incoming::Events(query) => query.answer(observers::events_json(&self.contest)),
                Incoming::Water(query) => query.answer(observers::water_json(&self.contest)),
                Incoming::RecordedMessage(i, bytes) => {
                    let RecordedTopic { topic, schema, is_sound } = &self.recorded_topics[i];
                    if is_sound(&bytes) {
                        self.record_message(topic.clone(), *schema, bytes);
                    } else {
                        self.refusals.count(Refusal::Garbage);
                    }
                }
                Incoming::Gone(Part::Gateway, gateway) => drop(self.gateways.gone(&gateway)),
                Incoming::Gone(_, agent) => {
                    let vehicles = self.agents.gone(&agent);
                    self.lose_agents(vehicles);
                }
                Incoming::Stop(bytes) => match serde_json::from_slice::<Control>(&bytes) {
                    Ok(control) if control.stops() => self.control(control).unwrap_or_default(),
                    Ok(_) => self.refusals.count(Refusal::OutOfPlace),
                    Err(_) => self.refusals.count(Refusal::Garbage),
                },
                Incoming::Control(query) => self.asked_to_control(query),
            }
            next = self.inbox.take_now();
        }
    }

    fn take_orders(&mut self, bytes: &[u8]) {
        let Some(message) = self.refusals.decode::<Orders>(bytes) else { return };
        let open = (self.contest.decision(), self.timing);
        let Accepted { orders, back } = agents::accept(&mut self.agents, &message, open, &mut self.refusals);
        back.into_iter().for_each(|vehicle| self.contest.regain_agent(vehicle));
        for (vehicle, order) in orders {
            let taken = self.contest.order(vehicle, order, message.stamp.valid_ns);
            self.refusals.add(Refusal::BadNumber, u64::from(taken.is_err()));
            self.heard[vehicle.index()] = clock::now();
            self.pass_on_now(vehicle);
        }
    }

    fn take_nav(&mut self, bytes: &[u8]) {
        let Some(report) = self.refusals.decode::<NavReport>(bytes) else { return };
        if self.recorder.is_some()
            && let Some(vehicle) = self.contest.scenario().vehicles.get(report.vehicle.index())
        {
            let topic = format!("nav/{}", vehicle.name);
            self.record_message(topic, Some(NavReport::SCHEMA), bytes.to_vec());
        }
        let now = self.moment();
        let Some(fix_at) = gateways::accept(&mut self.gateways, &report, now, &mut self.refusals) else { return };
        let taken = self.contest.report(report.vehicle, report.nav, fix_at, report.valid);
        self.refusals.add(Refusal::BadNumber, u64::from(taken.is_err()));
    }

    /// Simulated time by the clock: the open decision's, and what has passed since it was opened. Only fixes are told the
    /// time by it: a fix would seem up to a decision older than it is otherwise.
    fn moment(&self) -> SimTime {
        let factor = if self.pace == Pace::Lockstep { 0.0 } else { self.pacing.speed().unwrap_or(0.0) };
        let passed = self.opened.map_or(0.0, |opened| clock::since(opened).as_secs_f64() * factor);
        self.contest.now() + SimTime::from_s(passed).min(self.contest.scenario().decision())
    }

    fn join(&mut self, query: Query) {
        let reply = match self.guard.check::<JoinRequest>(query.key(), &query.payload, |_| true) {
            Checked::Granted(request) if request.role == Role::Gateway => self.gateways.join(&request, new_ticket()),
            Checked::Granted(request) => self.join_agent(&request),
            Checked::Challenged(challenge) => return query.answer(challenge),
            Checked::Garbage(e) => JoinReply::Refused { reason: format!("the request is not understood: {e}") },
        };
        query.answer(token::answer(&reply));
    }

    fn join_agent(&mut self, request: &JoinRequest) -> JoinReply {
        let reply = self.agents.join(request, new_ticket());
        if let JoinReply::Granted { vehicles, .. } = &reply {
            for vehicle in vehicles {
                self.contest.hold(*vehicle);
                self.contest.regain_agent(*vehicle);
                self.heard[vehicle.index()] = clock::now();
            }
        }
        reply
    }

    fn asked_to_control(&mut self, query: Query) {
        let reply: ControlReply =
            match self.guard.check(query.key(), &query.payload, |control: &Control| !control.stops()) {
                Checked::Granted(control) => self.control(control),
                Checked::Challenged(challenge) => return query.answer(challenge),
                Checked::Garbage(e) => {
                    self.refusals.count(Refusal::Garbage);
                    Err(format!("the request is not understood: {e}"))
                }
            };
        query.answer(token::answer(&reply));
    }

    fn control(&mut self, control: Control) -> ControlReply {
        let mut reply = Ok(());
        match control {
            Control::Stop => self.stop.store(true, Ordering::Relaxed),
            Control::EStop => self.contest.e_stop(true),
            Control::Release => {
                self.contest.e_stop(false);
                // That the session is closed shows at the next picture.
                drop(self.released.send_json(b"true".to_vec()));
            }
            Control::Halt => self.contest.halt(true),
            Control::GoOn => self.contest.halt(false),
            pacing if self.pacing.change(pacing) => {}
            _ => {
                self.refusals.count(Refusal::OutOfPlace);
                reply = Err("this game, as it is paced and stands now, cannot do that".to_owned());
            }
        }
        self.is_news = true;
        // An object, since all JSON in a recording is.
        let json = serde_json::json!({"control": control}).to_string();
        self.record_message("control", None, json.into_bytes());
        (0..self.external_orders.len()).for_each(|i| self.pass_on_now(self.external_orders[i].0));
        reply
    }
}

/// A number nobody can guess: the standard library's hasher is keyed by the operating system's randomness.
fn new_ticket() -> u64 {
    RandomState::new().build_hasher().finish()
}
