//! Handles a game server's incoming messages.

use super::GameServer;
use crate::node::agents::{self, Accepted};
use crate::node::control_inbox::Command;
use crate::node::gateways;
use crate::node::message_inbox::Incoming;
use crate::node::observers::{self, RecordedTopic};
use crate::node::settings::Pace;
use crate::node::subscriptions::Question;
use bus::token::{self, Checked};
use bus::{Query, clock, random_number};
use messages::external::{LinkBytes, NavReport, Reported};
use messages::refusal::Refusal;
use messages::{Control, ControlReply, JoinReply, JoinRequest, Message, Orders, Role, topic};
use primitives::{SimTime, VehicleId};
use std::sync::atomic::Ordering;
use std::time::Duration;

/// Maximum number of messages read before the game continues.
const MESSAGES_MAX: usize = 1024;
/// Maximum number of questions answered before the game continues.
const ANSWERS_MAX: usize = 4;

impl GameServer<'_> {
    /// Handles incoming messages, commands first. Waits up to `limit` for the first one.
    pub(in crate::node) fn listen(&mut self, limit: Duration) {
        // Called before and after waiting, to separate waiting from the sim's own work. If its own
        // work takes more than a second, the sim was suspended.
        self.time.pass(clock::now(), Duration::ZERO);
        let mut next = self.inbox.next_within(limit);
        self.time.pass(clock::now(), limit);
        self.obey();
        self.answer();
        // Messages may arrive faster than they are read: the game must continue.
        for _ in 0..MESSAGES_MAX {
            // Execute commands before each message, so that a flood delays an E-stop by at most one
            // message.
            self.obey();
            let Some(incoming) = next else { return };
            self.take_in(incoming);
            next = self.inbox.take_now();
        }
        next.into_iter().for_each(|incoming| self.take_in(incoming));
    }

    /// Answers some of the waiting questions. Answering takes time, and the sender can wait or ask
    /// again.
    fn answer(&mut self) {
        let questions: Vec<(Question, Query)> = std::iter::from_fn(|| self.questions.take_now())
            .take(ANSWERS_MAX)
            .collect();
        for (question, query) in questions {
            query.answer(match question {
                Question::Scenario => self.game_info.clone(),
                Question::Events => observers::events_json(&self.contest),
                Question::Water => observers::water_json(&self.contest),
            });
        }
    }

    /// Executes the waiting commands.
    fn obey(&mut self) {
        while let Some(command) = self.controls.pop_command() {
            match command {
                Command::Stop(control) => self.control(control).unwrap_or_default(),
                Command::Ask(query) => self.asked_to_control(query),
            }
        }
    }

    fn take_in(&mut self, incoming: Incoming) {
        match incoming {
            Incoming::Orders(message) => self.take_orders(&message),
            Incoming::Nav(report, bytes) => self.take_nav(&report, bytes),
            Incoming::Report {
                ticket,
                vehicle,
                what,
                message,
            } => self.pass_on_report(ticket, vehicle, what, message),
            Incoming::Join(query) => self.join(query),
            Incoming::RecordedMessage(i, bytes) => {
                let RecordedTopic {
                    topic,
                    schema,
                    is_sound,
                } = &self.recorded_topics[i];
                if is_sound(&bytes) {
                    self.record_message(topic.clone(), Some(schema), bytes);
                } else {
                    self.refusals.count(Refusal::Garbage);
                }
            }
            Incoming::Gone(node) => {
                // A gateway rejoins for the same boat at once, and nothing waits for it, so no
                // grace period is needed.
                self.gateways.gone(&node);
                // Links may have timed out while the sim was suspended; the time limit then decides
                // whether agents return.
                if !self.time.is_recovering() {
                    let vehicles = self.agents.gone(&node);
                    self.lose_agents(vehicles);
                }
            }
            Incoming::Look => {}
        }
    }

    fn take_orders(&mut self, message: &Orders) {
        let open = (self.contest.decision(), self.pace);
        let Accepted { orders, back } =
            agents::accept(&mut self.agents, message, open, &mut self.refusals);
        back.into_iter()
            .for_each(|vehicle| self.contest.regain_agent(vehicle));
        if let Some((vehicle, _)) = orders.first() {
            self.note_round_trip(*vehicle, message.stamp.seq);
        }
        for (vehicle, order) in orders {
            let taken = self.contest.order(vehicle, order, message.stamp.valid_ns);
            self.refusals
                .add(Refusal::BadNumber, u64::from(taken.is_err()));
            self.heard[vehicle.index()] = self.time.worked;
            // Pass the order on at once, not with the next pictures, which may be a decision later.
            self.pass_on_now(vehicle);
        }
    }

    /// Records how long a team's agents took to reply to the picture of a decision.
    fn note_round_trip(&mut self, vehicle: VehicleId, seq: u64) {
        let team = self.contest.scenario().team_of(vehicle);
        let Some(throttle) = self.throttles.get_mut(team.index()) else {
            return;
        };
        let now = clock::now();
        let decision_s =
            self.contest.scenario().decision().as_s() / self.pacing.speed.unwrap_or(1.0);
        let decisions = self.contest.decision().saturating_sub(seq) as f64;
        let since_open = self.opened.map_or(Duration::ZERO, |opened| {
            now.saturating_duration_since(opened)
        });
        throttle.note(
            now,
            since_open + Duration::from_secs_f64(decision_s * decisions),
        );
    }

    fn take_nav(&mut self, report: &NavReport, bytes: Vec<u8>) {
        if self.recorder.is_some()
            && let Some(vehicle) = self.contest.scenario().vehicles.get(report.vehicle.index())
        {
            let topic = format!("nav/{}", vehicle.name);
            self.record_message(topic, Some(NavReport::SCHEMA), bytes);
        }
        let now = self.moment();
        let Some(fix_at) = gateways::accept(&mut self.gateways, report, now, &mut self.refusals)
        else {
            return;
        };
        let taken = self
            .contest
            .report(report.vehicle, report.nav, fix_at, report.valid);
        self.refusals
            .add(Refusal::BadNumber, u64::from(taken.is_err()));
    }

    /// Publishes a gateway's report about a boat if the gateway has joined for that boat.
    fn pass_on_report(
        &mut self,
        ticket: u64,
        vehicle: VehicleId,
        what: Reported,
        message: Vec<u8>,
    ) {
        if !self.gateways.vehicles_of(ticket).any(|own| own == vehicle) {
            return self.refusals.count(Refusal::NotYours);
        }
        let name = self.name_of(vehicle).to_owned();
        if !what.is_about(&message, vehicle, &name) {
            return self.refusals.count(Refusal::Garbage);
        }
        // If the session has closed, sending the next picture returns the error.
        let passed_on = match (what, self.reports.get(&(vehicle, what))) {
            (_, None) => Ok(()),
            (Reported::Status, Some(publisher)) => publisher.send_json(message.clone()),
            (Reported::Link, Some(publisher)) => {
                publisher.send_encoded::<LinkBytes>(message.clone())
            }
        };
        passed_on.unwrap_or_default();
        let schema = (what == Reported::Link).then_some(LinkBytes::SCHEMA);
        self.record_message(format!("{what}/{name}"), schema, message);
    }

    /// Simulated time by the clock: the time of the open decision plus the time since. Only for
    /// fixes, which would otherwise seem up to a decision older than they are.
    fn moment(&self) -> SimTime {
        let factor = if self.pace == Pace::Lockstep {
            0.0
        } else {
            self.pacing.speed.unwrap_or(0.0)
        };
        let passed = self
            .opened
            .map_or(0.0, |opened| clock::since(opened).as_secs_f64() * factor);
        self.contest.now() + SimTime::from_s(passed).min(self.contest.scenario().decision())
    }

    fn join(&mut self, query: Query) {
        let reply = match self
            .guard
            .check::<JoinRequest>(query.key(), query.payload(), |_| true)
        {
            Checked::Granted(request) => self.join_at(query.key(), &request),
            Checked::Challenged(challenge) => return query.answer(challenge),
            Checked::Garbage(e) => JoinReply::Refused {
                reason: format!("cannot parse the request: {e}"),
            },
        };
        // Accept the ticket before the node can send it.
        self.inbox.accept_tickets(
            self.agents
                .tickets()
                .chain(self.gateways.tickets())
                .collect(),
        );
        query.answer(token::answer(&reply));
    }

    /// Handles a join request on the key of a team or boat; access control permits no other key.
    fn join_at(&mut self, key: &str, request: &JoinRequest) -> JoinReply {
        let place = topic::join(
            &self.game,
            self.contest.scenario(),
            request.role,
            &request.vehicles,
        );
        match request.role {
            _ if place != key => JoinReply::Refused {
                reason: format!(
                    "requests to join for these vehicles must be sent to {place}, not to {key}"
                ),
            },
            Role::Gateway => self
                .gateways
                .join(request, random_number(), self.contest.now()),
            Role::Agent => self.join_agent(request),
        }
    }

    fn join_agent(&mut self, request: &JoinRequest) -> JoinReply {
        let reply = self
            .agents
            .join(request, random_number(), self.contest.now());
        if let JoinReply::Granted { vehicles, .. } = &reply {
            for vehicle in vehicles {
                // The order in force may have come from a different agent.
                self.contest.hold(*vehicle);
                self.contest.regain_agent(*vehicle);
                self.heard[vehicle.index()] = self.time.worked;
            }
        }
        reply
    }

    fn asked_to_control(&mut self, query: Query) {
        let reply: ControlReply =
            match self
                .guard
                .check(query.key(), query.payload(), |control: &Control| {
                    !control.stops()
                }) {
                Checked::Granted(control) => self.control(control),
                Checked::Challenged(challenge) => return query.answer(challenge),
                Checked::Garbage(e) => {
                    self.refusals.count(Refusal::Garbage);
                    Err(format!("cannot parse the request: {e}"))
                }
            };
        query.answer(token::answer(&reply));
    }

    fn reset(&mut self, seed: u64) -> ControlReply {
        if self.recorder.is_some() || !self.external_orders.is_empty() {
            return Err(
                "a game with a recording or real boats cannot be reset: start a new one".to_owned(),
            );
        }
        let next = self.contest.restarted(self.scenario, seed);
        self.next = Some(next.map_err(|e| e.to_string())?);
        Ok(())
    }

    fn control(&mut self, control: Control) -> ControlReply {
        let mut reply = Ok(());
        match control {
            Control::Stop => self.stop.store(true, Ordering::Relaxed),
            Control::EStop => self.contest.e_stop(true),
            Control::Release => {
                self.contest.e_stop(false);
                // If the session has closed, sending the next picture returns the error.
                drop(self.released.send_json(b"true".to_vec()));
            }
            Control::Reset(seed) => reply = self.reset(seed),
            Control::Halt => self.contest.halt(true),
            Control::GoOn => self.contest.halt(false),
            pacing if self.pacing.change(pacing) => {}
            _ => {
                self.refusals.count(Refusal::OutOfPlace);
                reply = Err("the game's pace or state does not allow this command".to_owned());
            }
        }
        self.is_news = true;
        // An object, like all JSON in a recording.
        let json = serde_json::json!({"control": control}).to_string();
        self.record_message("control", None, json.into_bytes());
        (0..self.external_orders.len()).for_each(|i| self.pass_on_now(self.external_orders[i].0));
        reply
    }
}
