//! A sim's subscriptions and queries, with separate inboxes for commands, observers' queries and
//! all other messages.

use super::control_inbox::ControlInbox;
use super::message_inbox::{Incoming, MessageInbox};
use super::observers::RecordedTopic;
use bus::{Bus, BusError, Declaration, InboxSender, Priority, Publisher, Query};
use messages::Message;
use messages::external::Reported;
use messages::refusal::Refusal;
use messages::topic::{self, GameName};
use primitives::VehicleId;
use scenario::Scenario;
use serde::de::DeserializeOwned;
use std::collections::BTreeMap;
use std::sync::Arc;

/// A query from an observer.
pub(super) enum Question {
    Scenario,
    Events,
    Water,
}

pub(super) struct Inboxes {
    pub(super) controls: Arc<ControlInbox<Query>>,
    pub(super) questions: InboxSender<(Question, Query)>,
    pub(super) others: Arc<MessageInbox>,
}

impl Inboxes {
    fn message_callback<M: Message + DeserializeOwned + 'static>(
        &self,
        incoming: fn(M, &[u8]) -> Incoming,
    ) -> impl Fn(&[u8]) + Send + Sync + use<M> {
        let others = Arc::clone(&self.others);
        move |bytes: &[u8]| {
            // Decode in zenoh's thread, so that invalid bytes never wake the loop.
            if let Some(message) = others.decode::<M>(bytes) {
                others.push(incoming(message, bytes));
            }
        }
    }

    fn question_callback(
        &self,
        question: fn() -> Question,
    ) -> impl Fn(Query) + Send + Sync + use<> {
        let questions = self.questions.clone();
        let others = Arc::clone(&self.others);
        move |query| {
            questions.put((question(), query));
            others.push(Incoming::Look);
        }
    }
}

/// Subscribes to gateway reports about a boat.
pub(super) fn subscribe_report(
    bus: &Bus,
    game: &GameName,
    scenario: &Scenario,
    (vehicle, what): (VehicleId, Reported),
    others: Arc<MessageInbox>,
) -> Result<Declaration, BusError> {
    let key = topic::report(game, what, &scenario.vehicles[vehicle.index()].name);
    bus.subscribe(key, move |bytes: &[u8]| {
        match Reported::split_ticket(bytes) {
            Some((ticket, message)) => others.push(Incoming::Report {
                ticket,
                vehicle,
                what,
                message: message.to_vec(),
            }),
            // Count the message with all other refusals, which the result and the page show.
            None => others.refuse(Refusal::Garbage),
        }
    })
}

/// The publishers of gateway reports, for each real boat.
pub(super) fn report_publishers(
    bus: &Bus,
    game: &GameName,
    scenario: &Scenario,
) -> Result<BTreeMap<(VehicleId, Reported), Publisher>, BusError> {
    let mut publishers = BTreeMap::new();
    for vehicle in scenario.externals() {
        let name = &scenario.vehicles[vehicle.index()].name;
        for (what, key) in [
            (Reported::Status, topic::status(game, name)),
            (Reported::Link, topic::link(game, name)),
        ] {
            publishers.insert((vehicle, what), bus.publisher(key, Priority::Normal)?);
        }
    }
    Ok(publishers)
}

/// Opens all subscriptions. `recorded` are the topics subscribed to only for the recorder.
pub(super) fn open(
    bus: &Bus,
    game: &GameName,
    scenario: &Scenario,
    inboxes: &Inboxes,
    recorded: &[RecordedTopic],
) -> Result<Vec<Declaration>, BusError> {
    let others = || Arc::clone(&inboxes.others);
    let gone = others();
    let joins = others();
    // If the inbox is full, the notification may be dropped: a busy sim checks for stops before
    // each message anyway.
    let stops = Arc::clone(&inboxes.controls);
    let look = others();
    let stop = move |bytes: &[u8]| {
        if stops.put_stop(bytes) {
            look.push(Incoming::Look);
        }
    };
    let controls = Arc::clone(&inboxes.controls);
    let look = others();
    let control = move |query| {
        if controls.put_query(query) {
            look.push(Incoming::Look);
        }
    };
    let mut declarations = vec![
        // One subscription serves all agents: the key contains the agents' names for access
        // control, and the ticket identifies the sender.
        bus.subscribe(
            topic::all_orders(game),
            inboxes.message_callback(|orders, _| Incoming::Orders(orders)),
        )?,
        bus.subscribe(topic::control(game), stop)?,
        bus.answer(topic::control(game), control)?,
        bus.subscribe(
            topic::all_nav(game),
            inboxes.message_callback(|report, bytes| Incoming::Nav(report, bytes.to_vec())),
        )?,
        bus.watch_links(move |node| gone.push(Incoming::Gone(node)))?,
        bus.answer(
            topic::scenario(game),
            inboxes.question_callback(|| Question::Scenario),
        )?,
        bus.answer(
            topic::events(game),
            inboxes.question_callback(|| Question::Events),
        )?,
        bus.answer(
            topic::water(game),
            inboxes.question_callback(|| Question::Water),
        )?,
        bus.answer(topic::all_join(game), move |query| {
            joins.push(Incoming::Join(query))
        })?,
        bus.show_alive(topic::alive(game, &bus.id()))?,
    ];
    for vehicle in scenario.externals() {
        declarations.push(subscribe_report(
            bus,
            game,
            scenario,
            (vehicle, Reported::Status),
            others(),
        )?);
    }
    for (i, RecordedTopic { topic, .. }) in recorded.iter().enumerate() {
        let others = others();
        let take = move |bytes: &[u8]| others.push(Incoming::RecordedMessage(i, bytes.to_vec()));
        declarations.push(bus.subscribe(topic::matching(game, topic), take)?);
    }
    Ok(declarations)
}
