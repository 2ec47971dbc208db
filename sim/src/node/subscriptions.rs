//! What a sim subscribes to and answers: everything that comes in goes to its inbox.

use super::observers::RecordedTopic;
use bus::{Bus, BusError, Declaration, InboxSender, Query};
use game::topic::{self, GameName, Part};

/// What comes in from the network.
pub(super) enum Incoming {
    Orders(Vec<u8>),
    Nav(Vec<u8>),
    Join(Query),
    Scenario(Query),
    Events(Query),
    Water(Query),
    /// For the recorder only: the topic's place in the list, and the message.
    RecordedMessage(usize, Vec<u8>),
    Gone(Part, String),
    /// Published: it stops boats, or is refused.
    Stop(Vec<u8>),
    Control(Query),
}

/// Opens everything that comes in; `recorded` are the topics that are subscribed to only for the recorder.
pub(super) fn open(
    bus: &Bus,
    game: &GameName,
    inbox_sender: &InboxSender<Incoming>,
    recorded: &[RecordedTopic],
) -> Result<Vec<Declaration>, BusError> {
    let on = |incoming: fn(Vec<u8>) -> Incoming| {
        let inbox_sender = inbox_sender.clone();
        move |bytes: &[u8]| inbox_sender.put(incoming(bytes.to_vec()))
    };
    let asked = |incoming: fn(Query) -> Incoming| {
        let inbox_sender = inbox_sender.clone();
        move |query| inbox_sender.put(incoming(query))
    };
    let gone = inbox_sender.clone();
    let watch = move |key: &str, alive: bool| {
        if let (Some((_, part, node)), false) = (topic::parse_alive(key), alive) {
            gone.put(Incoming::Gone(part, node));
        }
    };
    let mut declarations = vec![
        bus.subscribe(topic::all_orders(game), on(Incoming::Orders))?,
        bus.subscribe(topic::control(game), on(Incoming::Stop))?,
        bus.answer(topic::control(game), asked(Incoming::Control))?,
        bus.subscribe(topic::all_nav(game), on(Incoming::Nav))?,
        bus.watch_alive(topic::all_alive(game, Part::Agent), watch.clone())?,
        bus.watch_alive(topic::all_alive(game, Part::Gateway), watch)?,
        bus.answer(topic::scenario(game), asked(Incoming::Scenario))?,
        bus.answer(topic::events(game), asked(Incoming::Events))?,
        bus.answer(topic::water(game), asked(Incoming::Water))?,
        bus.answer(topic::join(game), asked(Incoming::Join))?,
        bus.show_alive(topic::alive(game, Part::Sim, &bus.id()))?,
    ];
    for (i, RecordedTopic { topic, .. }) in recorded.iter().enumerate() {
        let inbox_sender = inbox_sender.clone();
        let take = move |bytes: &[u8]| inbox_sender.put(Incoming::RecordedMessage(i, bytes.to_vec()));
        declarations.push(bus.subscribe(topic::recorded(game, topic), take)?);
    }
    Ok(declarations)
}
