//! What a sim subscribes to and answers: commands, questions and everything else go to an inbox each.

use super::control_inbox::ControlInbox;
use super::message_inbox::{MessageInbox, Sender};
use super::observers::RecordedTopic;
use bus::{Bus, BusError, Declaration, InboxSender, Priority, Publisher, Query};
use messages::external::{NavReport, Reported};
use messages::refusal::Refusal;
use messages::topic::{self, GameName};
use messages::{Message, Orders};
use primitives::VehicleId;
use scenario::Scenario;
use serde::de::DeserializeOwned;
use std::collections::BTreeMap;
use std::sync::Arc;

/// What comes in from the network.
pub(super) enum Incoming {
    Orders(Orders),
    /// The report, and its bytes for the recorder.
    Nav(NavReport, Vec<u8>),
    /// What a gateway reports for others: its ticket, the boat and the message.
    Report {
        ticket: u64,
        vehicle: VehicleId,
        what: Reported,
        message: Vec<u8>,
    },
    Join(Query),
    /// For the recorder only: the topic's place in the list, and the message.
    RecordedMessage(usize, Vec<u8>),
    /// The link of this node is gone.
    Gone(String),
    /// A command or a question waits in an inbox of its own; this makes the sim look there.
    Look,
}

impl Incoming {
    /// From whom it is.
    pub(super) fn sender(&self) -> Sender {
        match self {
            Incoming::Orders(orders) => Sender::Member(orders.ticket),
            Incoming::Nav(report, _) => Sender::Member(report.ticket),
            Incoming::Report { ticket, .. } => Sender::Reporting(*ticket),
            Incoming::Join(_) => Sender::Joining,
            Incoming::RecordedMessage(topic, _) => Sender::Recorded(*topic),
            Incoming::Gone(..) => Sender::Network,
            Incoming::Look => Sender::Inboxes,
        }
    }
}

/// What observers want to know.
pub(super) enum Question {
    Scenario,
    Events,
    Water,
}

/// The inboxes of a sim, for callbacks.
pub(super) struct Inboxes {
    pub(super) controls: Arc<ControlInbox<Query>>,
    pub(super) questions: InboxSender<(Question, Query)>,
    pub(super) others: Arc<MessageInbox>,
}

impl Inboxes {
    /// A callback for messages of one kind.
    fn message_callback<M: Message + DeserializeOwned + 'static>(
        &self,
        incoming: fn(M, &[u8]) -> Incoming,
    ) -> impl Fn(&[u8]) + Send + Sync + use<M> {
        let others = Arc::clone(&self.others);
        move |bytes: &[u8]| {
            // Decoded in zenoh's thread, so that what is garbage never wakes the loop.
            if let Some(message) = others.decode::<M>(bytes) {
                others.push(incoming(message, bytes));
            }
        }
    }

    /// A callback for questions of one kind.
    fn question_callback(&self, question: fn() -> Question) -> impl Fn(Query) + Send + Sync + use<> {
        let (questions, others) = (self.questions.clone(), Arc::clone(&self.others));
        move |query| {
            questions.put((question(), query));
            others.push(Incoming::Look);
        }
    }

    /// A callback for what a gateway reports of its boat.
    fn report(&self, vehicle: VehicleId, what: Reported) -> impl Fn(&[u8]) + Send + Sync + use<> {
        let others = Arc::clone(&self.others);
        move |bytes: &[u8]| match Reported::split_ticket(bytes) {
            Some((ticket, message)) => {
                others.push(Incoming::Report { ticket, vehicle, what, message: message.to_vec() });
            }
            // Counted with everything that is refused, which the result and the page show.
            None => others.refuse(Refusal::Garbage),
        }
    }
}

/// Where what gateways report of each real boat is published.
pub(super) fn report_publishers(
    bus: &Bus,
    game: &GameName,
    scenario: &Scenario,
) -> Result<BTreeMap<(VehicleId, Reported), Publisher>, BusError> {
    let mut publishers = BTreeMap::new();
    for vehicle in scenario.externals() {
        let name = &scenario.vehicles[vehicle.index()].name;
        for (what, key) in [(Reported::Status, topic::status(game, name)), (Reported::Link, topic::link(game, name))] {
            publishers.insert((vehicle, what), bus.publisher(key, Priority::Normal)?);
        }
    }
    Ok(publishers)
}

/// Opens everything that comes in; `recorded` are the topics that are subscribed to only for the recorder.
pub(super) fn open(
    bus: &Bus,
    game: &GameName,
    scenario: &Scenario,
    inboxes: &Inboxes,
    recorded: &[RecordedTopic],
) -> Result<Vec<Declaration>, BusError> {
    let others = || Arc::clone(&inboxes.others);
    let (gone, joins) = (others(), others());
    // Where there is no room for a look, the sim is at work, and looks before each message.
    let (stops, look) = (Arc::clone(&inboxes.controls), others());
    let stop = move |bytes: &[u8]| {
        if stops.put_stop(bytes) {
            look.push(Incoming::Look);
        }
    };
    let (controls, look) = (Arc::clone(&inboxes.controls), others());
    let control = move |query| {
        if controls.put_query(query) {
            look.push(Incoming::Look);
        }
    };
    let mut declarations = vec![
        // One subscription for all agents: their names are in the key for access control, and
        // the ticket says who it is.
        bus.subscribe(topic::all_orders(game), inboxes.message_callback(|orders, _| Incoming::Orders(orders)))?,
        bus.subscribe(topic::control(game), stop)?,
        bus.answer(topic::control(game), control)?,
        bus.subscribe(
            topic::all_nav(game),
            inboxes.message_callback(|report, bytes| Incoming::Nav(report, bytes.to_vec())),
        )?,
        bus.watch_links(move |node| gone.push(Incoming::Gone(node)))?,
        bus.answer(topic::scenario(game), inboxes.question_callback(|| Question::Scenario))?,
        bus.answer(topic::events(game), inboxes.question_callback(|| Question::Events))?,
        bus.answer(topic::water(game), inboxes.question_callback(|| Question::Water))?,
        bus.answer(topic::all_join(game), move |query| joins.push(Incoming::Join(query)))?,
        bus.show_alive(topic::alive(game, &bus.id()))?,
    ];
    for vehicle in scenario.externals() {
        for what in Reported::ALL {
            let key = topic::report(game, what, &scenario.vehicles[vehicle.index()].name);
            declarations.push(bus.subscribe(key, inboxes.report(vehicle, what))?);
        }
    }
    for (i, RecordedTopic { topic, .. }) in recorded.iter().enumerate() {
        let others = others();
        let take = move |bytes: &[u8]| others.push(Incoming::RecordedMessage(i, bytes.to_vec()));
        declarations.push(bus.subscribe(topic::matching(game, topic), take)?);
    }
    Ok(declarations)
}
