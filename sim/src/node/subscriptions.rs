//! The lines to a sim: what comes in on them goes to its inbox.

use super::observers::RecordedTopic;
use bus::{Bus, BusError, Declaration, InboxSender, Query};
use game::topic::{self, GameName, Part};

/// What comes in from the network.
pub(super) enum Incoming {
    Orders(Vec<u8>),
    Nav(Vec<u8>),
    Join(Query),
    Moor(Query),
    Scenario(Query),
    Events(Query),
    Water(Query),
    /// To be written down only: the topic's place in the list, and the message.
    RecordedMessage(usize, Vec<u8>),
    Gone(Part, String),
    Control(Vec<u8>),
}

/// What comes in, to the inbox; topics of `heard` only to be written down.
pub(super) fn open(
    bus: &Bus,
    game: &GameName,
    inbox_sender: &InboxSender<Incoming>,
    heard: &[RecordedTopic],
) -> Result<Vec<Declaration>, BusError> {
    let on = |call: fn(Vec<u8>) -> Incoming| {
        let inbox_sender = inbox_sender.clone();
        move |bytes: &[u8]| inbox_sender.put(call(bytes.to_vec()))
    };
    let asked = |call: fn(Query) -> Incoming| {
        let inbox_sender = inbox_sender.clone();
        move |question| inbox_sender.put(call(question))
    };
    let gone = inbox_sender.clone();
    let watch = move |key: &str, alive: bool| {
        if let (Some((_, part, node)), false) = (topic::parse_alive(key), alive) {
            gone.put(Incoming::Gone(part, node));
        }
    };
    let mut standing = vec![
        bus.subscribe(topic::all_orders(game), on(Incoming::Orders))?,
        bus.subscribe(topic::control(game), on(Incoming::Control))?,
        bus.subscribe(topic::all_nav(game), on(Incoming::Nav))?,
        bus.watch_alive(topic::all_alive(game, Part::Agent), watch.clone())?,
        bus.watch_alive(topic::all_alive(game, Part::Gateway), watch)?,
        bus.answer(topic::scenario(game), asked(Incoming::Scenario))?,
        bus.answer(topic::events(game), asked(Incoming::Events))?,
        bus.answer(topic::water(game), asked(Incoming::Water))?,
        bus.answer(topic::join(game), asked(Incoming::Join))?,
        bus.answer(topic::moor(game), asked(Incoming::Moor))?,
        bus.show_alive(topic::alive(game, Part::Sim, &bus.id()))?,
    ];
    for (i, RecordedTopic { topic, .. }) in heard.iter().enumerate() {
        let inbox_sender = inbox_sender.clone();
        let take = move |bytes: &[u8]| inbox_sender.put(Incoming::RecordedMessage(i, bytes.to_vec()));
        standing.push(bus.subscribe(topic::recorded(game, topic), take)?);
    }
    Ok(standing)
}
