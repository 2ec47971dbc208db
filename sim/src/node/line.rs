//! The lines to a sim: what comes in on them goes to its inbox.

use super::telling::HeardTopic;
use bus::{Bus, BusError, Outlet, Question, Standing};
use game::topic::{self, GameName, Part};

/// What comes in from the network.
pub(super) enum Call {
    Orders(Vec<u8>),
    Nav(Vec<u8>),
    Join(Question),
    Moor(Question),
    Scenario(Question),
    Events(Question),
    Water(Question),
    /// To be written down only: the topic's place in the list, and the message.
    Heard(usize, Vec<u8>),
    Gone(Part, String),
    Control(Vec<u8>),
}

/// What comes in, to the inbox; topics of `heard` only to be written down.
pub(super) fn open(
    bus: &Bus,
    game: &GameName,
    outlet: &Outlet<Call>,
    heard: &[HeardTopic],
) -> Result<Vec<Standing>, BusError> {
    let on = |call: fn(Vec<u8>) -> Call| {
        let outlet = outlet.clone();
        move |bytes: &[u8]| outlet.put(call(bytes.to_vec()))
    };
    let asked = |call: fn(Question) -> Call| {
        let outlet = outlet.clone();
        move |question| outlet.put(call(question))
    };
    let gone = outlet.clone();
    let watch = move |key: &str, alive: bool| {
        if let (Some((_, part, node)), false) = (topic::parse_alive(key), alive) {
            gone.put(Call::Gone(part, node));
        }
    };
    let mut standing = vec![
        bus.subscribe(topic::all_orders(game), on(Call::Orders))?,
        bus.subscribe(topic::control(game), on(Call::Control))?,
        bus.subscribe(topic::all_nav(game), on(Call::Nav))?,
        bus.watch_alive(topic::all_alive(game, Part::Agent), watch.clone())?,
        bus.watch_alive(topic::all_alive(game, Part::Gateway), watch)?,
        bus.answer(topic::scenario(game), asked(Call::Scenario))?,
        bus.answer(topic::events(game), asked(Call::Events))?,
        bus.answer(topic::water(game), asked(Call::Water))?,
        bus.answer(topic::join(game), asked(Call::Join))?,
        bus.answer(topic::moor(game), asked(Call::Moor))?,
        bus.show_alive(topic::alive(game, Part::Sim, &bus.id()))?,
    ];
    for (i, HeardTopic { topic, .. }) in heard.iter().enumerate() {
        let outlet = outlet.clone();
        let take = move |bytes: &[u8]| outlet.put(Call::Heard(i, bytes.to_vec()));
        standing.push(bus.subscribe(topic::recorded(game, topic), take)?);
    }
    Ok(standing)
}
